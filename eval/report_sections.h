// SPDX-License-Identifier: Apache-2.0
//
// The parts of the report's page that depend on the run, as HTML. What does not is in
// report/report.html.
#pragma once

#include <string>
#include <vector>

#include "eval/report_data.h"
#include "eval/report_pictures.h"

namespace vecino {

/// The whole page.
std::string report_page(const ReportData& data, const ReportPictures& pictures);

/// The same results as Markdown tables. The same bytes for the same run directory.
std::string report_markdown(const ReportData& data);

/// Where methods fail: the chart of methods and failures. Empty without failures in the matrix.
std::string catalogue_html(const ReportData& data);
std::string catalogue_markdown(const ReportData& data);

// About the run.
std::string facts_html(const ReportData& data);
std::string failures_html(const ReportData& data);
std::string provenance_html(const ReportData& data);
/// The command line that made the run.
std::string run_command_text(const ReportData& data);
/// A word as a shell takes it: quoted where it has to be.
std::string shell_word(const std::string& text);
std::string metrics_html();
/// Of the metrics that some group has: name, formula, unit, decimals, higher_is_better.
nlohmann::json metric_list_json(const ReportData& data);
std::string regions_html();
/// How good the references are for what they judge.
std::string references_html(const ReportData& data);
std::string contents_html(const ReportData& data);

// The chart's frame and the table.
std::string marker_html(const MethodStyle& style);
std::string legend_html(const ReportData& data);
std::string charts_html(const ReportData& data);
std::string table_html(const ReportData& data);

/// Buttons that switch the charts between the whole image and its regions, and between variants.
std::string chart_switches_html(const ReportData& data);

// What the run reproduces; empty where its matrix claims nothing.
std::string reproduction_html(const ReportData& data);
std::string graphs_html(const ReportData& data);
nlohmann::json graphs_json(const ReportData& data);
std::string figures_html(const ReportData& data, const ReportPictures& pictures);

/// Error of path tracing against samples and time; empty where no groups differ in spp alone.
std::string convergence_html(const ReportData& data);

/// What time budgets buy; empty without any.
std::string equal_error_html(const ReportData& data);
std::string equal_error_markdown(const ReportData& data);

// Stability; empty where no matrix asked for it.
bool has_stability(const ReportData& data);
std::string stability_html(const ReportData& data);

/// The same as texts, of one scene.
struct StabilityTable {
    std::vector<std::string> names;  ///< of the columns: the result, then those of the rows
    std::vector<std::string> results;
    std::vector<std::vector<std::string>> rows;
};
StabilityTable stability_table(const ReportData& data, const std::string& scene);
std::string stability_introduction();

// Pictures.
std::string colour_bars_html(const ReportPictures& pictures);
std::string cards_html(const ReportData& data, const ReportPictures& pictures);

/// "27.13", "identical" for images that equal their reference, "–" where there is no number.
std::string psnr_float_text(const ReportData& data, const GroupSummary& group);

/// "± 0.08"; "≥ 26.92" if the interval is open above; empty without an interval.
std::string psnr_float_interval(const GroupSummary& group);

}  // namespace vecino
