// SPDX-License-Identifier: Apache-2.0
//
// What the report says about the run itself: when, where, of what, what failed, how to make it
// again.
#include <algorithm>
#include <set>

#include "eval/commands.h"
#include "eval/html_text.h"
#include "eval/metrics.h"
#include "eval/reference_error.h"
#include "eval/reference_quality.h"
#include "eval/report_facts.h"
#include "eval/report_sections.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

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
    for (const Fact& each : run_facts(data)) html += fact(each.name, each.value);
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
    for (const SplitInfo& info : kSplitColumns) {
        html += "<div><dt>" + escaped(info.name) + "</dt><dd>" + escaped(info.formula) +
                "</dd></div>\n";
    }
    return html + "<div><dt>≈R</dt><dd>" + escaped(kLimitedFormula) + "</dd></div>\n";
}

nlohmann::json metric_list_json(const ReportData& data) {
    Json list = Json::array();
    for (const MetricInfo& metric : all_metrics()) {
        const auto decimals = data.metric_decimals.find(std::string(metric.name));
        if (decimals == data.metric_decimals.end()) continue;
        list.push_back({{"name", metric.name},
                        {"formula", metric.formula},
                        {"unit", metric.scale == ErrorScale::decibel ? "dB" : ""},
                        {"decimals", decimals->second},
                        {"higher_is_better", metric.higher_is_better}});
    }
    return list;
}

std::string regions_html() {
    std::string html;
    for (const RegionInfo& region : kRegions) {
        html += "<div><dt><code>" + std::string(region.name) + "</code></dt><dd>" +
                escaped(region.definition) + "</dd></div>\n";
    }
    return html;
}

std::string references_html(const ReportData& data) {
    const auto db = [](const std::optional<double>& value) {
        return value ? number_text(*value, 2) : std::string("–");
    };
    std::string html =
        "<table class=\"plain\"><thead><tr><th scope=\"col\">scene</th><th "
        "scope=\"col\">region</th><th scope=\"col\">own error, dB</th><th scope=\"col\">best "
        "result, dB</th><th scope=\"col\">margin, dB</th><th scope=\"col\">results within 15 "
        "dB</th></tr></thead><tbody>\n";
    for (const ReferenceQuality& reference : reference_quality(data)) {
        for (const ReferencePart& part : reference.parts) {
            std::string close = part.own_db ? std::to_string(part.too_close.size()) : "–";
            if (!part.too_close.empty()) close = "<strong>" + close + "</strong>";
            html += "<tr><th scope=\"row\">" + escaped(reference.scene) + "</th><td>" +
                    (part.region.empty() ? "whole" : escaped(part.region)) + "</td><td>" +
                    db(part.own_db) + "</td><td>" + db(part.best_db) + " <code>" +
                    escaped(part.best) + "</code></td><td>" + db(part.margin_db()) + "</td><td>" +
                    close + "</td></tr>\n";
        }
    }
    return html + "</tbody></table>";
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
