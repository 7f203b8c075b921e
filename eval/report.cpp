// SPDX-License-Identifier: Apache-2.0
#include "eval/report.h"

#include "core/error.h"
#include "eval/report_pictures.h"
#include "eval/report_sections.h"
#include "eval/run_directory.h"

namespace vecino {

std::string write_report(const ReportData& data, const std::string& output) {
    std::string path = output.empty() ? data.directory + "/report.html" : output;
    write_reproduction(data);
    write_text_file(path, report_page(data, make_report_pictures(data)));
    return path;
}

}  // namespace vecino
