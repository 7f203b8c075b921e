// SPDX-License-Identifier: Apache-2.0
//
// Parallelograms that lie on others: which of two in one plane is hit must not depend on the order
// in which a tree is walked, which is another for other packet widths.
#pragma once

#include <array>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/packet_shapes.h"

namespace vecino {

/// For each shape those after it that lie in its plane, to rounding, and cover some of it; empty
/// where no shape has any. They are put into the very plane: a ray hits all of them at one
/// distance. Who tests a shape has to test these after it, by intersect_overlay: a tree may leave
/// out what seems to lie behind the hit that it has. `corners` are those that the shapes were made
/// of.
std::vector<std::vector<unsigned>> find_overlays(
    std::span<const std::array<glm::vec3, 4>> corners_world, std::span<ParallelogramShape> shapes);

/// As intersect of packet_shapes.h, but a hit at the distance of the last one takes its place.
void intersect_overlay(const ParallelogramShape& shape, const RayRows& rays, const HitRows& hits);

}  // namespace vecino
