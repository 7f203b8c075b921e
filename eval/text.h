// SPDX-License-Identifier: Apache-2.0
//
// Text in pictures: OpenCV's stroke font, drawn large and reduced, because at its own size it is
// too coarse to read well. ASCII only.
#pragma once

#include <cstddef>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/grid.h"

namespace vecino {

struct TextStyle {
    double cap_height_px = 10;
    glm::u8vec3 colour{0, 0, 0};
    bool bold = false;
};

[[nodiscard]] int text_width(const std::string& text, const TextStyle& style);

/// The origin is the left end of the baseline. What leaves the picture is cut.
void draw_text(Grid<glm::u8vec3>& picture, const std::string& text, glm::ivec2 origin,
               const TextStyle& style);

struct TextBox {
    int width_px;
    std::size_t max_lines;
};

/// Breaks text into lines that fit, at spaces or after punctuation where it can. What does not fit
/// ends in "...".
std::vector<std::string> wrap_text(const std::string& text, const TextBox& box,
                                   const TextStyle& style);

}  // namespace vecino
