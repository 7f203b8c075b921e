// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/error.h"
#include "eval/report_raster.h"
#include "eval/text.h"

namespace vecino {
namespace {

// Twice the size at which it is read, for screens that have as many pixels.
constexpr int kScale = 2;
constexpr int kPlotWidth = 330 * kScale;
constexpr int kPlotHeight = 300 * kScale;
constexpr int kLeft = 50 * kScale;
constexpr int kTop = 30 * kScale;
constexpr int kFoot = 44 * kScale;
constexpr int kLegendLine = 18 * kScale;
constexpr int kMarker = 5 * kScale;
constexpr glm::u8vec3 kInk{26, 29, 33};
constexpr glm::u8vec3 kSoftInk{90, 99, 112};
constexpr glm::u8vec3 kPaper{255, 255, 255};
const cv::Scalar kRule(223, 227, 232);
// --c0 to --c8 of report.css on white.
constexpr glm::u8vec3 kColours[] = {{26, 29, 33},  {11, 107, 176}, {185, 120, 0},
                                    {0, 134, 106}, {168, 67, 138}, {207, 69, 0},
                                    {91, 75, 181}, {111, 106, 28}, {63, 125, 149}};

struct Point {
    double time_s, psnr_db;
    const MethodStyle* style;
    std::string curve;  ///< points with the same one are joined, by growing time; may be empty
    std::string label;  ///< of the curve
};

struct Axes {
    double least_time, most_time, least_db, most_db, step_db;

