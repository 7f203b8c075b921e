// SPDX-License-Identifier: Apache-2.0
//
// Where records go: in each cell of pixels one for each side of a surface that it shows.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "filters/records.h"

namespace vecino {

/// Where a record could be.
struct Candidate {
    RecordSeed seed;
    std::int32_t object;
    glm::vec3 normal;
    float least_cosine;  ///< between its normal and others of its surface in the cell
    float score;  ///< the higher the better: most of a pixel, in the middle, nothing else beside
};

using Candidates = std::vector<Candidate>;

/// The best of each surface of the active cells, row by row; fills in where each cell's records
/// begin.
Candidates place_records(const PixelClusters& clusters, RecordLevel& level, int threads);

}  // namespace vecino
