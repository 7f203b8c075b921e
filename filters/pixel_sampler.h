// SPDX-License-Identifier: Apache-2.0
//
// Further samples of one needy pixel.
#pragma once

#include <optional>
#include <vector>

#include "core/frame_planes.h"
#include "core/trace_task.h"
#include "filters/pixel_needs.h"
#include "filters/record_resolve.h"
#include "filters/surface_records.h"

namespace vecino {

/// What further samples made of a pixel.
struct SampledPixel {
    ClusterList clusters;  ///< all samples, the first ones included; not of a traced pixel
    std::optional<TracedPixel> traced;
    std::vector<Orphan> orphans;
    std::uint64_t rays = 0;
    std::uint64_t samples = 0;
};

class PixelSampler {
  public:
    struct Inputs {
        const RecordTracer& tracer;
        const TraceKernel& kernel;
        const PixelClusters& clusters;
        const RecordMap& records;
        const SurfaceRecordsPlan& plan;
    };

    explicit PixelSampler(const Inputs& inputs) : inputs_(inputs) {}

    /// Whether a pixel gets any samples.
    [[nodiscard]] bool wants(const NeedyPixel& pixel, int y) const;

    /// Precondition: that it wants any. Changes nothing but what it returns: it may be called to
    /// see how long it takes.
    [[nodiscard]] SampledPixel sample(const NeedyPixel& pixel, int y) const;

    /// About what sample() does, in samples of a pixel that is not crowded.
    [[nodiscard]] double work(const NeedyPixel& pixel, int y) const;

  private:
    [[nodiscard]] bool is_crowded(const NeedyPixel& pixel, int y) const;
    [[nodiscard]] std::uint32_t paths_of(const NeedyPixel& pixel, bool crowded) const;
    void trace_paths(Pixel at, std::uint32_t paths, SampledPixel& out) const;
    [[nodiscard]] std::int32_t known_surface(const NeedyPixel& pixel,
                                             const ClusterList& list) const;
    void adopt(int number, Pixel at, SampledPixel& out) const;

    Inputs inputs_;
};

/// Whether there is light that records stand for.
bool has_records(const TraceTask& task);

}  // namespace vecino
