// SPDX-License-Identifier: Apache-2.0
//
// How many samples needy pixels get: in proportion to the error that is expected of them.
#pragma once

#include <cstdint>
#include <vector>

#include "filters/pixel_needs.h"
#include "filters/records.h"

namespace vecino {

/// Of a pixel that gets any. Fewer save little time and cost much.
constexpr int kLeastEdgeSpp = 16;

/// What decides.
struct NeedInputs {
    const RecordTracer& tracer;
    const PixelClusters& clusters;
    const RecordMap& records;
};

class NeededSamples {
  public:
    /// needy: of rows, as find_needs() gives them.
    NeededSamples(const NeedInputs& inputs, RowRange rows, const NeedyRows& needy);

    /// Shares out samples, edge_spp for each needy pixel on average; edge_spp >= 1.
    void give(int edge_spp, NeedyRows& needy) const;

    /// What give() gives pixel number i of a row.
    [[nodiscard]] std::uint32_t samples(std::size_t row, std::size_t i, int edge_spp) const;

    /// What is left of the error then: a sum over needy pixels of mean squares in sRGB. needy: as
    /// before. Of pilot_spp samples is what gets no others.
    [[nodiscard]] double error(const NeedyRows& needy, int edge_spp, int pilot_spp) const;

  private:
    std::vector<std::vector<float>> spreads_;  ///< standard deviation of one sample, sRGB
    double mean_;
};

}  // namespace vecino
