// SPDX-License-Identifier: Apache-2.0
//
// How many samples needy pixels get: in proportion to the error that is expected of them.
#pragma once

#include <cstdint>
#include <vector>

#include "filters/pixel_needs.h"
#include "filters/records.h"
#include "filters/sample_share.h"

namespace vecino {

/// What decides.
struct NeedInputs {
    const RecordTracer& tracer;
    const PixelClusters& clusters;
    int pilot_spp;             ///< what pixels have that get no others
    const RecordMap& records;  ///< empty: they are not there yet
    glm::vec3 ambient{0.0f};   ///< light over pi that is then taken for theirs
};

class NeededSamples {
  public:
    /// needy: of rows, as find_needs() gives them.
    NeededSamples(const NeedInputs& inputs, RowRange rows, const NeedyRows& needy);

    /// Shares out samples, edge_spp for each needy pixel on average; edge_spp >= 1.
    void give(int edge_spp, NeedyRows& needy) const;

    /// What give() gives pixel number i of a row.
    [[nodiscard]] std::uint32_t samples(std::size_t row, std::size_t i, int edge_spp) const;

    /// What comes of that, were there so many first samples: sums over needy pixels, or over one of
    /// every so many. needy: as before.
    struct Outlook {
        double error = 0;   ///< that is left: mean squares in sRGB
        double work = 0;    ///< samples, with what a pixel takes to begin with
        double pixels = 0;  ///< these are sums of
    };
    struct Question {
        int edge_spp, pilot_spp;
        std::size_t one_of = 1;
    };
    [[nodiscard]] Outlook outlook(const NeedyRows& needy, const Question& question) const;

  private:
    std::vector<std::vector<PixelSpread>> spreads_;
    double mean_;
    int pilot_spp_;
};

}  // namespace vecino
