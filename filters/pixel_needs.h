// SPDX-License-Identifier: Apache-2.0
//
// Which pixels want more samples than the first ones, and how many: those at edges of surfaces and
// of albedo, and those in half-shadow, in proportion to the error that is expected of them.
#pragma once

#include <cstdint>
#include <vector>

#include "filters/pixel_clusters.h"
#include "filters/pixel_looks.h"
#include "filters/records.h"

namespace vecino {

struct NeedyPixel {
    int x;
    std::uint8_t needs;         ///< of Need
    std::uint32_t samples = 0;  ///< all told, the first ones included
};

/// The needy pixels of rows, in order; row y of the image is number y - begin.
using NeedyRows = std::vector<std::vector<NeedyPixel>>;

/// What decides.
struct NeedInputs {
    const RecordTracer& tracer;
    const PixelClusters& clusters;
    const RecordMap& records;
    const SurfaceRecordsPlan& plan;
};

/// Of rows of the clusters; their neighbours are looked at where there are any.
NeedyRows find_needy_pixels(const NeedInputs& inputs, RowRange rows);

}  // namespace vecino
