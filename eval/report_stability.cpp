// SPDX-License-Identifier: Apache-2.0
//
// Stability beside time and error: one row per group whose matrix asked for it. The page and the
// Markdown report show the same columns.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>

#include "eval/commands.h"
#include "eval/html_text.h"
#include "eval/report_sections.h"
#include "eval/stability_summary.h"

namespace vecino {
namespace {

struct Column {
    std::string name, unit;
    std::function<std::string(const GroupSummary&)> text;
};

constexpr const char* kNone = "–";

/// "0.52", "12.3", "1234": as many digits as matter.
std::string ratio_text(double value) {
    const double size = std::abs(value);
    return number_text(value, size < 10 ? 2 : size < 100 ? 1 : 0);
}

/// "+1.30", "−0.42", "0.00".
std::string signed_text(double value) {
    const std::string digits = ratio_text(std::abs(value));
    if (digits == "0.00") return digits;
    return (value < 0 ? "−" : "+") + digits;
}

std::string share_text(double share) {
    if (!(share > 0)) return "0";
    return share < 0.0001 ? "< 0.01" : number_text(100 * share, 2);
}

std::string number_or_none(const std::optional<double>& value, int decimals) {
    return value ? number_text(*value, decimals) : kNone;
}

/// "0.99 (1.05)": without noise, and with it.
std::string shimmer_text(const GroupSummary& group, double shift) {
    const auto& all = group.stability->shimmer;
    const auto at = std::ranges::find(all, shift, &Shimmer::shift);
    if (at == all.end()) return kNone;
    return (at->without_noise ? ratio_text(*at->without_noise) : kNone) + " (" +
           ratio_text(at->with_noise) + ")" + (group.stability->is_limited ? " ≈R" : "");
}

void add_shimmer(double shift, std::vector<Column>& columns) {
    char text[48];
    std::snprintf(text, sizeof text, "%g px (noise)", shift);
    columns.push_back({"shimmer", text,
                       [shift](const GroupSummary& group) { return shimmer_text(group, shift); }});
}

void add_elasticity(const std::string& parameter, std::vector<Column>& columns) {
    columns.push_back({"elasticity", parameter, [parameter](const GroupSummary& group) {
                           const auto& all = group.stability->elasticity;
                           const auto found = all.find(parameter);
                           return found == all.end() ? kNone : signed_text(found->second.value);
                       }});
}

void add_counts(std::vector<Column>& columns) {
    columns.push_back({"fallback", "%", [](const GroupSummary& group) {
                           return share_text(group.stability->fallback_share);
                       }});
    columns.push_back({"dropped", "samples", [](const GroupSummary& group) {
                           return std::to_string(group.stability->dropped_samples);
                       }});
    columns.push_back({"non-finite", "pixels", [](const GroupSummary& group) {
                           return std::to_string(group.stability->non_finite_pixels);
                       }});
}

std::vector<Column> columns_of(const ReportData& data) {
    std::set<double> shifts;
    std::set<std::string> parameters;
    for (const GroupSummary& group : data.groups) {
        if (!group.stability) continue;
        for (const Shimmer& each : group.stability->shimmer) shifts.insert(each.shift);
        for (const auto& [parameter, value] : group.stability->elasticity)
            parameters.insert(parameter);
    }
    std::vector<Column> columns{
        {"psnr_float_db", "dB",
         [&data](const GroupSummary& group) { return psnr_float_text(data, group); }},
        {"time", "s",
         [&data](const GroupSummary& group) {
             return number_text(group.time_s, data.time_decimals);
         }},
        {"spread", "dB",
         [](const GroupSummary& group) { return number_or_none(group.stability->spread_db, 2); }},
        {"worst seed", "dB",
         [](const GroupSummary& group) { return number_or_none(group.stability->worst_db, 2); }}};
    for (const double shift : shifts) add_shimmer(shift, columns);
    for (const std::string& parameter : parameters) add_elasticity(parameter, columns);
    add_counts(columns);
    return columns;
}

/// A name of many parts may go on in the next line after each.
std::string breakable(const std::string& name) {
    std::string html;
    for (const char c : name) {
        html += escaped(std::string(1, c));
        if (c == '.' || c == '_') html += "<wbr>";
    }
    return html;
}

std::string head(const std::string& name, const std::string& unit) {
    return "<th scope=\"col\"><span class=\"name\">" + escaped(name) +
           "</span><span class=\"unit\">" + escaped(unit) + "</span></th>";
}

std::string row_html(const ReportData& data, const GroupSummary& group, bool is_first) {
    const std::string scene = escaped(group.scene);
    return std::string(is_first ? "<tr class=\"first-of-scene\">" : "<tr>") + "<td>" + scene +
           "</td><th scope=\"row\" data-scene=\"" + scene + "\"><a href=\"#g" +
           std::to_string(index_of(data, group)) + "\">" +
           marker_html(data.style_of(group.method)) + breakable(short_name(group)) + "</a></th>";
}

std::string notes_html() {
    std::string html = "<dl class=\"metrics stability-notes\">\n";
    for (const StabilityInfo& info : stability_columns()) {
        html += "<div><dt>" + escaped(info.name) + "</dt><dd>" + escaped(info.formula) +
                "</dd></div>\n";
    }
    return html + "</dl>\n";
}

constexpr const char* kIntroduction =
    "How much each result changes when something does that should matter little: the seed, the "
    "camera by a part of a pixel, a parameter by half of it. Time and error stand beside it, for a "
    "method may buy the one with the other.";

}  // namespace

bool has_stability(const ReportData& data) {
    return std::ranges::any_of(data.groups,
                               [](const GroupSummary& g) { return g.stability.has_value(); });
}

std::string stability_html(const ReportData& data) {
    if (!has_stability(data)) return "";
    const std::vector<Column> columns = columns_of(data);
    std::string html =
        "<section id=\"stability\">\n<h2>Stability</h2>\n<p class=\"note\">" +
        std::string(kIntroduction) +
        "</p>\n<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Stability\">"
        "<table class=\"stability\">\n<thead><tr>" +
        head("scene", "") + head("result", "");
    for (const Column& column : columns) html += head(column.name, column.unit);
    html += "</tr></thead><tbody>\n";
    std::string scene;
    for (const GroupSummary& group : data.groups) {
        if (!group.stability) continue;
        html += row_html(data, group, group.scene != scene);
        scene = group.scene;
        for (const Column& column : columns) html += "<td>" + escaped(column.text(group)) + "</td>";
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n" + notes_html() + "</section>\n\n";
}

StabilityTable stability_table(const ReportData& data, const std::string& scene) {
    const std::vector<Column> columns = columns_of(data);
    StabilityTable table;
    table.names.push_back("result");
    for (const Column& column : columns) table.names.push_back(column.name + ", " + column.unit);
    for (const GroupSummary& group : data.groups) {
        if (!group.stability || group.scene != scene) continue;
        table.results.push_back(short_name(group));
        table.rows.emplace_back();
        for (const Column& column : columns) table.rows.back().push_back(column.text(group));
    }
    return table;
}

std::string stability_introduction() {
    return kIntroduction;
}

}  // namespace vecino
