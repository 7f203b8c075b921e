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
        group["variants"] = variants_of(data, data.groups[i]);
        group.erase("cells");
        groups.push_back(std::move(group));
    }
    return {{"groups", std::move(groups)},
            {"methods", methods_json(data)},
            {"scenes", data.scenes},
            {"metrics", metric_list_json(data)},
            {"graphs", graphs_json(data)},
            {"convergence", convergence_json(data.convergence)},
            {"time_decimals", data.time_decimals}};
}

std::string legend_remark(const std::string& method) {
    if (method == "path") return " (plain path tracing)";
    return method == "blocky_ceiling" ? " (best of one value per low-res pixel)" : "";
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
        html += legend_remark(style.method);
        html += "</button>\n";
    }
    return html;
}

/// Links to the sections that not every run has.
std::string contents_html(const ReportData& data) {
    std::string html;
    if (!data.convergence.empty()) html += "<a href=\"#convergence\">Convergence</a> ";
    if (!data.reproduction) return html;
    const Reproduction& specification = data.reproduction->specification;
    html = "<a href=\"#reproduction\">Reproduction</a> " + html;
    if (!specification.graphs.empty()) html += "<a href=\"#graphs\">Graphs</a> ";
    if (!specification.figures.empty()) html += "<a href=\"#figures\">Figures</a> ";
    return html;
}

std::string chart_switches_html(const ReportData& data) {
    const auto button = [](const std::string& attribute, const std::string& text, bool pressed) {
        return "<button type=\"button\" " + attribute + " aria-pressed=\"" +
               (pressed ? "true" : "false") + "\">" + escaped(text) + "</button>";
    };
    std::string html =
        "<div class=\"switch\" role=\"group\" aria-label=\"Region beside the whole image\">";
    for (const RegionInfo& info : kRegions) {
        const std::string name(info.name);
        html += button("data-region=\"" + name + "\"", name, info.region == Region::interior);
    }
    html += "</div>\n";
    if (!data.reproduction) return html;
    html += "<div class=\"switch\" role=\"group\" aria-label=\"Variant\">";
    const auto& variants = data.reproduction->specification.variants;
    for (std::size_t i = 0; i < variants.size(); ++i)
        html += button("data-variant=\"" + std::to_string(i) + "\"", variants[i].label, i == 0);
    return html + button("data-variant=\"\"", "all", false) + "</div>\n";
}

std::string charts_html(const ReportData& data) {
    std::string html;
    for (const std::string& scene : data.scenes) {
        const std::string name = escaped(scene);
        for (const char* part : {"whole", "region"}) {
            const bool is_whole = std::string_view(part) == "whole";
            html += "<figure><figcaption>" + name + ", ";
            html += is_whole ? "whole image" : "<span class=\"region-name\">interior</span>";
            html += "</figcaption><div class=\"plot\"><canvas role=\"img\" data-scene=\"" + name;
            html += "\" data-part=\"" + std::string(part);
            html += "\" aria-label=\"Time against psnr_float_db of every method on " + name;
            html += "; the numbers are in the results table.\"></canvas></div></figure>\n";
        }
    }
    return html;
}

std::string report_page(const ReportData& data, const ReportPictures& pictures) {
    return fill_page(kReportHtml,
                     {{"name", escaped(name_of(data))},
                      {"css", std::string(kReportCss) + std::string(kReproductionCss)},
                      {"picture_sources", pictures.has_linked ? "data: file: 'self'" : "data:"},
                      {"facts", facts_html(data)},
                      {"reproduction", reproduction_html(data)},
                      {"convergence", convergence_html(data)},
                      {"graphs", graphs_html(data)},
                      {"figures", figures_html(data, pictures)},
                      {"switches", chart_switches_html(data)},
                      {"legend", legend_html(data)},
                      {"charts", charts_html(data)},
                      {"table", table_html(data)},
                      {"colour_bars", colour_bars_html(pictures)},
                      {"cards", cards_html(data, pictures)},
                      {"metrics", metrics_html()},
                      {"regions", regions_html()},
                      {"contents", contents_html(data)},
                      {"references", references_html(data)},
                      {"failures", failures_html(data)},
                      {"provenance", provenance_html(data)},
                      {"data", script_json(data_json(data))},
                      {"chart_js", script_source(kChartJs)},
                      {"report_charts_js", script_source(kReportChartsJs)},
                      {"convergence_js", script_source(kConvergenceJs)},
                      {"report_js", script_source(kReportJs)}});
}

}  // namespace vecino
