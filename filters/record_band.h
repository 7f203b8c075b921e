// SPDX-License-Identifier: Apache-2.0
//
// One band of rows of a frame by surface records, from first samples to pixels.
#pragma once

#include <functional>

#include "filters/pace.h"
#include "filters/surface_records_stages.h"

namespace vecino {

struct BandContext {
    const RecordTracer& tracer;
    const TraceKernel& kernel;
    const RenderSettings& settings;
    PixelClusters& clusters;           ///< with room for the rows
    Pace* pace;                        ///< null: the plan stands
    std::function<void()> checkpoint;  ///< between stages; throws to interrupt
};

/// Fills in the rows of the frame, and adds up times and counts. A pace changes the plan.
void make_band(const BandContext& context, const BandRows& rows, StagedRender& out);

}  // namespace vecino
