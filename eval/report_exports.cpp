// SPDX-License-Identifier: Apache-2.0
#include "eval/report_exports.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <set>

#include "core/image_io.h"
#include "eval/cell_vti.h"
#include "eval/cinema.h"
#include "eval/commands.h"
#include "eval/crop_mosaic.h"
#include "eval/report_raster.h"
#include "eval/report_tables.h"
#include "eval/run_directory.h"

namespace vecino {
namespace {

std::string extension_of(const std::string& path) {
    // "x.cdb/" names the same folder.
    const std::filesystem::path plain(path.ends_with('/') ? path.substr(0, path.size() - 1) : path);
    return plain.extension().string();
}

bool is_picture(const std::string& path) {
    const std::string extension = extension_of(path);
    return extension == ".png" || extension == ".bmp";
}

using TableText = std::string (*)(const ReportData&);

/// By the extension of a path; null where it is that of no table.
TableText table_of(const std::string& path) {
    const std::string extension = extension_of(path);
    if (extension == ".csv") return summary_csv;
    if (extension == ".jsonl") return summary_jsonl;
    if (extension == ".tex") return summary_latex;
    return nullptr;
}

[[noreturn]] void misplaced(const std::string& flag, const std::string& allowed) {
    throw Error(ExitCode::usage, "command line: " + flag + ": found without " + allowed +
                                     ", allowed: with " + allowed);
}

void require_sound(const std::string& output, const ReportExports& exports) {
    const bool is_mosaic = exports.mosaic && is_picture(output);
    if (exports.mosaic && !is_mosaic) misplaced("--mosaic", "-o FILE.png or FILE.bmp");
    if (!exports.crops.empty() && !is_mosaic) misplaced("--crop", "--mosaic");
    if (!exports.metrics.empty() && !is_mosaic) misplaced("--metric", "--mosaic");
    const bool reads_only = is_picture(output) || exports.vti || extension_of(output) == ".cdb" ||
                            table_of(output) != nullptr;
    if (!exports.only.empty() && !reads_only) {
        misplaced("--only", "--vti or -o FILE.png, FILE.csv, FILE.jsonl, FILE.tex or FOLDER.cdb");
    }
}

void write_mosaic(const ReportData& data, const std::string& output, const ReportExports& exports) {
    MosaicOptions options{{}, exports.metrics};
    if (options.metrics.empty()) options.metrics = {"psnr_float_db", "time_s"};
    for (const std::string& crop : exports.crops) options.crops.push_back(parse_crop(crop));
    save_raster(crop_mosaic(data, selected_rows(data, exports.only), options), output);
    std::printf("mosaic: %s\n", output.c_str());
}

void write_vtis(const ReportData& data, const std::string& only) {
    const auto path_of = [&](const std::string& cell) {
        return data.directory + "/cells/" + cell + "/cell.vti";
    };
    std::size_t written = 0;
    write_cell_vtis(data, selected_rows(data, only), [&](const std::string& cell) {
        ++written;
        return path_of(cell);
    });
    std::printf("%zu cells: %s\n", written, path_of("*").c_str());
}

/// Groups of which a cell is asked for; they stay means over all of their seeds.
void keep_groups(ReportData& data, const std::string& only) {
    std::set<std::string> asked;
    for (const nlohmann::json* row : selected_rows(data, only)) asked.insert((*row)["group"]);
    std::erase_if(data.groups,
                  [&](const GroupSummary& group) { return !asked.contains(group.group); });
    std::erase_if(data.scenes, [&](const std::string& scene) {
        return std::ranges::find(data.groups, scene, &GroupSummary::scene) == data.groups.end();
    });
}

void write_table(ReportData data, const std::string& output, const std::string& only) {
    keep_groups(data, only);
    write_text_file(output, table_of(output)(data));
    std::printf("table: %s\n", output.c_str());
}

/// Of time against accuracy, and of some groups alone.
void write_chart(ReportData data, const std::string& output, const std::string& only) {
    keep_groups(data, only);
    save_raster(chart_raster(data), output);
    std::printf("chart: %s\n", output.c_str());
}

}  // namespace

void add_export_options(CLI::App& report, ReportExports& exports) {
    report.add_flag("--vti", exports.vti,
                    "write cells/CELL/cell.vti with all arrays, for ParaView; with -o FOLDER.cdb: "
                    "into the database");
    report
        .add_flag("--mosaic", exports.mosaic,
                  "with -o FILE.png: the reference and a column per result, labelled")
        ->excludes("--figure");
    report
        .add_option("--crop", exports.crops,
                    "with --mosaic: a part to enlarge, X,Y,WIDTH,HEIGHT; may be given again")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->check(not_empty());
    report
        .add_option("--metric", exports.metrics,
                    "with --mosaic: a metric or time_s, may be given again; default: psnr_float_db "
                    "and time_s")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll)
        ->check(not_empty());
    report
        .add_option(
            "--only", exports.only,
            "with --mosaic, --vti, a chart, a table or -o FOLDER.cdb: cells whose name matches "
            "this regular expression")
        ->excludes("--figure")
        ->check(not_empty());
}

std::optional<ExitCode> run_exports(const std::string& directory, const std::string& output,
                                    const ReportExports& exports) {
    require_sound(output, exports);
    const bool is_database = extension_of(output) == ".cdb";
    const bool is_table = table_of(output) != nullptr;
    const bool is_chart = is_picture(output) && !exports.mosaic && !exports.only.empty();
    if (!is_table && !is_database && !is_chart && !exports.vti && !exports.mosaic)
        return std::nullopt;
    const ReportData data = read_report_data(directory);
    if (is_database) {
        write_cinema(data, selected_rows(data, exports.only), output, exports.vti);
        std::printf("Cinema database: %s\n", output.c_str());
        return ExitCode::ok;
    }
    if (exports.vti) write_vtis(data, exports.only);
    if (exports.mosaic) write_mosaic(data, output, exports);
    if (is_table) write_table(data, output, exports.only);
    if (is_chart) write_chart(data, output, exports.only);
    const bool is_report = !output.empty() && !is_table && !is_chart && !exports.mosaic;
    return is_report ? std::nullopt : std::optional(ExitCode::ok);
}

}  // namespace vecino
