// SPDX-License-Identifier: Apache-2.0
//
// The files of eval/report/ and Chart.js, embedded into the program by eval/embed.cmake.
#pragma once

#include <string_view>

namespace vecino {

extern const std::string_view kReportHtml;
extern const std::string_view kReportCss;
extern const std::string_view kReproductionCss;
extern const std::string_view kReportChartsJs;
extern const std::string_view kConvergenceJs;
extern const std::string_view kReportJs;
extern const std::string_view kChartJs;

}  // namespace vecino
