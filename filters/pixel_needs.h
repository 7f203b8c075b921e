// SPDX-License-Identifier: Apache-2.0
//
// Which pixels want more samples than the first ones: those at edges of surfaces and of albedo, and
// those in half-shadow.
#pragma once

#include <cstdint>
#include <vector>

#include "filters/pixel_clusters.h"
#include "filters/pixel_looks.h"

namespace vecino {

struct NeedyPixel {
    int x;
    std::uint8_t needs;         ///< of Need
    std::uint32_t samples = 0;  ///< all told, the first ones included
};

/// The needy pixels of rows, in order; row y of the image is number y - begin.
using NeedyRows = std::vector<std::vector<NeedyPixel>>;

/// So far around rows find_needs() looks.
constexpr int kNeedsReach = 17;

/// Of rows of the clusters; their neighbours are looked at where there are any. pilot_spp: in a
/// wide half-shadow a few first samples often agree by chance, and those of a pixel's neighbours
/// with them. So the fewer there are, the farther around those that are known to lie in one; and
/// farther around wide ones in any case, as these fade out slowly.
NeedyRows find_needs(const RecordTracer& tracer, const PixelClusters& clusters, RowRange rows,
                     int pilot_spp);

}  // namespace vecino
