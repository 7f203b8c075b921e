// SPDX-License-Identifier: Apache-2.0

/// @file
/// What a render returns, and what a scheme reads: planes of values over one pixel grid. A plane
/// that nobody asked for is empty. Planes of the first hit are point samples of one ray: never
/// averaged, never filtered.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>

#include "core/grid.h"

namespace vecino {

/// Frame::object_id where a ray hit nothing.
constexpr std::int32_t kMiss = -1;

/// Planes over one pixel grid: each is of size(), or empty. Radiance is linear RGB, lengths are in
/// the scene's own unit.
struct Frame {
    Image radiance;  ///< always made; radiance = emission + direct + indirect
    Image direct;    ///< light after exactly one bounce
    Image indirect;  ///< light after more than one bounce
    Image emission;  ///< light seen without a bounce (emitters and background)
    Image variance;  ///< of the pixel mean, per channel, >= 0

    /// @name First hit
    /// The first surface along one ray through the pixel: which one, RenderSettings::first_hit
    /// says. A miss has zeros here and object_id == kMiss.
    /// @{
    Image albedo;                    ///< in [0, 1]
    Grid<glm::vec3> position_world;  ///< where the ray hit
    Grid<glm::vec3> normal_world;    ///< unit, geometric, facing the camera
    Grid<float> distance_world;      ///< from the camera position, along the ray
    Grid<std::int32_t> object_id;    ///< index into the scene file's "objects"
    /// @}

    /// @name Guides for denoisers
    /// Means of what the pixel's samples hit first; a miss counts as zeros.
    /// @{
    Image albedo_mean;                  ///< in [0, 1]
    Grid<glm::vec3> normal_world_mean;  ///< of shading normals: shorter than 1 where they differ
    /// @}

    Grid<float> sample_count;  ///< samples that entered the pixel mean

    /// Width and height of every plane that is there.
    [[nodiscard]] Extent size() const { return radiance.size(); }
};

}  // namespace vecino
