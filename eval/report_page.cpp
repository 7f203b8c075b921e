// SPDX-License-Identifier: Apache-2.0
//
// Puts the parts of the report together, with the data that its charts are drawn from.
#include "eval/html_text.h"
#include "eval/report_assets.h"
#include "eval/report_sections.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

Json methods_json(const ReportData& data) {
    Json methods = Json::array();
    for (const MethodStyle& style : data.methods) {
        methods.push_back(
            {{"method", style.method}, {"shape", style.shape}, {"colour", style.colour}});
    }
    return methods;
}

Json data_json(const ReportData& data) {
    Json groups = Json::array();
    for (std::size_t i = 0; i < data.groups.size(); ++i) {
        Json group = summary_json(data.groups[i]);
        group["id"] = "g" + std::to_string(i);
        group["parameters"] = parameters_text(data, data.groups[i]);
        groups.push_back(std::move(group));
    }
    return {{"groups", std::move(groups)},
            {"methods", methods_json(data)},
            {"scenes", data.scenes},
            {"time_decimals", data.time_decimals}};
}

std::string name_of(const ReportData& data) {
    return data.run.value("name", data.directory);
}

}  // namespace

std::string marker_html(const MethodStyle& style) {
    return "<svg class=\"marker c" + std::to_string(style.colour) +
           "\" aria-hidden=\"true\"><use href=\"#marker-" + std::string(style.shape) + "\"/></svg>";
}

std::string legend_html(const ReportData& data) {
    std::string html;
    for (const MethodStyle& style : data.methods) {
        html += "<button type=\"button\" aria-pressed=\"true\" data-method=\"";
        html += escaped(style.method);
        html += "\">";
        html += marker_html(style);
        html += escaped(style.method);
        html += style.method == "path" ? " (plain path tracing)</button>\n" : "</button>\n";
    }
    return html;
}

std::string charts_html(const ReportData& data) {
    std::string html;
    for (const std::string& scene : data.scenes) {
        const std::string name = escaped(scene);
        html += "<figure><figcaption>" + name;
        html += "</figcaption><div class=\"plot\"><canvas role=\"img\" data-scene=\"" + name;
        html += "\" aria-label=\"Time against psnr_float_db of every method on " + name;
        html += "; the numbers are in the results table.\"></canvas></div></figure>\n";
    }
    return html;
}

std::string report_page(const ReportData& data, const ReportPictures& pictures) {
    return fill_page(kReportHtml, {{"name", escaped(name_of(data))},
                                   {"css", std::string(kReportCss)},
                                   {"facts", facts_html(data)},
                                   {"legend", legend_html(data)},
                                   {"charts", charts_html(data)},
                                   {"table", table_html(data)},
                                   {"colour_bars", colour_bars_html(pictures)},
                                   {"cards", cards_html(data, pictures)},
                                   {"metrics", metrics_html()},
                                   {"failures", failures_html(data)},
                                   {"provenance", provenance_html(data)},
                                   {"data", script_json(data_json(data))},
                                   {"chart_js", script_source(kChartJs)},
                                   {"report_js", script_source(kReportJs)}});
}

}  // namespace vecino
