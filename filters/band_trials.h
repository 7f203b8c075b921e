// SPDX-License-Identifier: Apache-2.0
//
// What a pace wants to know of a band of rows while it is made: work done on a few places to see
// how long it takes, and thrown away, and what is told by a few pixels of the rest.
#pragma once

#include <functional>

#include "filters/needed_samples.h"
#include "filters/pace.h"
#include "filters/pixel_sampler.h"

namespace vecino {

class BandTrials {
  public:
    /// A band, as far as it is there.
    struct Inputs {
        const RecordTracer& tracer;
        const TraceKernel& kernel;
        const PixelClusters& clusters;
        RowRange rows;
        const NeedyRows& needy;  ///< of these
        const RecordMap& records;
        const SurfaceRecordsPlan& plan;
        const Pace& pace;
    };

    explicit BandTrials(const Inputs& inputs);

    [[nodiscard]] PilotCost pilot_cost() const;

    /// With first samples and needs.
    [[nodiscard]] PaceFindings structure() const;

    /// With records: seconds of one thread for a unit of work on needy pixels.
    [[nodiscard]] double edge_unit_s(const NeededSamples& needed) const;
    /// The work on all of them, with smoothing.
    [[nodiscard]] double edge_work(const NeededSamples& needed, int edge_spp) const;
    [[nodiscard]] ErrorFindings errors(const NeededSamples& needed) const;

  private:
    /// Some of the needy pixels: about so many, in runs of neighbours, as they are sampled in.
    struct Choice {
        int number;  ///< others for each
        std::size_t pixels, run;
    };
    /// Samples of a pixel, by row and number.
    using Given = std::function<std::uint32_t(std::size_t, std::size_t)>;

    [[nodiscard]] PixelSampler sampler(const SurfaceRecordsPlan& plan) const;
    [[nodiscard]] double first_samples_s(int samples) const;
    [[nodiscard]] double unit_s(int number, const Given& given) const;
    [[nodiscard]] EdgeCurve edge_curve(const NeededSamples& needed, const NeedyRows& some,
                                       int pilot_spp) const;
    [[nodiscard]] std::vector<std::pair<int, EdgeCurve>> edge_curves(
        const glm::vec3& ambient) const;
    template <class Visit>
    void visit_some(const Choice& choice, const Visit& visit) const;

    Inputs inputs_;
    double needy_pixels_ = 0;
};

}  // namespace vecino
