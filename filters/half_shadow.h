// SPDX-License-Identifier: Apache-2.0
//
// Half-shadow where there is no time for more samples: a few first ones see the light or do not,
// and a mean over neighbours on the same surface is far less noisy than each.
#pragma once

#include "filters/pixel_needs.h"

namespace vecino {

/// Of needy pixels of rows that get no samples beyond pilot_spp and lie on one surface alone: what
/// is in sight of the light becomes a mean over a window, where pixels differ by noise; at a hard
/// edge they differ in order, and keep their own. Reads first samples alone.
void smooth_half_shadow(const RecordTracer& tracer, RowRange rows, const NeedyRows& needy,
                        int pilot_spp, PixelClusters& clusters);

}  // namespace vecino
