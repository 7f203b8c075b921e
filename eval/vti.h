// SPDX-License-Identifier: Apache-2.0
//
// Images as VTK reads them: XML ImageData (.vti) with any number of float arrays, one value per
// pixel and component. Points of the grid are pixel centres, one unit apart; the bottom row of the
// image is y = 0, as VTK has it. Data are appended raw, in this machine's byte order, so that NaN
// and infinities keep their bits.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid.h"

namespace vecino {

struct VtiArray {
    std::string name;
    std::string unit;        ///< UNITS_LABEL of the array; empty: none
    std::string definition;  ///< one line, kept in the file's field array "definitions"
    std::vector<std::string_view> components;  ///< their names; a single one needs none
    /// Of a pixel, counted row by row from the top.
    std::function<float(std::size_t pixel, std::size_t component)> value;

    [[nodiscard]] std::size_t component_count() const {
        return components.empty() ? 1 : components.size();
    }
};

/// A number that is about the whole image.
struct VtiNumber {
    std::string name;
    double value;  ///< finite
};

struct VtiImage {
    Extent size;
    std::vector<VtiArray> arrays;
    std::vector<VtiNumber> numbers;
    std::string shown;  ///< the array that a viewer shows first
};

/// Writes the file whole or not at all. Throws Error(file), Error(mismatch) if there are no pixels.
void save_vti(const VtiImage& image, const std::string& path);

}  // namespace vecino
