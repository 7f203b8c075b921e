// SPDX-License-Identifier: Apache-2.0
//
// What metrics and error maps must agree on: which pairs of images can be compared, which pixels
// count as finite, what a display value is, and which value is the 99th percentile.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/color.h"
#include "core/error.h"
#include "core/grid.h"

namespace vecino {

/// Throws Error(mismatch) unless both images have the same size, with at least one pixel.
inline void require_comparable(const Image& test, const Image& reference) {
    if (test.size() == reference.size() && !test.empty()) return;
    throw Error(ExitCode::mismatch, "test image is " + size_text(test.size()) + ", reference is " +
                                        size_text(reference.size()) +
                                        ": sizes must be equal and not empty");
}

/// What a screen is sent: clipped to [0,1], sRGB-encoded, not quantised.
inline glm::vec3 display_value(glm::vec3 linear) {
    return {srgb_encode(linear.x), srgb_encode(linear.y), srgb_encode(linear.z)};
}

/// Nearest rank: the ceil(0.99 n)-th smallest. Precondition: not empty, no NaN.
template <class T>
T percentile_99(std::vector<T> values) {
    const std::size_t rank = (99 * values.size() + 99) / 100;  // integers: no double is 0.99
    const auto place = values.begin() + static_cast<std::ptrdiff_t>(rank - 1);
    std::nth_element(values.begin(), place, values.end());
    return *place;
}

}  // namespace vecino
