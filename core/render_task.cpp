// SPDX-License-Identifier: Apache-2.0
#include "core/render_task.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/error.h"
#include "core/parallel.h"

namespace vecino {
namespace {

void require(bool holds, const std::string& name, long long found, const std::string& allowed) {
    if (holds) return;
    throw Error(ExitCode::usage,
                name + ": found " + std::to_string(found) + ", allowed: " + allowed);
}

/// Whether points on such an emitter are uniform over its area from everywhere.
bool is_by_area(const TraceTask& task, LightKind kind) {
    if (kind == LightKind::rectangle) return !task.by_solid_angle && !task.control_variate;
    return kind != LightKind::sphere;
}

/// The ray through every uv becomes the one through uv + shift / size.
void shift_camera(const RenderSettings& s, TraceTask& task) {
    if (s.camera_shift == glm::vec2(0.0f)) return;
    const float right = 2.0f * s.camera_shift.x / static_cast<float>(s.size.width);
    const float up = -2.0f * s.camera_shift.y / static_cast<float>(s.size.height);
    for (int c = 0; c < 3; ++c)
        task.camera_forward[c] += right * task.camera_right[c] + up * task.camera_up[c];
}

}  // namespace

void check_settings(const RenderSettings& s) {
    constexpr int kMaxSide = 65536;
    require(s.size.width >= 1 && s.size.width <= kMaxSide, "size: width", s.size.width,
            "1 to 65536");
    require(s.size.height >= 1 && s.size.height <= kMaxSide, "size: height", s.size.height,
            "1 to 65536");
    require(s.reduction >= 1, "reduction", s.reduction, "1 or more");
    require(s.spp >= 1, "spp", s.spp, "1 or more");
    require(s.max_depth >= 0 && s.max_depth <= 1000, "max_depth", s.max_depth, "0 to 1000");
    for (const float shift : {s.camera_shift.x, s.camera_shift.y}) {
        if (std::abs(shift) <= kMaxSide) continue;
        throw Error(ExitCode::usage,
                    "camera_shift: found " + std::to_string(shift) + ", allowed: -65536 to 65536");
    }
    require(s.threads >= 0 && s.threads <= 1024, "threads", s.threads, "1 to 1024");
}

const TraceKernel& kernel_for(int simd_width) {
    const std::vector<int> widths = simd_widths();
    const TraceKernel* const kernel =
        find_trace_kernel(simd_width == 0 ? widths.front() : simd_width);
    if (kernel != nullptr) return *kernel;
    std::string allowed;
    for (const int w : widths) allowed += (allowed.empty() ? "" : ", ") + std::to_string(w);
    require(false, "simd_width", simd_width, allowed + " (on this machine)");
    return *kernel;
}

RenderStatistics first_statistics(const RenderSettings& settings) {
    RenderStatistics statistics;
    statistics.threads = settings.threads > 0 ? settings.threads : default_thread_count();
    statistics.simd_width = kernel_for(settings.simd_width).width;
    return statistics;
}

TraceTask render_task(const Scene& scene, const FlatScene& flat, const RenderSettings& settings) {
    const float aspect =
        static_cast<float>(settings.size.width) / static_cast<float>(settings.size.height);
    const Extent size = reduced(settings.size, settings.reduction);
    TraceTask task = trace_task(scene, flat, aspect);
    shift_camera(settings, task);
    task.width = size.width;
    task.height = size.height;
    task.max_depth = settings.max_depth;
    task.next_event_estimation = settings.light_sampling == LightSampling::nee;
    task.by_contribution = settings.light_choice == LightChoice::contribution;
    task.by_solid_angle = settings.light_point == LightPoint::solid_angle;
    task.control_variate = settings.control_variate == ControlVariate::irradiance;
    task.multiple_importance = settings.multiple_importance == MultipleImportance::balance &&
                               std::ranges::any_of(flat.lights, [&](const LightRecord& light) {
                                   return is_by_area(task, light.kind);
                               });
    task.shares_samples = false;
    task.sobol = settings.sampler == Sampler::sobol;
    task.streams = 1;
    task.seed = settings.seed;
    return task;
}

}  // namespace vecino
