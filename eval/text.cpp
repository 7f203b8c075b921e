// SPDX-License-Identifier: Apache-2.0
#include "eval/text.h"

#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace vecino {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
constexpr int kOversampling = 4;
constexpr double kCapHeightAtScale1 = 21.0;
constexpr double kStrokePerCapHeight = 0.115;
constexpr double kBoldStrokePerCapHeight = 0.16;

/// The font's parameters for text drawn kOversampling times too large.
struct LargeFont {
    explicit LargeFont(const TextStyle& style)
        : scale(style.cap_height_px * kOversampling / kCapHeightAtScale1),
          stroke(
              std::max(1, cvRound(style.cap_height_px * kOversampling *
                                  (style.bold ? kBoldStrokePerCapHeight : kStrokePerCapHeight)))) {}
    double scale;
    int stroke;
};

cv::Size large_size(const std::string& text, const LargeFont& font, int* descent) {
    return cv::getTextSize(text, kFont, font.scale, font.stroke, descent);
}

/// How much of each pixel the text covers, 0..255. The baseline starts `padding` from the left and
/// from the foot.
cv::Mat coverage(const std::string& text, const LargeFont& font, int padding) {
    int descent = 0;
    const cv::Size size = large_size(text, font, &descent);
    const cv::Size pixels(size.width / kOversampling + 2 * padding + 1,
                          size.height / kOversampling + 2 * padding + 1);
    cv::Mat large(pixels * kOversampling, CV_8U, cv::Scalar(0));
    const cv::Point origin(padding * kOversampling, large.rows - padding * kOversampling);
    cv::putText(large, text, origin, kFont, font.scale, 255, font.stroke, cv::LINE_AA);
    cv::Mat covered;
    cv::resize(large, covered, pixels, 0, 0, cv::INTER_AREA);
    return covered;
}

void blend(glm::u8vec3& pixel, glm::u8vec3 colour, int covered) {
    for (int c = 0; c < 3; ++c) {
        const int mixed = (pixel[c] * (255 - covered) + colour[c] * covered + 127) / 255;
        pixel[c] = static_cast<std::uint8_t>(mixed);
    }
}

/// The longest prefix that fits, at least one character.
std::size_t fitting_length(const std::string& text, int width_px, const TextStyle& style) {
    std::size_t length = 1;
    while (length < text.size() && text_width(text.substr(0, length + 1), style) <= width_px)
        ++length;
    return length;
}

/// Where to break a line of at most `limit` characters: after a space or punctuation if it can.
std::size_t break_position(const std::string& text, std::size_t limit) {
    const std::size_t place = text.find_last_of(" ._-,;:/", limit - 1);
    return place == std::string::npos || place == 0 ? limit : place + 1;
}

std::string shortened(const std::string& text, int width_px, const TextStyle& style) {
    if (text_width(text, style) <= width_px) return text;
    const std::string dots = "...";
    return text.substr(0, fitting_length(text, width_px - text_width(dots, style), style)) + dots;
}

std::string trimmed(const std::string& text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    if (first == std::string::npos) return "";
    return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

}  // namespace

int text_width(const std::string& text, const TextStyle& style) {
    int descent = 0;
    return (large_size(text, LargeFont(style), &descent).width + kOversampling - 1) / kOversampling;
}

void draw_text(Grid<glm::u8vec3>& picture, const std::string& text, glm::ivec2 origin,
               const TextStyle& style) {
    const int padding = cvCeil(style.cap_height_px);
    const cv::Mat covered = coverage(text, LargeFont(style), padding);
    const cv::Rect place({origin.x - padding, origin.y + padding - covered.rows}, covered.size());
    const cv::Rect visible = place & cv::Rect(0, 0, picture.size().width, picture.size().height);
    for (int y = visible.y; y < visible.br().y; ++y) {
        for (int x = visible.x; x < visible.br().x; ++x)
            blend(picture(x, y), style.colour, covered.at<uchar>(y - place.y, x - place.x));
    }
}

std::vector<std::string> wrap_text(const std::string& text, const TextBox& box,
                                   const TextStyle& style) {
    std::vector<std::string> lines;
    std::string rest = trimmed(text);
    while (!rest.empty() && lines.size() + 1 < box.max_lines) {
        const std::size_t fits = fitting_length(rest, box.width_px, style);
        const std::size_t length = fits == rest.size() ? fits : break_position(rest, fits);
        lines.push_back(trimmed(rest.substr(0, length)));
        rest = trimmed(rest.substr(length));
    }
    if (!rest.empty()) lines.push_back(shortened(rest, box.width_px, style));
    return lines;
}

}  // namespace vecino