    [[nodiscard]] cv::Point at(double time_s, double psnr_db, cv::Point corner) const {
        const double x = std::log(time_s / least_time) / std::log(most_time / least_time);
        const double y = (most_db - psnr_db) / (most_db - least_db);
        return {corner.x + cvRound(x * kPlotWidth), corner.y + cvRound(y * kPlotHeight)};
    }
};

cv::Scalar scalar(glm::u8vec3 colour) {
    return {double(colour.r), double(colour.g), double(colour.b)};
}

cv::Mat view(Grid<glm::u8vec3>& raster) {
    return {raster.size().height, raster.size().width, CV_8UC3, raster.values().data()};
}

TextStyle text_style(glm::u8vec3 colour, bool bold = false) {
    return {8.0 * kScale, colour, bold};
}

bool is_shown(const ReportData& data, const GroupSummary& group) {
    if (!group.psnr_float_db || !(group.work_s() > 0)) return false;
    const auto variants = variants_of(data, group);
    const bool in_first = std::ranges::find(variants, std::size_t{0}) != variants.end();
    return !data.reproduction || in_first || group.method == "path";
}

/// Samplers, where path tracing has several; it is told apart by how it finds light anyhow.
bool samplers_vary(const ReportData& data) {
    std::set<std::string> samplers;
    for (const GroupSummary& group : data.groups) {
        if (group.method == "path") samplers.insert(group.params.value("sampler", ""));
    }
    return samplers.size() > 1;
}

/// What is joined: results that differ in the work that they were given alone. Schemes, of which
/// there are many at one spp, are not.
std::string curve_of(const GroupSummary& group) {
    const bool is_scheme =
        group.params.contains("window") || group.params.value("reduction", 1) > 1;
    if (is_scheme) return "";
    nlohmann::json params = group.params;
    for (const char* key : {"spp", "spp_asked", "seed", "budget", "time_budget"}) params.erase(key);
    return group.method + params.dump();
}

std::map<std::string, std::vector<Point>> points_by_scene(const ReportData& data) {
    const bool names_sampler = samplers_vary(data);
    std::map<std::string, std::vector<Point>> points;
    for (const GroupSummary& group : data.groups) {
        if (!is_shown(data, group)) continue;
        std::string label;
        if (group.method == "path") {
            label = group.params.value("light_sampling", "");
            if (names_sampler) label += ", " + group.params.value("sampler", "");
        }
        points[group.scene].push_back({group.work_s(), group.psnr_float_db->mean,
                                       &data.style_of(group.method), curve_of(group), label});
    }
    return points;
}

/// One of full resolution bounds nothing.
bool is_ceiling(const GroupSummary& group) {
    return group.method == "blocky_ceiling" && group.psnr_float_db &&
           group.params.value("reduction", 1) > 1;
}

Axes axes_of(const ReportData& data, const std::map<std::string, std::vector<Point>>& scenes) {
    std::vector<double> times, levels;
    for (const GroupSummary& group : data.groups) {
        if (is_ceiling(group)) levels.push_back(group.psnr_float_db->mean);
    }
    for (const auto& [scene, points] : scenes) {
        for (const Point& point : points) {
            times.push_back(point.time_s);
            levels.push_back(point.psnr_db);
        }
    }
    const auto [fastest, slowest] = std::ranges::minmax(times);
    const auto [worst, best] = std::ranges::minmax(levels);
    const double span = std::max(1.0, best - worst);
    const double step = span > 20 ? 5 : span > 8 ? 2 : 1;
    return {fastest / 1.5, slowest * 1.5, step * std::floor(worst / step - 0.2),
            step * std::ceil(best / step + 0.2), step};
}

void draw_grid(Grid<glm::u8vec3>& picture, const Axes& axes, cv::Point corner) {
    for (double db = axes.least_db; db <= axes.most_db + 1e-9; db += axes.step_db) {
        const int y = axes.at(axes.least_time, db, corner).y;
        cv::line(view(picture), {corner.x, y}, {corner.x + kPlotWidth, y}, kRule, kScale / 2);
        const std::string label = std::to_string(cvRound(db));
        draw_text(picture, label,
                  {corner.x - 7 * kScale - text_width(label, text_style(kSoftInk)), y + 4 * kScale},
                  text_style(kSoftInk));
    }
    for (int e = static_cast<int>(std::ceil(std::log10(axes.least_time)));
         std::pow(10.0, e) <= axes.most_time; ++e) {
        const int x = axes.at(std::pow(10.0, e), axes.most_db, corner).x;
        cv::line(view(picture), {x, corner.y}, {x, corner.y + kPlotHeight}, kRule, kScale / 2);
        char label[32];
        std::snprintf(label, sizeof label, "%g s", std::pow(10.0, e));
        draw_text(
            picture, label,
            {x - text_width(label, text_style(kSoftInk)) / 2, corner.y + kPlotHeight + 17 * kScale},
            text_style(kSoftInk));
    }
}

/// A method's symbol, as in the report as far as OpenCV has it.
void draw_marker(Grid<glm::u8vec3>& picture, const MethodStyle& style, cv::Point at) {
    const cv::Scalar colour = scalar(kColours[static_cast<std::size_t>(style.colour)]);
    const cv::Mat mat = view(picture);
    const auto polygon = [&](std::vector<cv::Point> corners) {
        for (cv::Point& each : corners) each = at + each * kMarker / 2;
        cv::fillConvexPoly(mat, corners, colour, cv::LINE_AA);
    };
    if (style.shape == "rect") return polygon({{-2, -2}, {2, -2}, {2, 2}, {-2, 2}});
    if (style.shape == "rectRot") return polygon({{0, -3}, {3, 0}, {0, 3}, {-3, 0}});
    if (style.shape == "triangle") return polygon({{0, -3}, {3, 2}, {-3, 2}});
    if (style.shape == "triangleDown") return polygon({{0, 3}, {3, -2}, {-3, -2}});
    if (style.shape == "circle") {
        cv::circle(mat, at, kMarker, colour, cv::FILLED, cv::LINE_AA);
        return;
    }
    const int kind = style.shape == "crossRot" ? cv::MARKER_TILTED_CROSS
                     : style.shape == "star"   ? cv::MARKER_STAR
                                               : cv::MARKER_CROSS;
    cv::drawMarker(mat, at, colour, kind, 5 * kMarker / 2, 2 * kScale, cv::LINE_AA);
}

void draw_curves(Grid<glm::u8vec3>& picture, std::vector<Point> points, const Axes& axes,
                 cv::Point corner) {
    std::ranges::sort(points, {}, &Point::time_s);
    std::map<std::string, const Point*> last;
    const auto place = [&](const Point& p) { return axes.at(p.time_s, p.psnr_db, corner); };
    for (const Point& point : points) {
        if (point.curve.empty()) continue;
        const glm::u8vec3 colour = point.style->colour == 0
                                       ? kSoftInk
                                       : kColours[static_cast<std::size_t>(point.style->colour)];
        if (const auto before = last.find(point.curve); before != last.end()) {
            cv::line(view(picture), place(*before->second), place(point), scalar(colour), kScale,
                     cv::LINE_AA);
        }
        last[point.curve] = &point;
    }
    // Below the last point and beyond it: what is slower and better than all others is not there.
    for (const auto& [name, point] : last) {
        const cv::Point at = place(*point);
        const int most_x = corner.x + kPlotWidth - text_width(point->label, text_style(kSoftInk));
        draw_text(picture, point->label, {std::min(at.x + 7 * kScale, most_x), at.y + 14 * kScale},
                  text_style(kSoftInk));
    }
}

/// Below a level that no scheme with one value per low-resolution pixel can pass.
void draw_ceilings(Grid<glm::u8vec3>& picture, const ReportData& data, const std::string& scene,
                   const std::pair<Axes, cv::Point>& place) {
    const auto& [axes, corner] = place;
    for (const GroupSummary& group : data.groups) {
        if (!is_ceiling(group) || group.scene != scene) continue;
        const double db = group.psnr_float_db->mean;
        if (db > axes.most_db || db < axes.least_db) continue;
        const int y = axes.at(axes.least_time, db, corner).y;
        for (int x = 0; x < kPlotWidth; x += 10 * kScale)
            cv::line(view(picture), {corner.x + x, y}, {corner.x + x + 5 * kScale, y},
                     scalar(kSoftInk), kScale);
        draw_text(picture, "blocky ceiling " + parameter_text(group.params, "reduction"),
                  {corner.x + 4 * kScale, y - 4 * kScale}, text_style(kSoftInk));
    }
}

void draw_legend(Grid<glm::u8vec3>& picture, const ReportData& data, int top) {
    int x = kLeft;
    for (const MethodStyle& style : data.methods) {
        const bool is_drawn = std::ranges::find(data.groups, style.method, &GroupSummary::method) !=
                              data.groups.end();
        if (style.method == "blocky_ceiling" || !is_drawn) continue;
        draw_marker(picture, style, {x, top - 4 * kScale});
        draw_text(picture, style.method, {x + 10 * kScale, top}, text_style(kInk));
        x += 10 * kScale + text_width(style.method, text_style(kInk)) + 22 * kScale;
    }
}

/// Charts side by side: up to three, or four in two rows, and so on.
int columns_of(std::size_t charts) {
    const auto count = static_cast<int>(charts);
    return count <= 3 ? count : static_cast<int>(std::ceil(std::sqrt(count)));
}

}  // namespace

Grid<glm::u8vec3> chart_raster(const ReportData& data) {
    const auto scenes = points_by_scene(data);
    if (scenes.empty())
        throw Error(ExitCode::file, data.directory + ": holds no result to draw a chart of");
    const Axes axes = axes_of(data, scenes);
    const int columns = columns_of(scenes.size());
    const int rows = (static_cast<int>(scenes.size()) + columns - 1) / columns;
    const cv::Point step(kLeft + kPlotWidth, kTop + kPlotHeight + kFoot);
    Grid<glm::u8vec3> picture({columns * step.x + 20 * kScale, rows * step.y + kLegendLine},
                              kPaper);
    int number = 0;
    for (const auto& [scene, points] : scenes) {
        const cv::Point corner(kLeft + number % columns * step.x, kTop + number / columns * step.y);
        ++number;
        draw_text(picture, scene + ": psnr_float_db against time",
                  {corner.x, corner.y - 12 * kScale}, text_style(kInk, true));
        draw_grid(picture, axes, corner);
        draw_ceilings(picture, data, scene, {axes, corner});
        draw_curves(picture, points, axes, corner);
        for (const Point& point : points)
            draw_marker(picture, *point.style, axes.at(point.time_s, point.psnr_db, corner));
    }
    draw_legend(picture, data, rows * step.y);
    return picture;
}

}  // namespace vecino
