// SPDX-License-Identifier: Apache-2.0
//
// What there is in the bands of a frame, by a few rows of each and one sample of a pixel: to hold
// them against each other.
#pragma once

#include <vector>

#include "filters/pixel_clusters.h"
#include "filters/surface_records_stages.h"

namespace vecino {

/// Extrapolated to all of a band's rows.
struct BandSurvey {
    double pixels = 0;  ///< that are sampled
    double needy_pixels = 0;
    double records = 0;
    double pilot_s = 0;  ///< of so many
};

/// In their order. clusters: with room for any of them; what they hold is lost.
std::vector<BandSurvey> survey_bands(const RecordTracer& tracer, const std::vector<BandRows>& bands,
                                     PixelClusters& clusters);

}  // namespace vecino
