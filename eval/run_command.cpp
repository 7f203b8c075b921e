// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <set>

#include "core/files.h"
#include "eval/cell_sources.h"
#include "eval/commands.h"
#include "eval/progress.h"
#include "eval/report.h"
#include "eval/report_exports.h"
#include "eval/run_matrix.h"
#include "eval/summary.h"

namespace vecino {
namespace {

struct RunArguments {
    std::string config;
    std::string directory;
    std::string only;
    std::string rerun;
    int simd_width = 0;
    bool dry_run = false;
};

void print_verdicts(const ReportReproduction& reproduction) {
    for (const Variant& variant : reproduction.specification.variants) {
        std::map<ClaimVerdict, int> counts;
        for (const auto& results : reproduction.result.claims) {
            for (const ClaimResult& result : results) {
                if (result.variant == variant.id && result.region.empty()) ++counts[result.verdict];
            }
        }
        std::string text;
        for (const ClaimVerdict verdict :
             {ClaimVerdict::reproduced, ClaimVerdict::trend, ClaimVerdict::not_reproduced,
              ClaimVerdict::not_testable}) {
            text += text.empty() ? "" : ", ";
            text += std::to_string(counts[verdict]) + " " + verdict_text(verdict);
        }
        const std::string tested = variant.tested_at.text();
        std::printf("claims, %s%s: %s\n", variant.label.c_str(),
                    tested.empty() ? "" : (", tested at " + tested).c_str(), text.c_str());
    }
}

void print_results(const ReportData& data) {
    std::printf("%s", summary_table(data.groups).c_str());
    std::printf("%s", convergence_table(data.convergence).c_str());
    if (data.reproduction) print_verdicts(*data.reproduction);
    for (const nlohmann::json& row : data.rows) {
        if (row["status"] == "ok" || is_expected_refusal(row, data.failures.cases)) continue;
        std::fprintf(stderr, "%s: %s: %s\n", row["status"].get<std::string>().c_str(),
                     row["cell"].get<std::string>().c_str(),
                     row["reason"].get<std::string>().c_str());
    }
}

ExitCode print_estimate(const Matrix& matrix, const RunArguments& arguments,
                        const RunOptions& options) {
    const RunEstimate estimate = estimate_run(matrix, arguments.directory, options);
    for (const std::string& cell : estimate.cells) std::printf("%s\n", cell.c_str());
    std::printf("%zu cells to do, %.0f million samples, about %s on this machine\n",
                estimate.cells.size(), estimate.samples * 1e-6,
                duration_text(estimate.time_s).c_str());
    return ExitCode::ok;
}

void print_counts(const RunSummary& summary) {
    std::printf("%zu cells: %zu done now, %zu from an earlier run, %zu failed, %zu missing\n",
                summary.cells, summary.done, summary.kept, summary.failed, summary.missing);
    if (summary.refused > 0)
        std::printf("beside these, %zu that their methods refuse, as expected\n", summary.refused);
    if (summary.stale == 0) return;
    std::fprintf(
        stderr,
        "note: %zu results are of another build or another state of their scene: --rerun stale\n",
        summary.stale);
}

/// What can be known to be wrong before the directory is made.
void check_inputs(const Matrix& matrix, const RunOptions& options) {
    const std::vector<Cell> cells = expand(matrix);
    (void)plan_run(cells, options, [](const Cell&) { return CellState::missing; });
    std::set<std::string> scenes;
    for (const Cell& cell : cells) {
        if (traces_scene(matrix, cell) && scenes.insert(cell.scene).second)
            (void)load_scene(cell.scene);
        if (matrix.reference_source != nullptr) require_readable(reference_path(matrix, cell));
    }
}

ExitCode run_run(const RunArguments& arguments) {
    const RunOptions options{arguments.only, parse_rerun(arguments.rerun), arguments.simd_width};
    const Matrix matrix = load_matrix(arguments.config);
    check_inputs(matrix, options);
    if (arguments.dry_run) return print_estimate(matrix, arguments, options);
    catch_interrupts();
    const RunSummary summary = run_matrix(matrix, arguments.directory, options);
    if (summary.was_interrupted) {
        std::fprintf(stderr, "interrupted: the same command goes on from here\n");
        return ExitCode::interrupted;
    }
    const ReportData data = read_report_data(arguments.directory);
    print_results(data);
    print_counts(summary);
    std::printf("report: %s\n", write_report(data).c_str());
    return summary.failed > 0 ? ExitCode::quality : ExitCode::ok;
}

bool is_picture(const std::string& path) {
    const std::string extension = std::filesystem::path(path).extension().string();
    return extension == ".png" || extension == ".bmp";
}

struct ReportArguments {
    std::string directory, output, figure;
    bool embed = false;
    std::string precision;
    ReportExports exports;
};

/// None where the float values are to lie beside the page.
std::optional<PlanePrecision> embedded_precision(const ReportArguments& arguments) {
    const std::string extension = std::filesystem::path(arguments.output).extension().string();
    const bool is_page = extension.empty() || extension == ".html" || extension == ".htm";
    if (!arguments.embed && arguments.precision.empty()) return std::nullopt;
    if (!arguments.embed)
        throw Error(ExitCode::usage,
                    "command line: --embed-precision: found without --embed, allowed: with it");
    if (!is_page)
        throw Error(ExitCode::usage, "command line: --embed: found with " + arguments.output +
                                         ", allowed: with an HTML page");
    return arguments.precision.empty() ? PlanePrecision::float16
                                       : parse_precision(arguments.precision);
}

ExitCode run_report(const ReportArguments& arguments) {
    const auto& [directory, output, figure, embed, precision, exports] = arguments;
    const std::optional<PlanePrecision> embedded = embedded_precision(arguments);
    if (!figure.empty() && !is_picture(output))
        throw Error(ExitCode::usage,
                    "command line: --figure: found without a picture to write, "
                    "allowed: with -o FILE.png or FILE.bmp");
    if (const auto exported = run_exports(directory, output, exports)) return *exported;
    const ReportData data = read_report_data(directory);
    if (is_picture(output)) {
        write_report_picture(data, output, figure);
        std::printf("picture: %s\n", output.c_str());
    } else {
        std::printf("report: %s\n", write_report(data, output, embedded).c_str());
    }
    return ExitCode::ok;
}

}  // namespace

void add_run_command(CLI::App& app, Action& chosen) {
    auto arguments = std::make_shared<RunArguments>();
    CLI::App* const command = app.add_subcommand("run", "run an evaluation matrix");
    command->add_option("CONFIG", arguments->config, "matrix (JSON)")->required();
    command
        ->add_option("-o", arguments->directory, "run directory; an unfinished run there goes on")
        ->required()
        ->check(not_empty());
    command->add_option("--only", arguments->only,
                        "run only cells whose name matches this regular expression");
    command->add_option("--rerun", arguments->rerun,
                        "do again: failed, stale (another build or scene file), all");
    command
        ->add_option("--simd-width", arguments->simd_width,
                     "samples side by side: 1, 4, 8, 16; default: the widest of this machine")
        ->check(CLI::IsMember(simd_widths()));
    command->add_flag("--dry-run", arguments->dry_run,
                      "print the cells to do and an estimate of the time");
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_run(*arguments); }; });
}

