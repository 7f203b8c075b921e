// SPDX-License-Identifier: Apache-2.0
//
// From what pixels show and from records to the values of pixels.
#pragma once

#include <vector>

#include "core/accumulate.h"
#include "core/frame.h"
#include "filters/pixel_clusters.h"
#include "filters/records.h"

namespace vecino {

/// Light of a cluster that no record stands for: of a surface that the first samples missed.
struct Orphan {
    int x, cluster;
    RecordValue light;
};

/// What paths made of a pixel: of one with more surfaces than there are clusters, or with contacts
/// that records miss.
struct TracedPixel {
    int x;
    PixelValues values;
};

/// What goes beyond clusters and records in a row.
struct RowExceptions {
    std::vector<Orphan> orphans;
    std::vector<TracedPixel> traced;
};

struct ResolveInputs {
    const TraceTask& task;
    const PixelClusters& clusters;
    const RecordMap& records;  ///< of no level: there is no light but that straight from emitters
};

/// Fills in the pixels of a row. Returns pixels that are not finite.
std::uint64_t resolve_row(const ResolveInputs& inputs, int y, const RowExceptions& exceptions,
                          Frame& frame);

}  // namespace vecino
