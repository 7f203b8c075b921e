// SPDX-License-Identifier: Apache-2.0

/// @file
/// Guides: full-resolution planes of first hits, cheap to trace, by which schemes tell surfaces
/// apart. A guide may come from any renderer, so that what its planes mean is checked.
#pragma once

#include <string>
#include <vector>

#include "core/frame.h"
#include "core/planes.h"

namespace vecino {

/// The planes of a guide that schemes read. At least one of position, normal, distance and id has
/// to be there.
constexpr Planes kGuidePlanes{Plane::position, Plane::normal,   Plane::albedo,
                              Plane::emission, Plane::distance, Plane::id};

/// Width and height of the planes that are there, 0x0 without any. A guide needs no radiance.
Extent guide_size(const Frame& guide);

/// Throws Error(mismatch) unless the guide has a plane to tell surfaces by, its planes are of one
/// size, and that is the given size or a whole multiple of it. name stands in errors.
void require_guide(const Frame& guide, Extent size, const std::string& name);

/// Brings the planes of any renderer to the form that schemes read, or throws Error(mismatch) with
/// one line that says what they hold instead:
/// - normals of unit length; such encoded as (n + 1) / 2 are decoded
/// - normals that fit the positions: planes of two coordinate systems do not
/// - positions that are not the same everywhere
/// - distances of one sign, which becomes positive; along the ray or along the axis of the camera
/// - albedo from 0 to 1
/// - emission that is not negative
///
/// Pixels of no hit get the id kMiss, where there are ids: those of no normal, of a distance of 0
/// or beyond 1e9. Returns notes for people: what was decoded.
std::vector<std::string> check_guide(Frame& guide, const std::string& file);

}  // namespace vecino
