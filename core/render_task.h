// SPDX-License-Identifier: Apache-2.0
//
// From settings to what a kernel reads: shared by renders and by benchmarks of their inner loop.
#pragma once

#include "core/flat_scene.h"
#include "core/render.h"
#include "core/trace_task.h"

namespace vecino {

/// Throws Error(usage) naming a setting that is out of range.
void check_settings(const RenderSettings& settings);

/// The kernel of a width, 0 for the machine's widest. Throws Error(usage) naming the allowed ones.
const TraceKernel& kernel_for(int simd_width);

/// Of a render that has not begun. Throws Error(usage) for a packet width that is not to be had.
RenderStatistics first_statistics(const RenderSettings& settings);

/// Everything but the streams. The flat scene must outlive it.
TraceTask render_task(const Scene& scene, const FlatScene& flat, const RenderSettings& settings);

}  // namespace vecino
