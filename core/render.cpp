// SPDX-License-Identifier: Apache-2.0
#include "core/render.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <span>
#include <string>

#include "core/accumulate.h"
#include "core/error.h"
#include "core/frame_planes.h"
#include "core/parallel.h"
#include "core/part.h"
#include "core/render_task.h"
#include "core/timing.h"
#include "core/trace_task.h"

namespace vecino {
namespace {

// Pixels handed to a thread at a time: few enough to balance small frames, many enough to be cheap
// at 1 spp.
constexpr std::size_t kPixelsPerBlock = 16;

/// Those asked for, radiance, and not the variance of one sample.
Planes planes_to_make(const RenderSettings& settings) {
    Planes planes{Plane::radiance};
    for (const PlaneInfo& info : all_planes()) {
        const bool possible = info.plane != Plane::variance || settings.spp > 1;
        if (possible && settings.planes.has(info.plane)) planes.add(info.plane);
    }
    return planes;
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

/// What is kept of a pixel's primary rays.
struct PixelHits {
    FirstHitRecord first;
    GuideSums sums;
};

/// What is done with a traced pixel. Returns false if its mean is not finite.
using StorePixel =
    std::function<bool(std::size_t index, const PixelAccumulator&, const PixelHits&)>;

/// Traces an interval of the samples of every pixel.
class SampleTracer {
  public:
    SampleTracer(const TraceTask& task, const RenderSettings& settings, SampleInterval samples)
        : task_(task),
          kernel_(kernel_for(settings.simd_width)),
          settings_(settings),
          samples_(samples),
          centres_(settings.first_hit == FirstHit::centre && samples.begin == 0 &&
                   common(settings.planes, kFirstHitPlanes) != Planes{}),
          means_(common(settings.planes, kMeanPlanes) != Planes{}) {}

    void run(const StorePixel& store, RenderStatistics& statistics,
             const Progress& progress) const {
        const std::size_t pixels = Extent{task_.width, task_.height}.area();
        ProgressReport report(progress, pixels);
        std::atomic<std::uint64_t> rays = 0;
        std::atomic<std::uint64_t> dropped = 0;
        std::atomic<std::uint64_t> non_finite = 0;
        for_each_block(pixels, kPixelsPerBlock, settings_.threads, [&](BlockRange block) {
            Counts counts;
            PixelAccumulator pixel(variance_of(settings_));
            for (std::size_t i = block.begin; i < block.end; ++i) {
                pixel.clear();
                const PixelHits hits = trace_pixel(i, pixel, counts);
                counts.dropped += pixel.dropped();
                if (!store(i, pixel, hits)) ++counts.non_finite;
            }
            rays += counts.rays;
            dropped += counts.dropped;
            non_finite += counts.non_finite;
            report.advance(block.end - block.begin);
        });
        statistics.rays = rays;
        statistics.dropped_samples = dropped;
        statistics.non_finite_pixels = non_finite;
        statistics.samples = pixels * static_cast<std::uint64_t>(samples_.end - samples_.begin);
    }

  private:
    struct Counts {
        std::uint64_t rays = 0;
        std::uint64_t dropped = 0;
        std::uint64_t non_finite = 0;
    };

    PixelHits trace_pixel(std::size_t index, PixelAccumulator& pixel, Counts& counts) const {
        const auto [x, y] = pixel_at(index, {task_.width, task_.height});
        PixelHits hits{};
        SampleBlock block;
        for (int sample = samples_.begin; sample < samples_.end;) {
            const int count = std::min(kBlockSamples, samples_.end - sample);
            const SampleRange range{x, y, static_cast<std::uint32_t>(sample), count};
            const PrimaryHits kept{sample == 0 ? &hits.first : nullptr,
                                   means_ ? &hits.sums : nullptr};
            counts.rays += kernel_.trace_samples(task_, range, block, kept);
            pixel.add(block, count);
            sample += count;
        }
        if (centres_) counts.rays += kernel_.trace_centres(task_, {x, y, 0, 1}, &hits.first);
        return hits;
    }

    const TraceTask& task_;
    const TraceKernel& kernel_;
    const RenderSettings& settings_;
    SampleInterval samples_;
    bool centres_;
    bool means_;
};

struct Job {
    const Scene& scene;
    const RenderSettings& settings;
    SampleInterval samples;
};

/// Of a render that has not begun. Throws Error(usage) for a packet width that is not to be had.
RenderStatistics first_statistics(const RenderSettings& settings) {
    RenderStatistics statistics;
    statistics.threads = settings.threads > 0 ? settings.threads : default_thread_count();
    statistics.simd_width = kernel_for(settings.simd_width).width;
    return statistics;
}

/// Prepares a scene, traces an interval of samples, and hands each pixel to store.
RenderStatistics trace(const Job& job, const StorePixel& store, const Progress& progress) {
    const auto& [scene, settings, samples] = job;
    RenderStatistics statistics = first_statistics(settings);
    const Stopwatch scene_watch;
    const FlatScene flat = flatten(scene);
    TraceTask task = render_task(scene, flat, settings);
    task.streams = planes_to_make(settings).has(Plane::variance) ? kStreams : 1;
    statistics.scene_s = scene_watch.seconds();

    const Stopwatch trace_watch;
    SampleTracer(task, settings, samples).run(store, statistics, progress);
    statistics.trace_s = trace_watch.seconds();
    return statistics;
}

}  // namespace

std::vector<int> simd_widths() {
    std::vector<int> widths;
    for (const int width : {16, 8, 4, 1}) {
        if (find_trace_kernel(width) != nullptr) widths.push_back(width);
    }
    return widths;
}

VarianceOf variance_of(const RenderSettings& settings) {
    if (!planes_to_make(settings).has(Plane::variance)) return VarianceOf::nothing;
    return settings.sampler == Sampler::sobol ? VarianceOf::streams : VarianceOf::samples;
}

Render render(const Scene& scene, const RenderSettings& settings, const Progress& progress) {
    check_settings(settings);
    const RenderStatistics statistics = first_statistics(settings);
    const Extent size = reduced(settings.size, settings.reduction);
    Render result{make_frame(size, planes_to_make(settings)), statistics};
    if (scene.pattern == Pattern::xy_gradient) {
        fill_pattern(result.frame);
        return result;
    }
    const VarianceOf variance = variance_of(settings);
    const auto store = [&](std::size_t index, const PixelAccumulator& pixel,
                           const PixelHits& hits) {
        const Pixel at = pixel_at(index, size);
        std::array<ExactSum::Digits, kMostSums> sums;
        pixel.sums(sums);
        store_first_hit(hits.first, at, result.frame);
        store_means(hits.sums, settings.spp, at, result.frame);
        const PixelValues values = pixel_values(sums, variance);
        store_values(values, at, result.frame);
        return is_finite(values.radiance());
    };
    result.statistics = trace({scene, settings, {0, settings.spp}}, store, progress);
    return result;
}

PartRender render_part(const Scene& scene, const RenderSettings& settings, SampleInterval samples,
                       const Progress& progress) {
    check_settings(settings);
    const std::string fault = interval_fault(samples, settings.spp);
    if (!fault.empty()) throw Error(ExitCode::usage, "samples: " + fault);
    if (scene.pattern != Pattern::none) {
        throw Error(ExitCode::usage, "samples: found the scene " + scene.name +
                                         ", which is a pattern, allowed: a scene of objects");
    }
    if (common(settings.planes, kMeanPlanes) != Planes{}) {
        throw Error(ExitCode::usage,
                    "planes: found albedo_mean or normal_mean with a part of the samples, allowed: "
                    "with all of them");
    }
    const Extent size = reduced(settings.size, settings.reduction);
    const Planes planes = planes_to_make(settings);
    const VarianceOf variance = variance_of(settings);
    PartRender result{{samples, planes, variance, SampleSums(size, sum_count(variance)), {}}, {}};
    Part& part = result.part;
    if (samples.begin == 0) part.first_hits = make_frame(size, common(planes, kFirstHitPlanes));
    const auto store = [&](std::size_t index, const PixelAccumulator& pixel,
                           const PixelHits& hits) {
        std::array<ExactSum::Digits, kMostSums> sums;
        pixel.sums(sums);
        part.sums.store(index, sums);
        store_first_hit(hits.first, pixel_at(index, size), part.first_hits);
        return true;  // of the whole mean, nothing is known yet
    };
    result.statistics = trace({scene, settings, samples}, store, progress);
    return result;
}

}  // namespace vecino
