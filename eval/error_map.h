// SPDX-License-Identifier: Apache-2.0
//
// Pictures of where the error is. Both kinds work on display values (clipped to [0,1],
// sRGB-encoded), so that the mean of magnitude^2 is exactly the mean squared error behind
// psnr_float_db.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "core/grid.h"

namespace vecino {

enum class ErrorKind {
    magnitude,  ///< sqrt(mean over channels of (x - r)^2), shown on a perceptually uniform map from
                ///< 0
    sign,       ///< mean over channels of (x - r), shown on a diverging map around 0
};

/// Per-pixel error; NaN where either image is not finite. Throws Error(mismatch) when the sizes
/// differ.
Grid<float> error_values(const Image& test, const Image& reference, ErrorKind kind);

/// What error_values compares: clipped to [0,1] and sRGB-encoded; a pixel that is not finite stays
/// so. For who draws several maps of one image.
Image display_image(const Image& linear);

/// error_values of two display images.
Grid<float> display_error_values(const Image& test, const Image& reference, ErrorKind kind);

/// The least "round" number (1, 2, 5 times a power of ten) that is not below the 99th percentile of
/// |values|, over finite values; at least 0.001.
float suggested_range(const Grid<float>& values);

/// The range that several maps share: the (upper) median of their suggested ones, so that one
/// method that fails does not turn all other maps black. What lies beyond has the colour of the
/// end. Precondition: not empty.
float shared_range(std::vector<float> suggested);

struct ErrorPictureStyle {
    ErrorKind kind = ErrorKind::magnitude;
    float range = 0.1f;  ///< the bar goes 0..range (magnitude) or -range..range (sign)
    std::string title;   ///< above the map; may be empty
};

/// The map with a colour bar, tick values, the share of pixels beyond the range and a swatch for
/// non-finite pixels.
Grid<glm::u8vec3> error_picture(const Grid<float>& values, const ErrorPictureStyle& style);

/// The map alone, one pixel per value, coloured as error_picture does.
Grid<glm::u8vec3> error_colours(const Grid<float>& values, const ErrorPictureStyle& style);

}  // namespace vecino
