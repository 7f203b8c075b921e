// SPDX-License-Identifier: Apache-2.0
//
// Tracing of chosen pixels of a frame, in parallel, with the sums of a whole render: what every
// pixel gets depends on its samples alone, not on which other pixels are traced, on threads or
// time. Renders trace all pixels once; methods that decide where rays go trace some, look at them,
// and trace others.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/accumulate.h"
#include "core/flat_scene.h"
#include "core/frame_planes.h"
#include "core/part.h"
#include "core/render.h"

namespace vecino {

/// Of a stage of a longer work: its progress goes from begin to end, both in [0, 1].
Progress stage(const Progress& whole, double begin, double end);

/// Sees every block of samples that a pixel gets, without those that were not finite: number first
/// is the block's first one.
using BlockReader = std::function<void(const SampleBlock&, int first, int count)>;

class PixelTracer;

/// One pixel in the hands of one thread.
class PixelTrace {
  public:
    [[nodiscard]] std::size_t index() const { return index_; }  ///< row by row
    [[nodiscard]] Pixel at() const { return at_; }

    /// Traces samples and adds them to sums(), in blocks of at most 64. More of the pixel's samples
    /// may follow.
    void trace(SampleInterval samples, const BlockReader& reader = {});
    /// Makes first_hit() that of the ray through the pixel's centre.
    void trace_centre();

    [[nodiscard]] const PixelAccumulator& sums() const { return sums_; }
    /// Values of all samples so far.
    [[nodiscard]] PixelValues values() const;
    /// Of the first sample traced.
    [[nodiscard]] const FirstHitRecord& first_hit() const { return first_hit_; }
    /// Of all samples so far, if a plane of means was asked for.
    [[nodiscard]] const GuideSums& guide_sums() const { return guide_sums_; }
    /// Counts the pixel among those whose mean is beyond the range of float.
    void mark_non_finite() { ++non_finite_; }

  private:
    friend class PixelTracer;
    PixelTrace(const TraceTask& task, const TraceKernel& kernel, const PixelTracer& tracer);
    void begin(std::size_t index);
    void end() { dropped_ += sums_.dropped(); }

    const TraceTask& task_;
    const TraceKernel& kernel_;
    VarianceOf variance_of_;
    bool keeps_means_;
    std::size_t index_ = 0;
    Pixel at_{};
    PixelAccumulator sums_;
    FirstHitRecord first_hit_{};
    GuideSums guide_sums_{};
    bool is_traced_ = false;
    // Of all pixels that this thread had in hand:
    std::uint64_t rays_ = 0, samples_ = 0, dropped_ = 0, non_finite_ = 0;
};

class PixelTracer {
  public:
    /// Prepares the scene. The settings are sound, and outlive it. Throws Error(usage) for a packet
    /// width that is not to be had.
    PixelTracer(const Scene& scene, const RenderSettings& settings, VarianceOf variance_of);
    PixelTracer(const PixelTracer&) = delete;
    PixelTracer& operator=(const PixelTracer&) = delete;

    /// All pixels use the random numbers of the first one from now on.
    void share_samples() { task_.shares_samples = true; }

    [[nodiscard]] Extent size() const { return {task_.width, task_.height}; }
    [[nodiscard]] VarianceOf variance_of() const { return variance_of_; }

    using Body = std::function<void(PixelTrace&)>;
    /// Hands every pixel to body, in parallel. Throws Error(interrupted) when progress says so.
    void for_each_pixel(const Body& body, const Progress& progress);
    /// The same for some, by index; each stands there once.
    void for_each_pixel(std::span<const std::uint32_t> pixels, const Body& body,
                        const Progress& progress);

    /// The first hits of rays through the centres of all pixels, row by row.
    std::vector<FirstHitRecord> centre_hits(const Progress& progress);
    /// Traces what samples of every pixel hit first, without light: one ray each. Each pixel has a
    /// sample or more.
    void primary_hits(
        const std::function<SampleInterval(std::size_t)>& samples_of,
        const std::function<void(std::size_t, const FirstHitRecord&, const GuideSums&)>& store,
        const Progress& progress);

    /// Of everything traced so far.
    [[nodiscard]] const RenderStatistics& statistics() const { return statistics_; }

  private:
    void run(std::size_t count, const std::function<std::size_t(std::size_t)>& pixel_number,
             const Body& body, const Progress& progress);

    friend class PixelTrace;

    VarianceOf variance_of_;
    bool keeps_means_;
    RenderStatistics statistics_;
    FlatScene flat_;
    TraceTask task_;
    const TraceKernel& kernel_;
    int threads_;
};

}  // namespace vecino
