// SPDX-License-Identifier: Apache-2.0
//
// Interpolation between scattered pixels: whether they surround a place, and the value there of the
// plane that fits them best.
#pragma once

#include <cstddef>
#include <span>

#include "core/frame_planes.h"

namespace vecino {

constexpr std::size_t kMostPoints = 8;  ///< that one value is interpolated from

/// Whether the origin lies in the convex hull of the points, its border included.
bool surrounds_origin(std::span<const Pixel> points);

/// Writes the weights with which values at the points give that of the least-squares plane at the
/// origin; they sum to 1. Where the points lie on a line: inverse distances. Precondition: a point,
/// none at the origin, as many weights.
void weights_at_origin(std::span<const Pixel> points, std::span<double> weights);

}  // namespace vecino
