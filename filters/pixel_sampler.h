// SPDX-License-Identifier: Apache-2.0
//
// Further samples of needy pixels.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "core/frame_planes.h"
#include "core/trace_task.h"
#include "filters/pixel_needs.h"
#include "filters/record_resolve.h"
#include "filters/surface_records.h"

namespace vecino {

struct NeedyPlace {
    NeedyPixel pixel;
    int y;
};

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

    /// Takes what became of a pixel.
    using Take = std::function<void(const NeedyPlace&, const SampledPixel&)>;

    /// Samples those that want any, in no order; each pixel's clusters are read before they are
    /// taken. Changes nothing by itself: it may be called to see how long it takes.
    void sample(std::span<const NeedyPlace> places, const Take& take) const;

    /// About what that takes for one, in samples of a pixel that is not crowded.
    [[nodiscard]] double work(const NeedyPlace& place) const;

  private:
    /// Pixels that share packets, with as many samples each.
    struct Few {
        int count = 0;
        NeedyPlace places[kPilotPixels];
    };

    [[nodiscard]] std::uint32_t pilot_spp() const {
        return static_cast<std::uint32_t>(inputs_.plan.pilot_spp);
    }
    [[nodiscard]] bool is_crowded(const NeedyPlace& place) const;
    [[nodiscard]] bool wants(const NeedyPlace& place) const;
    [[nodiscard]] bool shares_packets(const NeedyPlace& place) const;
    [[nodiscard]] std::uint32_t paths_of(const NeedyPixel& pixel, bool crowded) const;
    [[nodiscard]] SampledPixel sample_one(const NeedyPlace& place) const;
    void sample_few(Few& few, const Take& take) const;
    void finish(const NeedyPlace& place, int known_clusters, SampledPixel& out) const;
    void trace_paths(Pixel at, std::uint32_t paths, SampledPixel& out) const;
    [[nodiscard]] std::int32_t known_surface(const NeedyPixel& pixel,
                                             const ClusterList& list) const;
    void adopt(int number, Pixel at, SampledPixel& out) const;

    Inputs inputs_;
};

/// Whether there is light that records stand for.
bool has_records(const TraceTask& task);

}  // namespace vecino
