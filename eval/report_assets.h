// SPDX-License-Identifier: Apache-2.0
//
// The files of eval/report/ and Chart.js, embedded into the program by eval/embed.cmake.
#pragma once

#include <string_view>

namespace vecino {

extern const std::string_view kReportHtml;
extern const std::string_view kReportCss;
extern const std::string_view kReproductionCss;
extern const std::string_view kCatalogueCss;
extern const std::string_view kReportChartsJs;
extern const std::string_view kConvergenceJs;
extern const std::string_view kMatrixCss;
extern const std::string_view kViewerCss;
extern const std::string_view kMatrixJs;
extern const std::string_view kTableJs;
extern const std::string_view kPlanesJs;
extern const std::string_view kErrorsJs;
extern const std::string_view kPanesJs;
extern const std::string_view kLegendJs;
extern const std::string_view kViewerJs;
extern const std::string_view kReportJs;
extern const std::string_view kChartJs;

}  // namespace vecino
