// SPDX-License-Identifier: Apache-2.0
#include "eval/report.h"

#include "core/error.h"
#include "eval/report_data.h"
#include "eval/report_pictures.h"
#include "eval/report_sections.h"
#include "eval/run_directory.h"

namespace vecino {

std::string write_report(const std::string& directory, const std::string& output) {
    std::string path = output.empty() ? directory + "/report.html" : output;
    const ReportData data = read_report_data(directory);
    write_text_file(path, report_page(data, make_report_pictures(data)));
    return path;
}

}  // namespace vecino
