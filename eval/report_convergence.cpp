// SPDX-License-Identifier: Apache-2.0
//
// What the report says about how path tracing converges: charts' frames, and tables of slopes and
// speed-ups.
#include <algorithm>
#include <vector>

#include "eval/commands.h"
#include "eval/html_text.h"
#include "eval/report_sections.h"

namespace vecino {
namespace {

using Curves = std::vector<ConvergenceCurve>;

constexpr const char* kNote =
    "How path tracing's error falls with samples per pixel and with the time spent on tracing, one "
    "line per way of sampling; both axes of a chart are logarithmic. The error is relMSE, <span "
    "class=\"formula\">mean of (x − r)² / (r² + 0.01)</span>, linear in radiance; its variance "
    "over "
    "seeds is the part of it that is noise, and does not hold the reference's own error. Slopes "
    "are "
    "those of straight lines fitted by least squares to the logarithms of means over seeds, ± "
    "their "
    "standard error: −1 is what independent samples give, and at −2 "
    "ten times the samples have a hundredth of the error. A baseline is the thesis's path tracing: "
    "light found by chance, independent "
    "samples.";

constexpr const char* kSpeedUpNote =
    "Speed-up at equal error: the time in which the baseline reaches the error that a variant has "
    "at the given number of samples, over the variant's own time. Where the baseline was not run "
    "that far, its time is extrapolated from its last point along its slope against samples, at "
    "its last point's rate, and marked <span class=\"extrapolated\">extrapolated</span>. The "
    "measured speed-up is the geometric mean over the range of errors in which both were measured; "
    "errors are in decibels, −10 log10 of relMSE.";

/// "−1.02 ± 0.03"
std::string slope_html(const std::optional<PowerLaw>& law) {
    if (!law) return "–";
    std::string text = number_text(std::abs(law->slope), 2);
    if (law->slope < 0) text = "−" + text;
    if (law->slope_error) text += " ± " + number_text(*law->slope_error, 2);
    return text;
}

std::string speed_up_html(const ConvergenceCurve& curve) {
    if (curve.is_baseline) return "baseline";
    if (!curve.speed_up) return "–";
    const std::string text = factor_text(curve.speed_up->factor);
    if (!curve.speed_up->is_extrapolated) return text;
    return "<span class=\"extrapolated\" title=\"extrapolated\">" + text + "</span>";
}

std::string common_html(const ConvergenceCurve& curve) {
    if (!curve.common) return "–";
    return factor_text(curve.common->factor) + " <span class=\"ci\">" +
           number_text(error_in_db(curve.common->most_error), 1) + " to " +
           number_text(error_in_db(curve.common->least_error), 1) + " dB</span>";
}

std::string cell(const std::string& html) {
    return "<td>" + html + "</td>";
}

std::string head(const std::string& name, const std::string& unit) {
    return "<th scope=\"col\"><span class=\"name\">" + name + "</span><span class=\"unit\">" +
           unit + "</span></th>";
}

std::string curve_row(const ReportData& data, const ConvergenceCurve& curve, bool is_first) {
    const ConvergencePoint& judged = curve.points[curve.judged];
    const auto group = std::ranges::find(data.groups, judged.group, &GroupSummary::group);
    const std::string id = "g" + std::to_string(group - data.groups.begin());
    std::string html = is_first ? "<tr class=\"first-of-scene\">" : "<tr>";
    html += cell(escaped(curve.scene));
    html += "<th scope=\"row\" data-scene=\"" + escaped(curve.scene) + "\"><a href=\"#" + id +
            "\">" + escaped(curve.variant) + "</a></th>";
    html += cell(slope_html(curve.error_by_spp)) + cell(slope_html(curve.variance_by_spp));
    html += cell(slope_html(curve.error_by_time)) + cell(std::to_string(judged.spp));
    html += cell(number_text(error_in_db(judged.error.mean), 2));
    html += cell(judged.psnr_float_db ? number_text(judged.psnr_float_db->mean, 2) : "–");
    html += cell(number_text(1e-6 * curve.samples_per_s, 2));
    return html + cell(speed_up_html(curve)) + cell(common_html(curve)) + "</tr>\n";
}

std::string curve_table(const ReportData& data) {
    std::string html =
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" "
        "aria-label=\"Slopes and speed-ups\"><table>\n<thead><tr>";
    html += head("scene", "") + head("variant", "") + head("slope", "relMSE, spp");
    html += head("slope", "variance, spp") + head("slope", "relMSE, time") + head("at", "spp");
    html += head("relMSE", "dB") + head("psnr_float_db", "dB") + head("rate", "M samples/s");
    html += head("speed-up", "at that error") + head("measured speed-up", "where both are");
    html += "</tr></thead><tbody>\n";
    std::string scene;
    for (const ConvergenceCurve& curve : data.convergence) {
        html += curve_row(data, curve, curve.scene != scene);
        scene = curve.scene;
    }
    return html + "</tbody></table></div>\n";
}

template <class Member>
std::vector<std::string> different(const Curves& curves, Member member) {
    std::vector<std::string> values;
    for (const ConvergenceCurve& curve : curves) {
        if (std::ranges::find(values, curve.*member) == values.end())
            values.push_back(curve.*member);
    }
    return values;
}

/// Variants by scenes: how much sooner than the baseline.
std::string overview_table(const Curves& curves) {
    const auto scenes = different(curves, &ConvergenceCurve::scene);
    std::string html =
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Speed-ups by scene\">"
        "<table class=\"overview\">\n<thead><tr><th scope=\"col\">variant</th>";
    for (const std::string& scene : scenes) html += head(escaped(scene), "");
    html += "</tr></thead><tbody>\n";
    for (const std::string& variant : different(curves, &ConvergenceCurve::variant)) {
        html += "<tr><th scope=\"row\">" + escaped(variant) + "</th>";
        for (const std::string& scene : scenes) {
            const auto found = std::ranges::find_if(curves, [&](const ConvergenceCurve& c) {
                return c.scene == scene && c.variant == variant;
            });
            html += cell(found == curves.end() ? "–" : speed_up_html(*found));
        }
        html += "</tr>\n";
    }
    return html + "</tbody></table></div>\n";
}

std::string figure(const std::string& scene, const char* against, const char* text) {
    const std::string name = escaped(scene);
    return "<figure><figcaption>" + name + ", against " + text +
           "</figcaption><div class=\"plot\"><canvas role=\"img\" data-convergence=\"" + name +
           "\" data-against=\"" + against + "\" aria-label=\"Error of path tracing on " + name +
           " against " + text +
           "; slopes are in the table below.\"></canvas></div>"
           "<div class=\"legend lines\" role=\"group\" aria-label=\"Variants shown\"></div>"
           "</figure>\n";
}

constexpr const char* kSwitch =
    "<div class=\"switches js-only\"><div class=\"switch\" role=\"group\" aria-label=\"What is "
    "drawn\"><button type=\"button\" data-measure=\"error\" aria-pressed=\"true\">relMSE</button>"
    "<button type=\"button\" data-measure=\"variance\" aria-pressed=\"false\">variance over "
    "seeds</button></div></div>\n";

}  // namespace

std::string convergence_html(const ReportData& data) {
    if (data.convergence.empty()) return "";
    std::string html = "<section id=\"convergence\">\n<h2>Convergence</h2>\n<p class=\"note\">";
    html += std::string(kNote) +
            " <span class=\"js-only\">A click on a line's name hides or shows it.</span></p>\n";
    html += std::string(kSwitch) + "<div class=\"charts js-only\">\n";
    for (const std::string& scene : different(data.convergence, &ConvergenceCurve::scene)) {
        html += figure(scene, "spp", "samples per pixel");
        html += figure(scene, "time", "time");
    }
    html += "</div>\n<h3>Speed-up at equal error</h3>\n<p class=\"note\">";
    html += std::string(kSpeedUpNote) + "</p>\n" + overview_table(data.convergence);
    return html + "<h3>Slopes</h3>\n" + curve_table(data) + "</section>\n\n";
}

}  // namespace vecino