void add_report_command(CLI::App& app, Action& chosen) {
    auto arguments = std::make_shared<ReportArguments>();
    CLI::App* const command = app.add_subcommand("report", "write the report of a run again");
    command->add_option("DIR", arguments->directory, "run directory")
        ->required()
        ->check(not_empty());
    command->add_option("-o", arguments->output,
                        "HTML file; .md: tables alone; .csv, .jsonl, .tex: results over seeds; "
                        ".png: time against accuracy, or a figure; FOLDER.cdb: a Cinema database; "
                        "default: DIR/report.html");
    command
        ->add_option("--figure", arguments->figure,
                     "with -o FILE.png: a mosaic of the matrix, by its id")
        ->check(not_empty());
    command->add_flag("--embed", arguments->embed,
                      "put the viewer's float values into the page; default: beside it, in "
                      "DIR/planes");
    command
        ->add_option("--embed-precision", arguments->precision,
                     "with --embed: float16 (differences from the float32 reference) or float32; "
                     "default: float16")
        ->check(not_empty());
    add_export_options(*command, arguments->exports);
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_report(*arguments); }; });
}

std::string number_text(double value, int digits) {
    char text[64];
    std::snprintf(text, sizeof text, "%.*f", digits, value);
    return text;
}

}  // namespace vecino
