// SPDX-License-Identifier: Apache-2.0
//
// What a render returns, and what a scheme reads: planes of values over one pixel grid. A plane
// that nobody asked for is empty. Planes of the first hit are point samples of one ray: never
// averaged, never filtered.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "core/grid.h"

namespace vecino {

constexpr std::int32_t kMiss = -1;

struct Frame {
    Image radiance;  ///< always made; radiance = emission + direct + indirect
    Image direct;    ///< light after exactly one bounce
    Image indirect;  ///< light after more than one bounce
    Image emission;  ///< light seen without a bounce (emitters and background)
    Image variance;  ///< of the pixel mean, per channel

    // The first surface along one ray through the pixel. A miss has zeros here and object_id ==
    // kMiss.
    Image albedo;
    Grid<glm::vec3> position_world;
    Grid<glm::vec3> normal_world;  ///< unit, geometric, facing the camera
    Grid<float> distance_world;    ///< from the camera position, along the ray
    Grid<std::int32_t> object_id;  ///< index into the scene file's "objects"

    Grid<float> sample_count;  ///< samples that entered the pixel mean

    [[nodiscard]] Extent size() const { return radiance.size(); }
};

}  // namespace vecino
