// SPDX-License-Identifier: Apache-2.0
//
// Weighted averages over windows of a low-res frame: what four of the five schemes do. Here stand
// the border rule (windows are clipped to the image) and the fallback rule (no sound weights: the
// pixel's own colour).
#pragma once

#include <cmath>

#include "filters/schemes.h"
#include "filters/window_row.h"

namespace vecino {

struct WindowKind {
    WindowDistance distance;
    WindowWeight weight;
};

/// The average for every low-res pixel. Of the parameters it reads window, use_centre and
/// min_normal_cosine.
Reconstruction average_windows(const Frame& low, WindowKind kind,
                               const SchemeParameters& parameters, int threads);

}  // namespace vecino
