// SPDX-License-Identifier: Apache-2.0
#include "core/render.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <string>

#include "core/accumulate.h"
#include "core/error.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/render_task.h"
#include "core/timing.h"

namespace vecino {
namespace {

// Pixels handed to a thread at a time: few enough to balance small frames, many enough to be cheap
// at 1 spp.
constexpr std::size_t kPixelsPerBlock = 16;

/// Allocates the planes that were asked for.
Frame make_frame(Extent size, const RenderSettings& settings) {
    Frame frame;
    for (const PlaneInfo& info : all_planes()) {
        const bool wanted = info.plane == Plane::radiance || settings.planes.has(info.plane);
        const bool possible = info.plane != Plane::variance || settings.spp > 1;
        if (!wanted || !possible) continue;
        std::visit([&]<class T>(Grid<T> Frame::*member) { frame.*member = Grid<T>(size); },
                   info.member);
    }
    return frame;
}

void set(Image& plane, int x, int y, const glm::vec3& value) {
    if (!plane.empty()) plane(x, y) = value;
}

void store_first_hit(const FirstHitRecord& hit, int x, int y, Frame& frame) {
    const auto vector = [](const float(&v)[3]) { return glm::vec3(v[0], v[1], v[2]); };
    set(frame.position_world, x, y, vector(hit.position_world));
    set(frame.normal_world, x, y, vector(hit.normal_world));
    set(frame.albedo, x, y, vector(hit.albedo));
    if (!frame.distance_world.empty()) frame.distance_world(x, y) = hit.distance_world;
    if (!frame.object_id.empty()) frame.object_id(x, y) = hit.object_id;
}

bool wants_first_hits(const Frame& frame) {
    return !(frame.position_world.empty() && frame.normal_world.empty() && frame.albedo.empty() &&
             frame.distance_world.empty() && frame.object_id.empty());
}

VarianceOf variance_of(const Frame& frame, Sampler sampler) {
    if (frame.variance.empty()) return VarianceOf::nothing;
    return sampler == Sampler::sobol ? VarianceOf::streams : VarianceOf::samples;
}

/// Reports progress from any thread and remembers a wish to stop.
class ProgressReport {
  public:
    ProgressReport(const Progress& progress, std::size_t total)
        : progress_(progress), total_(total) {}

    void advance(std::size_t pixels) {
        const std::size_t done = done_.fetch_add(pixels) + pixels;
        if (!progress_) return;
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!lock.owns_lock()) return;
        if (!progress_(static_cast<double>(done) / static_cast<double>(total_))) {
            throw Error(ExitCode::interrupted, "interrupted");
        }
    }

  private:
    const Progress& progress_;
    std::size_t total_;
    std::atomic<std::size_t> done_ = 0;
    std::mutex mutex_;
};

class FrameTracer {
  public:
    FrameTracer(const TraceTask& task, const TraceKernel& kernel, const RenderSettings& settings)
        : task_(task), kernel_(kernel), settings_(settings) {}

    void run(Frame& frame, RenderStatistics& statistics, const Progress& progress) const {
        const std::size_t pixels = frame.size().area();
        ProgressReport report(progress, pixels);
        std::atomic<std::uint64_t> rays = 0;
        std::atomic<std::uint64_t> dropped = 0;
        std::atomic<std::uint64_t> non_finite = 0;
        for_each_block(pixels, kPixelsPerBlock, settings_.threads, [&](BlockRange block) {
            Counts counts;
            for (std::size_t i = block.begin; i < block.end; ++i) trace_pixel(i, frame, counts);
            rays += counts.rays;
            dropped += counts.dropped;
            non_finite += counts.non_finite;
            report.advance(block.end - block.begin);
        });
        statistics.rays = rays;
        statistics.dropped_samples = dropped;
        statistics.non_finite_pixels = non_finite;
        statistics.samples = pixels * static_cast<std::uint64_t>(settings_.spp);
    }

  private:
    struct Counts {
        std::uint64_t rays = 0;
        std::uint64_t dropped = 0;
        std::uint64_t non_finite = 0;
    };

