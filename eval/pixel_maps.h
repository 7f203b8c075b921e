// SPDX-License-Identifier: Apache-2.0
//
// What a pair of images says per pixel, for files that hold more than a picture of the error.
#pragma once

#include <span>
#include <string_view>

#include "core/grid.h"

namespace vecino {

/// A map of one value per pixel. Where it needs a value that is not finite, or a window that leaves
/// the image, it is NaN.
struct PixelMap {
    std::string_view name;
    std::string_view definition;  ///< one line; x is the test image, r the reference
    Grid<float> (*values)(const Image& test, const Image& reference);  ///< of equal sizes
};

/// All maps; the first is the one to look at first.
std::span<const PixelMap> all_pixel_maps();

}  // namespace vecino
