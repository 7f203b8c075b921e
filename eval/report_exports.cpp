// SPDX-License-Identifier: Apache-2.0
#include "eval/report_exports.h"

#include <cstdio>
#include <filesystem>

#include "core/image_io.h"
#include "eval/cell_vti.h"
#include "eval/cinema.h"
#include "eval/commands.h"
#include "eval/crop_mosaic.h"
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

[[noreturn]] void misplaced(const std::string& flag, const std::string& allowed) {
    throw Error(ExitCode::usage, "command line: " + flag + ": found without " + allowed +
                                     ", allowed: with " + allowed);
}

void require_sound(const std::string& output, const ReportExports& exports) {
    const bool is_mosaic = exports.mosaic && is_picture(output);
    if (exports.mosaic && !is_mosaic) misplaced("--mosaic", "-o FILE.png or FILE.bmp");
    if (!exports.crops.empty() && !is_mosaic) misplaced("--crop", "--mosaic");
    if (!exports.metrics.empty() && !is_mosaic) misplaced("--metric", "--mosaic");
    const bool reads_only = is_mosaic || exports.vti || extension_of(output) == ".cdb";
    if (!exports.only.empty() && !reads_only)
        misplaced("--only", "--mosaic, --vti or -o FOLDER.cdb");
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

/// Whether a table was asked for, and written.
bool write_table(const ReportData& data, const std::string& output) {
    const std::string extension = extension_of(output);
    std::string (*const table)(const ReportData&) = extension == ".csv"     ? summary_csv
                                                    : extension == ".jsonl" ? summary_jsonl
                                                    : extension == ".tex"   ? summary_latex
                                                                            : nullptr;
    if (table == nullptr) return false;
    write_text_file(output, table(data));
    std::printf("table: %s\n", output.c_str());
    return true;
}

}  // namespace

void add_export_options(CLI::App& report, ReportExports& exports) {
    report.add_flag("--vti", exports.vti,
                    "write cells/CELL/cell.vti with all arrays, for ParaView; with -o FOLDER.cdb: "
                    "into the database");
    report.add_flag("--mosaic", exports.mosaic,
                    "with -o FILE.png: the reference and a column per result, labelled");
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
        .add_option("--only", exports.only,
                    "with --mosaic, --vti and -o FOLDER.cdb: cells whose name matches this regular "
                    "expression")
        ->check(not_empty());
}

std::optional<ExitCode> run_exports(const std::string& directory, const std::string& output,
                                    const ReportExports& exports) {
    require_sound(output, exports);
    const std::string extension = extension_of(output);
    const bool is_table = extension == ".csv" || extension == ".jsonl" || extension == ".tex";
    if (!is_table && !exports.vti && !exports.mosaic && extension != ".cdb") return std::nullopt;
    const ReportData data = read_report_data(directory);
    if (extension == ".cdb") {
        write_cinema(data, selected_rows(data, exports.only), output, exports.vti);
        std::printf("Cinema database: %s\n", output.c_str());
        return ExitCode::ok;
    }
    if (exports.vti) write_vtis(data, exports.only);
    if (exports.mosaic) write_mosaic(data, output, exports);
    const bool is_report = !output.empty() && !write_table(data, output) && !exports.mosaic;
    return is_report ? std::nullopt : std::optional(ExitCode::ok);
}

}  // namespace vecino
