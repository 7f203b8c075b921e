// SPDX-License-Identifier: Apache-2.0
#include "eval/report.h"

#include <filesystem>

#include "core/error.h"
#include "core/image_io.h"
#include "eval/report_pictures.h"
#include "eval/report_raster.h"
#include "eval/report_sections.h"
#include "eval/run_directory.h"

namespace vecino {

std::string write_report(const ReportData& data, const std::string& output,
                         std::optional<PlanePrecision> embedded) {
    std::string path = output.empty() ? data.directory + "/report.html" : output;
    write_reproduction(data);
    write_failures(data);
    const bool is_markdown = std::filesystem::path(path).extension() == ".md";
    write_text_file(path, is_markdown
                              ? report_markdown(data)
                              : report_page(data, make_report_pictures(data, {path, embedded})));
    return path;
}

void write_report_picture(const ReportData& data, const std::string& output,
                          const std::string& figure) {
    save_raster(figure.empty() ? chart_raster(data) : mosaic_raster(data, figure), output);
}

}  // namespace vecino