    void trace_pixel(std::size_t index, Frame& frame, Counts& counts) const {
        const int x = static_cast<int>(index % static_cast<std::size_t>(task_.width));
        const int y = static_cast<int>(index / static_cast<std::size_t>(task_.width));
        PixelAccumulator pixel(variance_of(frame, settings_.sampler));
        FirstHitRecord first{};
        SampleBlock block;
        for (int sample = 0; sample < settings_.spp; sample += kBlockSamples) {
            const int count = std::min(kBlockSamples, settings_.spp - sample);
            const SampleRange range{x, y, static_cast<std::uint32_t>(sample), count};
            counts.rays +=
                kernel_.trace_samples(task_, range, block, sample == 0 ? &first : nullptr);
            pixel.add(block, count);
            if (sample > settings_.spp - kBlockSamples) break;  // no overflow near the largest spp
        }
        if (settings_.first_hit == FirstHit::centre && wants_first_hits(frame)) {
            counts.rays += kernel_.trace_centres(task_, {x, y, 0, 1}, &first);
        }
        counts.dropped += pixel.dropped();
        store(pixel, first, {x, y}, frame);
        if (!is_finite(frame.radiance(x, y))) ++counts.non_finite;
    }

    struct Pixel {
        int x, y;
    };

    static void store(const PixelAccumulator& sums, const FirstHitRecord& first, Pixel at,
                      Frame& frame) {
        const auto [x, y] = at;
        const glm::vec3 emission = sums.emission();
        const glm::vec3 direct = sums.direct();
        const glm::vec3 indirect = sums.indirect();
        set(frame.radiance, x, y, emission + direct + indirect);
        set(frame.emission, x, y, emission);
        set(frame.direct, x, y, direct);
        set(frame.indirect, x, y, indirect);
        if (!frame.variance.empty()) frame.variance(x, y) = sums.variance();
        if (!frame.sample_count.empty()) {
            frame.sample_count(x, y) = static_cast<float>(sums.samples());
        }
        store_first_hit(first, x, y, frame);
    }

    const TraceTask& task_;
    const TraceKernel& kernel_;
    const RenderSettings& settings_;
};

// Eq. 1 of the thesis. Constant over a pixel's samples: its box-filtered value is the one at the
// centre.
void fill_pattern(Frame& frame) {
    const Extent size = frame.size();
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            const glm::vec3 uv((static_cast<float>(x) + 0.5f) / static_cast<float>(size.width),
                               (static_cast<float>(y) + 0.5f) / static_cast<float>(size.height),
                               0.0f);
            set(frame.radiance, x, y, uv);
            set(frame.emission, x, y, uv);
            if (!frame.sample_count.empty()) frame.sample_count(x, y) = 1.0f;
            FirstHitRecord hit{};
            hit.position_world[0] = uv.x;
            hit.position_world[1] = uv.y;
            hit.normal_world[2] = 1.0f;
            store_first_hit(hit, x, y, frame);
        }
    }
}

}  // namespace

std::vector<int> simd_widths() {
    std::vector<int> widths;
    for (const int width : {16, 8, 4, 1}) {
        if (find_trace_kernel(width) != nullptr) widths.push_back(width);
    }
    return widths;
}

Render render(const Scene& scene, const RenderSettings& settings, const Progress& progress) {
    check_settings(settings);
    const TraceKernel& kernel = kernel_for(settings.simd_width);
    const Extent size = reduced(settings.size, settings.reduction);
    Planes planes = settings.planes;
    planes.add(Plane::radiance);
    require_memory(bytes_of(planes, size), "frame of " + size_text(size));
    Render result{make_frame(size, settings), {}};
    result.statistics.threads = settings.threads > 0 ? settings.threads : default_thread_count();
    result.statistics.simd_width = kernel.width;
    if (scene.pattern == Pattern::xy_gradient) {
        fill_pattern(result.frame);
        return result;
    }
    const Stopwatch scene_watch;
    const FlatScene flat = flatten(scene);
    TraceTask task = render_task(scene, flat, settings);
    task.streams = result.frame.variance.empty() ? 1 : kStreams;
    result.statistics.scene_s = scene_watch.seconds();

    const Stopwatch trace_watch;
    FrameTracer(task, kernel, settings).run(result.frame, result.statistics, progress);
    result.statistics.trace_s = trace_watch.seconds();
    return result;
}

}  // namespace vecino
