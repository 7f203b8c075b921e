// SPDX-License-Identifier: Apache-2.0
#include "core/pixel_tracer.h"

#include <algorithm>
#include <array>
#include <mutex>

#include "core/error.h"
#include "core/parallel.h"
#include "core/render_task.h"
#include "core/timing.h"

namespace vecino {
namespace {

// Pixels handed to a thread at a time: few enough to balance small frames, many enough to be cheap
// at 1 spp.
constexpr std::size_t kPixelsPerBlock = 16;

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

}  // namespace

Progress stage(const Progress& whole, double begin, double end) {
    if (!whole) return {};
    return [&whole, begin, end](double done) { return whole(begin + (end - begin) * done); };
}

// ---------------------------------------------------------------- one pixel

PixelTrace::PixelTrace(const TraceTask& task, const TraceKernel& kernel, const PixelTracer& tracer)
    : task_(task),
      kernel_(kernel),
      variance_of_(tracer.variance_of_),
      keeps_means_(tracer.keeps_means_),
      sums_(tracer.variance_of_) {}

void PixelTrace::begin(std::size_t index) {
    index_ = index;
    at_ = pixel_at(index, {task_.width, task_.height});
    sums_.clear();
    guide_sums_ = {};
    is_traced_ = false;
}

void PixelTrace::trace(SampleInterval samples, const BlockReader& reader) {
    SampleBlock block;
    for (int sample = samples.begin; sample < samples.end;) {
        const int count = std::min(kBlockSamples, samples.end - sample);
        const SampleRange range{at_.x, at_.y, static_cast<std::uint32_t>(sample), count};
        const PrimaryHits kept{is_traced_ ? nullptr : &first_hit_,
                               keeps_means_ ? &guide_sums_ : nullptr};
        rays_ += kernel_.trace_samples(task_, range, block, kept);
        is_traced_ = true;
        sums_.add(block, count);
        if (reader) reader(block, sample, count);
        sample += count;
    }
    samples_ += static_cast<std::uint64_t>(samples.end - samples.begin);
}

void PixelTrace::trace_centre() {
    rays_ += kernel_.trace_centres(task_, {at_.x, at_.y, 0, 1}, &first_hit_);
}

PixelValues PixelTrace::values() const {
    std::array<ExactSum::Digits, kMostSums> sums;
    sums_.sums(sums);
    return pixel_values(sums, variance_of_);
}

// ---------------------------------------------------------------- many

PixelTracer::PixelTracer(const Scene& scene, const RenderSettings& settings, VarianceOf variance_of)
    : variance_of_(variance_of),
      keeps_means_(common(settings.planes, kMeanPlanes) != Planes{}),
      kernel_(kernel_for(settings.simd_width)),
      threads_(settings.threads) {
    const Stopwatch watch;
    flat_ = flatten(scene);
    task_ = render_task(scene, flat_, settings);
    task_.streams = variance_of == VarianceOf::streams ? kStreams : 1;
    statistics_ = first_statistics(settings);
    statistics_.scene_s = watch.seconds();
}

void PixelTracer::for_each_pixel(const Body& body, const Progress& progress) {
    run(
        size().area(), [](std::size_t i) { return i; }, body, progress);
}

void PixelTracer::for_each_pixel(std::span<const std::uint32_t> pixels, const Body& body,
                                 const Progress& progress) {
    run(
        pixels.size(), [pixels](std::size_t i) { return std::size_t{pixels[i]}; }, body, progress);
}

void PixelTracer::run(std::size_t count,
                      const std::function<std::size_t(std::size_t)>& pixel_number, const Body& body,
                      const Progress& progress) {
    const Stopwatch watch;
    ProgressReport report(progress, count);
    std::atomic<std::uint64_t> rays = 0, samples = 0, dropped = 0, non_finite = 0;
    for_each_block(count, kPixelsPerBlock, threads_, [&](BlockRange block) {
        PixelTrace pixel(task_, kernel_, *this);
        for (std::size_t i = block.begin; i < block.end; ++i) {
            pixel.begin(pixel_number(i));
            body(pixel);
            pixel.end();
        }
        rays += pixel.rays_;
        samples += pixel.samples_;
        dropped += pixel.dropped_;
        non_finite += pixel.non_finite_;
        report.advance(block.end - block.begin);
    });
    statistics_.rays += rays;
    statistics_.samples += samples;
    statistics_.dropped_samples += dropped;
    statistics_.non_finite_pixels += non_finite;
    statistics_.trace_s += watch.seconds();
}

std::vector<FirstHitRecord> PixelTracer::centre_hits(const Progress& progress) {
    const Stopwatch watch;
    std::vector<FirstHitRecord> hits(size().area());
    const auto width = static_cast<std::size_t>(task_.width);
    const std::size_t per_row = (width + kBlockSamples - 1) / kBlockSamples;
    const std::size_t runs = per_row * static_cast<std::size_t>(task_.height);
    ProgressReport report(progress, runs);
    std::atomic<std::uint64_t> rays = 0;
    for_each_block(runs, 1, threads_, [&](BlockRange block) {
        const std::size_t row = block.begin / per_row;
        const std::size_t x = block.begin % per_row * kBlockSamples;
        const auto count = std::min<std::size_t>(kBlockSamples, width - x);
        const SampleRange range{static_cast<std::int32_t>(x), static_cast<std::int32_t>(row), 0,
                                static_cast<std::int32_t>(count)};
        rays += kernel_.trace_centres(task_, range, &hits[row * width + x]);
        report.advance(1);
    });
    statistics_.rays += rays;
    statistics_.trace_s += watch.seconds();
    return hits;
}

void PixelTracer::primary_hits(
    const std::function<SampleInterval(std::size_t)>& samples_of,
    const std::function<void(std::size_t, const FirstHitRecord&, const GuideSums&)>& store,
    const Progress& progress) {
    const Stopwatch watch;
    TraceTask task = task_;
    task.max_depth = 0;
    ProgressReport report(progress, size().area());
    std::atomic<std::uint64_t> rays = 0;
    for_each_block(size().area(), kPixelsPerBlock, threads_, [&](BlockRange block) {
        PixelTrace pixel(task, kernel_, *this);
        for (std::size_t i = block.begin; i < block.end; ++i) {
            pixel.begin(i);
            pixel.trace(samples_of(i));
            store(i, pixel.first_hit(), pixel.guide_sums());
        }
        rays += pixel.rays_;
        report.advance(block.end - block.begin);
    });
    statistics_.rays += rays;
    statistics_.trace_s += watch.seconds();
}

}  // namespace vecino
