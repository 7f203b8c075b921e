// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "eval/colour_map.h"
#include "eval/error_map.h"
#include "eval/pixel_values.h"
#include "eval/text.h"

namespace vecino {
namespace {

constexpr int kLeastMapSide = 384;      // the longer side, after enlarging
constexpr double kLegendMapSide = 768;  // a map beyond this gets a legend that grows with it
constexpr int kTicks = 5;
constexpr glm::u8vec3 kInk{34, 34, 34};
constexpr glm::u8vec3 kSoftInk{96, 96, 96};
constexpr glm::u8vec3 kPaper{255, 255, 255};
const cv::Scalar kLine(128, 128, 128);

cv::Scalar scalar(glm::u8vec3 colour) {
    return {double(colour.r), double(colour.g), double(colour.b)};
}

/// Our memory under a cv::Mat header; channels stay in RGB order.
cv::Mat view(Grid<glm::u8vec3>& raster) {
    static_assert(sizeof(glm::u8vec3) == 3);
    return {raster.size().height, raster.size().width, CV_8UC3, raster.values().data()};
}

struct Counts {
    std::size_t finite = 0, beyond = 0, non_finite = 0;
};

Counts count_pixels(const Grid<float>& values, float range) {
    Counts counts;
    for (const float value : values.values()) {
        const bool finite = std::isfinite(value);
        (finite ? counts.finite : counts.non_finite) += 1;
        if (finite && std::abs(value) > range) ++counts.beyond;
    }
    return counts;
}

std::string formatted(const char* format, double value, int decimals) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), format, decimals, value);
    return text.data();
}

std::string share_beyond(const Counts& counts) {
    if (counts.finite == 0) return "no finite pixel";
    const double percent = 100.0 * double(counts.beyond) / double(counts.finite);
    if (counts.beyond == 0) return "0 % beyond range";
    if (percent < 0.01) return "< 0.01 % beyond range";
    return formatted("%.*f %% beyond range", percent, 2);
}

/// As many decimals as the step needs, at most three digits of it.
int tick_decimals(double step) {
    const int most = std::clamp(2 - static_cast<int>(std::floor(std::log10(step))), 0, 9);
    for (int decimals = 0; decimals < most; ++decimals) {
        const double scaled = step * std::pow(10.0, decimals);
        if (std::abs(scaled - std::round(scaled)) < 1e-4 * scaled) return decimals;
    }
    return most;
}

/// From the top of the bar to its foot.
std::vector<std::string> tick_labels(const ErrorPictureStyle& style) {
    const bool is_signed = style.kind == ErrorKind::sign;
    const double range = double(style.range);
    const double step = (is_signed ? 2 * range : range) / (kTicks - 1);
    const char* format = is_signed ? "%+.*f" : "%.*f";
    std::vector<std::string> labels;
    for (int i = 0; i < kTicks; ++i) {
        const double value = range - i * step;
        const bool is_zero = std::abs(value) < step / 2;
        labels.push_back(is_zero ? "0" : formatted(format, value, tick_decimals(step)));
    }
    return labels;
}

/// Where everything stands, in pixels of the picture.
struct Layout {
    double unit = 1;  ///< one pixel of a legend of normal size
    int map_scale = 1;
    std::vector<std::string> title;
    std::vector<std::string> ticks;
    cv::Rect map, bar;
    int title_baseline = 0, notes_baseline = 0;
    cv::Size picture;

    [[nodiscard]] int px(double length) const { return cvRound(length * unit); }
    [[nodiscard]] int margin() const { return px(24); }
    [[nodiscard]] int note_line() const { return px(19); }
    [[nodiscard]] int title_line() const { return px(22); }
    [[nodiscard]] TextStyle title_text() const { return {12.0 * unit, kInk, true}; }
    [[nodiscard]] TextStyle tick_text() const { return {9.0 * unit, kInk, false}; }
    [[nodiscard]] TextStyle note_text() const { return {9.0 * unit, kSoftInk, false}; }
};

int widest(const std::vector<std::string>& lines, const TextStyle& style) {
    int width = 0;
    for (const std::string& line : lines) width = std::max(width, text_width(line, style));
    return width;
}

void place_columns(Layout& layout, const Extent& map_size) {
    layout.map = {layout.margin(), 0, map_size.width * layout.map_scale,
                  map_size.height * layout.map_scale};
    layout.bar = {layout.map.br().x + layout.px(18), 0, layout.px(16), 0};
    // Room for the usual labels at least, so that pictures of both kinds have the same width.
    const int labels =
        layout.px(11) + std::max(widest(layout.ticks, layout.tick_text()), layout.px(56));
    const int content = std::max(layout.bar.br().x + labels - layout.margin(), layout.px(360));
    layout.picture.width = content + 2 * layout.margin();
}

