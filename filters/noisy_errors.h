// SPDX-License-Identifier: Apache-2.0
//
// How far images that are noisy themselves are from each other and from the truth.
#pragma once

#include "core/grid.h"

namespace vecino {

/// A mean over pixels and how far it may be off. Pixels that are not finite count as 0.
struct MeanError {
    double mean = 0;
    double standard_error = 0;
};

/// Mean squared difference of sRGB values.
MeanError squared_difference(const Image& a, const Image& b);

/// Mean squared error in sRGB of an image against the truth that two independent, unbiased images
/// are noisy forms of: the product of both differences has no noise in its mean. Where the image
/// is too bright to be shown it counts as 0.
MeanError error_against(const Image& image, const Image& a, const Image& b);

}  // namespace vecino
