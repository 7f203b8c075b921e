// SPDX-License-Identifier: Apache-2.0
//
// Half-shadow where there is no time for more samples: a few first ones see the light or do not,
// and a mean over neighbours on the same surface is far less noisy than each.
#pragma once

#include "filters/pixel_needs.h"

namespace vecino {

/// What samples there are of needy pixels.
struct GivenSamples {
    RowRange rows;
    const NeedyRows& needy;  ///< of these
    int pilot_spp;           ///< what they have that get no others
};

/// Of needy pixels that get no further samples and lie on one surface alone: what is in sight of
/// the light becomes a mean over a window, where pixels differ by noise; at a hard edge they differ
/// in order, and keep their own. Reads first samples alone.
void smooth_half_shadow(const RecordTracer& tracer, const GivenSamples& given,
                        PixelClusters& clusters);

}  // namespace vecino