void place_rows(Layout& layout, int note_count) {
    const int body = std::max(layout.map.height, layout.px(130));
    const int title_lines = static_cast<int>(layout.title.size());
    layout.title_baseline = layout.margin() + layout.px(12);
    const int top =
        layout.margin() + (title_lines > 0 ? title_lines * layout.title_line() + layout.px(6) : 0);
    layout.map.y = top + (body - layout.map.height) / 2;
    layout.bar.y = top;
    layout.bar.height = body;
    layout.notes_baseline = top + body + layout.px(28);
    layout.picture.height =
        layout.notes_baseline + (note_count - 1) * layout.note_line() + layout.margin();
}

Layout make_layout(const Extent& map_size, const ErrorPictureStyle& style, int note_count) {
    Layout layout;
    const int longer = std::max(map_size.width, map_size.height);
    layout.map_scale = (std::max(kLeastMapSide, longer) + longer - 1) / longer;
    layout.unit = std::max(1.0, layout.map_scale * longer / kLegendMapSide);
    layout.ticks = tick_labels(style);
    place_columns(layout, map_size);
    const int width = layout.picture.width - 2 * layout.margin();
    layout.title = wrap_text(style.title, {width, 3}, layout.title_text());
    place_rows(layout, note_count);
    return layout;
}

/// A line around a rectangle, outside of it: no value is covered.
void frame(Grid<glm::u8vec3>& picture, const cv::Rect& inside) {
    cv::rectangle(view(picture),
                  cv::Rect(inside.x - 1, inside.y - 1, inside.width + 2, inside.height + 2), kLine);
}

void draw_map(Grid<glm::u8vec3>& picture, Grid<glm::u8vec3> colours, const cv::Rect& place) {
    cv::resize(view(colours), view(picture)(place), place.size(), 0, 0, cv::INTER_NEAREST);
    frame(picture, place);
}

/// The bar is a map of its own, of values from the end of the range to its start, so that it cannot
/// disagree with the map.
void draw_bar(Grid<glm::u8vec3>& picture, const Layout& layout, const ErrorPictureStyle& style) {
    const cv::Rect& bar = layout.bar;
    const float bottom = style.kind == ErrorKind::sign ? -style.range : 0.0f;
    Grid<float> ramp({1, bar.height});
    for (int y = 0; y < bar.height; ++y) {
        const float t = static_cast<float>(y) / static_cast<float>(bar.height - 1);
        ramp(0, y) = style.range * (1 - t) + bottom * t;
    }
    draw_map(picture, error_colours(ramp, style), bar);
    for (int i = 0; i < kTicks; ++i) {
        const int y = bar.y + cvRound(double(i) * (bar.height - 1) / (kTicks - 1));
        cv::line(view(picture), {bar.br().x, y}, {bar.br().x + layout.px(5), y}, kLine,
                 layout.px(1));
        draw_text(picture, layout.ticks[static_cast<std::size_t>(i)],
                  {bar.br().x + layout.px(11), y + layout.px(4.5)}, layout.tick_text());
    }
}

void draw_title(Grid<glm::u8vec3>& picture, const Layout& layout) {
    glm::ivec2 origin(layout.margin(), layout.title_baseline);
    for (const std::string& line : layout.title) {
        draw_text(picture, line, origin, layout.title_text());
        origin.y += layout.title_line();
    }
}

std::vector<std::string> notes(const ErrorPictureStyle& style, const Counts& counts) {
    const std::string quantity = style.kind == ErrorKind::sign ? "test - reference" : "RMS error";
    std::vector<std::string> lines{quantity + ", display value (sRGB), 0..1", share_beyond(counts)};
    if (counts.non_finite > 0) lines.push_back("non-finite: " + std::to_string(counts.non_finite));
    return lines;
}

/// The last note gets a swatch when it is about non-finite pixels.
void draw_notes(Grid<glm::u8vec3>& picture, const Layout& layout,
                const std::vector<std::string>& lines, bool with_swatch) {
    glm::ivec2 origin(layout.margin(), layout.notes_baseline);
    for (const std::string& line : lines) {
        if (with_swatch && &line == &lines.back()) {
            const int side = layout.px(10);
            const cv::Rect swatch(origin.x + 1, origin.y - side + 1, side, side);
            cv::rectangle(view(picture), swatch, scalar(kNonFiniteColour), cv::FILLED);
            frame(picture, swatch);
            origin.x += side + layout.px(8);
        }
        draw_text(picture, line, origin, layout.note_text());
        origin.y += layout.note_line();
    }
}

}  // namespace

Grid<glm::u8vec3> error_picture(const Grid<float>& values, const ErrorPictureStyle& style) {
    if (values.empty()) throw Error(ExitCode::mismatch, "error map: there are no pixels to draw");
    Grid<glm::u8vec3> colours = error_colours(values, style);
    const Counts counts = count_pixels(values, style.range);
    const std::vector<std::string> lines = notes(style, counts);
    const Layout layout = make_layout(values.size(), style, static_cast<int>(lines.size()));

    Grid<glm::u8vec3> picture({layout.picture.width, layout.picture.height}, kPaper);
    draw_title(picture, layout);
    draw_map(picture, std::move(colours), layout.map);
    draw_bar(picture, layout, style);
    draw_notes(picture, layout, lines, counts.non_finite > 0);
    return picture;
}

}  // namespace vecino
