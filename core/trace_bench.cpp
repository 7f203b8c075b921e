// SPDX-License-Identifier: Apache-2.0
#include "core/trace_bench.h"

#include <algorithm>
#include <cmath>

#include "core/accumulate.h"
#include "core/error.h"
#include "core/render_task.h"

namespace vecino {
namespace {

/// Points of the R2 sequence (Roberts 2018): evenly spread, and along no row or column.
std::vector<glm::ivec2> spread_pixels(Extent size, int count) {
    constexpr double kStepX = 0.7548776662466927;
    constexpr double kStepY = 0.5698402909980532;
    const auto at = [](int i, double step, int side) {
        const double place = 0.5 + i * step;
        return std::min(static_cast<int>((place - std::floor(place)) * side), side - 1);
    };
    std::vector<glm::ivec2> pixels;
    for (int i = 0; i < count; ++i) {
        pixels.emplace_back(at(i, kStepX, size.width), at(i, kStepY, size.height));
    }
    return pixels;
}

const Scene& require_objects(const Scene& scene) {
    if (scene.pattern == Pattern::none) return scene;
    throw Error(ExitCode::usage,
                scene.name + ": found a pattern, allowed: a scene with rays to trace");
}

const RenderSettings& checked(const RenderSettings& settings) {
    check_settings(settings);
    return settings;
}

}  // namespace

TraceBench::TraceBench(const Scene& scene, const RenderSettings& settings, int pixel_count)
    : flat_(flatten(require_objects(scene))),
      task_(render_task(scene, flat_, checked(settings))),
      kernel_(kernel_for(settings.simd_width)),
      spp_(settings.spp),
      pixels_(spread_pixels({task_.width, task_.height}, pixel_count)),
      packets_(record()) {}

std::uint64_t TraceBench::trace() const {
    return trace(task_);
}

std::uint64_t TraceBench::samples() const {
    return pixels_.size() * static_cast<std::uint64_t>(spp_);
}

std::uint64_t TraceBench::trace(const TraceTask& task) const {
    std::uint64_t rays = 0;
    for (const glm::ivec2 at : pixels_) {
        PixelAccumulator pixel(VarianceOf::nothing);
        SampleBlock block;
        for (std::uint32_t sample = 0; sample < static_cast<std::uint32_t>(spp_);
             sample += kBlockSamples) {
            const int count = std::min(kBlockSamples, spp_ - static_cast<int>(sample));
            rays += kernel_.trace_samples(task, {at.x, at.y, sample, count}, block, {});
            pixel.add(block, count);
        }
    }
    return rays;
}

PacketLog TraceBench::record() const {
    PacketLog log(task_.camera_origin);
    TraceTask task = task_;
    task.packet_log = &log;
    trace(task);
    return log;
}

}  // namespace vecino
