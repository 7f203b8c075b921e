// SPDX-License-Identifier: Apache-2.0
//
// The parts of the report's page that depend on the run, as HTML. What does not is in
// report/report.html.
#pragma once

#include <string>

#include "eval/report_data.h"
#include "eval/report_pictures.h"

namespace vecino {

/// The whole page.
std::string report_page(const ReportData& data, const ReportPictures& pictures);

// About the run.
std::string facts_html(const ReportData& data);
std::string failures_html(const ReportData& data);
std::string provenance_html(const ReportData& data);
std::string metrics_html();

// The chart's frame and the table.
std::string marker_html(const MethodStyle& style);
std::string legend_html(const ReportData& data);
std::string charts_html(const ReportData& data);
std::string table_html(const ReportData& data);

// Pictures.
std::string colour_bars_html(const ReportPictures& pictures);
std::string cards_html(const ReportData& data, const ReportPictures& pictures);

/// "27.13", "identical" for images that equal their reference, "–" where there is no number.
std::string psnr_float_text(const ReportData& data, const GroupSummary& group);

/// "± 0.08"; "≥ 26.92" if the interval is open above; empty without an interval.
std::string psnr_float_interval(const GroupSummary& group);

}  // namespace vecino
