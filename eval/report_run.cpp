// SPDX-License-Identifier: Apache-2.0
//
// What the report says about the run itself: when, where, of what, what failed, how to make it
// again.
#include <algorithm>
#include <set>

#include "eval/html_text.h"
#include "eval/metrics.h"
#include "eval/report_sections.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

std::string text_of(const Json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string counted(std::size_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

/// The different values of a key of all rows, as a list.
std::string values_of(const ReportData& data, const char* key) {
    std::vector<std::string> values;
    for (const Json& row : data.rows) {
        if (!row.contains(key)) continue;
        const std::string text = text_of(row[key]);
        if (std::ranges::find(values, text) == values.end()) values.push_back(text);
    }
    std::string list;
    for (const std::string& value : values) list += (list.empty() ? "" : ", ") + value;
    return list.empty() ? "unknown" : list;
}

std::string when(const ReportData& data) {
    std::string date = data.run.value("finished_utc", "");
    if (date.size() != 20) return "not finished";
    return date.replace(10, 1, " ").substr(0, 16) + " UTC";
}

std::string program(const ReportData& data) {
    const Json versions = data.run.value("versions", Json::object());
    return "vecino " + versions.value("vecino", "of unknown version");
}

std::size_t failed_rows(const ReportData& data) {
    const auto failed = [](const Json& row) { return row["status"] != "ok"; };
    return static_cast<std::size_t>(std::ranges::count_if(data.rows, failed));
}

std::string cells(const ReportData& data) {
    const std::size_t planned = data.run.value("cells", data.rows.size());
    const std::size_t failed = failed_rows(data);
    std::string text = std::to_string(data.rows.size());
    if (planned > data.rows.size()) text += " of " + std::to_string(planned) + " so far";
    text += " in " + counted(data.groups.size(), "group");
    return text + (failed == 0 ? "; none failed" : "; " + std::to_string(failed) + " failed");
}

/// Parameters with one value in the whole matrix.
std::string fixed_parameters(const ReportData& data) {
    const std::set<std::string> apart{"scene", "method", "seed", "spp_asked"};
    std::string text;
    for (const auto& [key, value] : data.groups.front().params.items()) {
        const bool varies = std::ranges::find(data.varying, key) != data.varying.end();
        if (varies || apart.contains(key)) continue;
        text += (text.empty() ? "" : ", ") + key + " " +
                parameter_text(data.groups.front().params, key);
    }
    return text;
}

std::string references(const ReportData& data) {
    std::vector<std::string> texts;
    for (const Json& row : data.rows) {
        const std::string text = reference_text(row);
        if (std::ranges::find(texts, text) == texts.end()) texts.push_back(text);
    }
    std::string all;
    for (const std::string& text : texts) all += (all.empty() ? "" : "; ") + text;
    return all;
}

std::string fact(const std::string& name, const std::string& value) {
    return "<div><dt>" + name + "</dt><dd>" + escaped(value) + "</dd></div>\n";
}

bool is_plain(char c) {
    const bool alphanumeric =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
    return alphanumeric || std::string_view("_-./+,:=@%").find(c) != std::string_view::npos;
}

}  // namespace

std::string shell_word(const std::string& text) {
    if (!text.empty() && std::ranges::all_of(text, is_plain)) return text;
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

std::string run_command_text(const ReportData& data) {
    std::string text = data.run.value("command", "");
    if (text.empty()) return "unknown: run.json is missing or names no command";
    if (text.find(" -o ") == std::string::npos) text += " -o " + shell_word(data.directory);
    return text;
}

std::string facts_html(const ReportData& data) {
    std::string html = "<dl class=\"facts\">\n";
    html += fact("Finished", when(data));
    html += fact("Program", program(data));
    html += fact("Processor", values_of(data, "host"));
    html += fact("Threads", values_of(data, "threads"));
    html += fact("Cells", cells(data));
    html += fact("Seeds", values_of(data, "seed"));
    html += fact("In all cells", fixed_parameters(data));
    html += fact("Reference", references(data));
    return html + "</dl>\n<p class=\"command\"><span>Made again by</span> <code id=\"command\">" +
           escaped(run_command_text(data)) + "</code></p>";
}

std::string metrics_html() {
    std::string html;
    for (const MetricInfo& metric : all_metrics()) {
        html += "<div><dt><code>" + escaped(metric.name) + "</code></dt><dd>" +
                escaped(metric.formula) + "; " + (metric.higher_is_better ? "higher" : "lower") +
                " is better</dd></div>\n";
    }
    return html;
}

std::string regions_html() {
    std::string html;
    for (const RegionInfo& region : kRegions) {
        html += "<div><dt><code>" + std::string(region.name) + "</code></dt><dd>" +
                escaped(region.definition) + "</dd></div>\n";
    }
    return html;
}

std::string failures_html(const ReportData& data) {
    if (failed_rows(data) == 0) return "<p>None.</p>";
    std::string html =
        "<table class=\"plain\"><thead><tr><th scope=\"col\">cell</th><th scope=\"col\">reason</th>"
        "</tr></thead><tbody>\n";
    for (const Json& row : data.rows) {
        if (row["status"] == "ok") continue;
        html += "<tr><th scope=\"row\"><code>" + escaped(text_of(row["cell"])) +
                "</code></th><td>" + escaped(row.value("reason", "no reason was given")) +
                "</td></tr>\n";
    }
    return html + "</tbody></table>";
}

std::string provenance_html(const ReportData& data) {
    std::string html = "<dl class=\"versions\">\n";
    const Json versions = data.run.value("versions", Json::object());
    for (const auto& [name, value] : versions.items()) html += fact(escaped(name), text_of(value));
    html += "</dl>\n<h3>Matrix</h3>\n<pre>";
    return html + escaped(data.run.value("config", Json()).dump(2)) + "</pre>";
}

}  // namespace vecino
