// SPDX-License-Identifier: Apache-2.0
//
// Puts the parts of the report together, with the data that its charts are drawn from.
#include <algorithm>

#include "eval/equal_error.h"
#include "eval/error_map.h"
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

/// The colours of a map from the lower end of its range to the upper one, as on the error pictures:
/// "rrggbb" after "rrggbb".
std::string map_colours(ErrorKind kind) {
    const int count = kind == ErrorKind::sign ? 513 : 256;
    const float low = kind == ErrorKind::sign ? -1.0f : 0.0f;
    Grid<float> ramp({count, 1});
    for (int i = 0; i < count; ++i)
        ramp(i, 0) = low + (1 - low) * static_cast<float>(i) / static_cast<float>(count - 1);
    std::string text;
    const Grid<glm::u8vec3> colours = error_colours(ramp, {kind, 1.0f, ""});
    for (const glm::u8vec3 colour : colours.values()) {
        char hex[8];
        std::snprintf(hex, sizeof hex, "%02x%02x%02x", unsigned{colour.r}, unsigned{colour.g},
                      unsigned{colour.b});
        text += hex;
    }
    return text;
}

/// What the viewer needs to know beside the groups.
Json viewer_json(const ReportPictures& pictures) {
    const bool is_half = pictures.embedded == PlanePrecision::float16;
    return {{"folder", pictures.planes_folder},
            {"embedded", pictures.embedded.has_value()},
            {"precision", is_half ? "float16" : "float32"},
            {"ranges", {{"magnitude", pictures.magnitude_range}, {"sign", pictures.sign_range}}},
            {"colours",
             {{"magnitude", map_colours(ErrorKind::magnitude)},
              {"sign", map_colours(ErrorKind::sign)}}}};
}

/// Which float values a group's pictures are made of.
void add_planes(Json& group, const ReportData& data, const ReportPictures& pictures) {
    const auto shown = pictures.by_group.find(group["group"].get<std::string>());
    if (shown == pictures.by_group.end()) return;
    group["cell"] = shown->second.cell;
    group["plane"] = shown->second.plane;
    group["reference"] = data.row_of(shown->second.cell)["reference_file"];
}

std::string embedded_planes(const ReportPictures& pictures) {
    std::string html;
    for (const auto& [file, element] : pictures.embedded_references) html += element;
    for (const auto& [group, shown] : pictures.by_group) html += shown.embedded_plane;
    return html;
}

Json data_json(const ReportData& data, const ReportPictures& pictures) {
    Json groups = Json::array();
    for (std::size_t i = 0; i < data.groups.size(); ++i) {
        Json group = summary_json(data.groups[i]);
        group["id"] = "g" + std::to_string(i);
        group["parameters"] = parameters_text(data, data.groups[i]);
        group["variants"] = variants_of(data, data.groups[i]);
        group["short"] = short_name(data.groups[i]);
        group.erase("cells");
        add_planes(group, data, pictures);
        groups.push_back(std::move(group));
    }
    return {{"groups", std::move(groups)},
            {"methods", methods_json(data)},
            {"scenes", data.scenes},
            {"varying", data.varying},
            {"viewer", viewer_json(pictures)},
            {"metrics", metric_list_json(data)},
            {"graphs", graphs_json(data)},
            {"convergence", convergence_json(data.convergence)},
            {"time_decimals", data.time_decimals}};
}

std::string legend_remark(const std::string& method) {
    if (method == "path") return " (plain path tracing)";
    return method == "blocky_ceiling" ? " (best of one value per low-res pixel)" : "";
}

std::string style_text() {
    std::string text;
    for (const auto& part : {kReportCss, kMatrixCss, kReproductionCss, kCatalogueCss, kViewerCss})
        text += part;
    return text;
}

/// Our own, in the order in which they build on each other.
std::string scripts_html() {
    std::string html;
    for (const auto& part : {kReportChartsJs, kConvergenceJs, kMatrixJs, kTableJs, kErrorsJs,
                             kPlanesJs, kPanesJs, kLegendJs, kViewerJs, kReportJs}) {
        html += "<script>" + script_source(part) + "</script>\n";
    }
    return html;
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
    const std::string first =
        data.failures.cases.empty() ? "" : "<a href=\"#catalogue\">Where methods fail</a> ";
    std::string html;
    if (!data.convergence.empty()) html += "<a href=\"#convergence\">Convergence</a> ";
    if (!equal_error(data.groups).rows.empty())
        html += "<a href=\"#equal-error\">Time to equal error</a> ";
    if (has_stability(data)) html += "<a href=\"#stability\">Stability</a> ";
    if (!data.reproduction) return first + html;
    const Reproduction& specification = data.reproduction->specification;
    html = first + "<a href=\"#reproduction\">Reproduction</a> " + html;
    if (!specification.graphs.empty()) html += "<a href=\"#graphs\">Graphs</a> ";
    if (!specification.figures.empty()) html += "<a href=\"#figures\">Figures</a> ";
    return html;
}

/// References from files may have no planes to tell regions by.
bool has_regions(const ReportData& data) {
    return std::ranges::any_of(data.groups, [](const GroupSummary& group) {
        return std::ranges::any_of(group.region_psnr_float_db,
                                   [](const auto& value) { return value.has_value(); });
    });
}

std::string chart_switches_html(const ReportData& data) {
    const auto button = [](const std::string& attribute, const std::string& text, bool pressed) {
        return "<button type=\"button\" " + attribute + " aria-pressed=\"" +
               (pressed ? "true" : "false") + "\">" + escaped(text) + "</button>";
    };
    std::string html;
    if (has_regions(data)) {
        html +=
            "<div class=\"switch\" role=\"group\" aria-label=\"Region beside the whole image\">";
        for (const RegionInfo& info : kRegions) {
            const std::string name(info.name);
            html += button("data-region=\"" + name + "\"", name, info.region == Region::interior);
        }
        html += "</div>\n";
    }
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
            if (!is_whole && !has_regions(data)) continue;
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
    return fill_page(
        kReportHtml,
        {{"name", escaped(name_of(data))},
         {"css", style_text()},
         {"picture_sources", pictures.has_linked ? "data: file: 'self'" : "data:"},
         {"script_sources", pictures.embedded ? "'unsafe-inline'" : "'unsafe-inline' file: 'self'"},
         {"facts", facts_html(data)},
         {"catalogue", catalogue_html(data)},
         {"reproduction", reproduction_html(data)},
         {"convergence", convergence_html(data)},
         {"equal_error", equal_error_html(data)},
         {"stability", stability_html(data)},
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
         {"data", script_json(data_json(data, pictures))},
         {"planes", embedded_planes(pictures)},
         {"chart_js", script_source(kChartJs)},
         {"scripts", scripts_html()}});
}

}  // namespace vecino
