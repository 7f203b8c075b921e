// SPDX-License-Identifier: Apache-2.0
#include "core/first_hits.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "core/flat_scene.h"
#include "core/frame_planes.h"
#include "core/parallel.h"
#include "core/render_task.h"
#include "core/timing.h"
#include "core/trace_task.h"

namespace vecino {
namespace {

constexpr std::size_t kRowsPerBlock = 8;

/// One row, in runs of as many pixels as a kernel takes. Returns rays.
std::uint64_t trace_row(const TraceTask& task, const TraceKernel& kernel, int y, Frame& frame) {
    std::array<FirstHitRecord, kBlockSamples> hits;
    std::uint64_t rays = 0;
    for (int x = 0; x < task.width; x += kBlockSamples) {
        const int count = std::min(kBlockSamples, task.width - x);
        rays += kernel.trace_centres(task, {x, y, 0, count}, hits.data());
        for (int i = 0; i < count; ++i) {
            const FirstHitRecord& hit = hits[static_cast<std::size_t>(i)];
            store_first_hit(hit, {x + i, y}, frame);
            if (!frame.emission.empty())
                frame.emission(x + i, y) = {hit.emission[0], hit.emission[1], hit.emission[2]};
        }
    }
    return rays;
}

}  // namespace

Render trace_first_hits(const Scene& scene, const RenderSettings& settings) {
    check_settings(settings);
    Planes planes = kFirstHitPlanes;
    planes.add(Plane::emission);
    planes = common(planes, settings.planes);
    Render result{make_frame(settings.size, planes), {}};
    result.statistics.threads = settings.threads > 0 ? settings.threads : default_thread_count();
    const TraceKernel& kernel = kernel_for(settings.simd_width);
    result.statistics.simd_width = kernel.width;
    if (scene.pattern == Pattern::xy_gradient) {
        fill_pattern(result.frame, settings.size);
        return result;
    }
    const Stopwatch scene_watch;
    const FlatScene flat = flatten(scene);
    RenderSettings whole = settings;
    whole.reduction = 1;
    const TraceTask task = render_task(scene, flat, whole);
    result.statistics.scene_s = scene_watch.seconds();
    const Stopwatch watch;
    std::atomic<std::uint64_t> rays = 0;
    for_each_block(static_cast<std::size_t>(settings.size.height), kRowsPerBlock, settings.threads,
                   [&](BlockRange rows) {
                       for (auto y = rows.begin; y < rows.end; ++y)
                           rays += trace_row(task, kernel, static_cast<int>(y), result.frame);
                   });
    result.statistics.rays = rays;
    result.statistics.trace_s = watch.seconds();
    return result;
}

}  // namespace vecino
