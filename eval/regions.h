// SPDX-License-Identifier: Apache-2.0
//
// Where in an image an error sits: regions from full-resolution first hits. Every pixel is in
// exactly one, the first of the table that fits. All distances are Euclidean, between pixel
// centres, in pixels.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/planes.h"

namespace vecino {

enum class Region : std::uint8_t { emitter, edge, interior };

struct RegionInfo {
    Region region;
    std::string_view name;        ///< key in JSON
    std::string_view definition;  ///< one line
};

/// All regions, in the order in which they are tried and shown.
inline constexpr std::array<RegionInfo, 3> kRegions = {{
    {Region::emitter, "emitter", "within width/32 px of a pixel that sees an emitter"},
    {Region::edge, "edge",
     "within 2 px of a change of object, albedo, or normal by more than 18 degrees"},
    {Region::interior, "interior", "all other pixels"},
}};

/// One value per region, at region_index(region).
template <class T>
using PerRegion = std::array<T, kRegions.size()>;

constexpr std::size_t region_index(Region region) {
    return static_cast<std::size_t>(region);
}

using RegionMap = Grid<Region>;

/// The planes that regions are made from.
inline constexpr Planes kRegionPlanes{Plane::emission, Plane::albedo, Plane::normal, Plane::id};

bool has_region_planes(const Frame& frame);

/// The region of every pixel.
///   emitter   within W/32 of a pixel whose emission is above 0 in some channel and that is no miss
///             (a background is no emitter); W is the width of the image
///   edge      within 2 of a pixel that differs from one of its 4 neighbours: in object id, in a
///             channel of albedo by more than 1e-3, or in the direction of the normal by more than
///             18 degrees. A miss differs from every hit and from no other miss.
///   interior  the rest
/// Throws Error(mismatch) naming the planes that are not there, or when their sizes differ.
RegionMap regions_of(const Frame& frame);

/// How many pixels each region has.
PerRegion<std::size_t> region_pixels(const RegionMap& regions);

/// Throws Error(mismatch) unless the map has the image's size, naming both.
void require_size(const RegionMap& regions, Extent image);

}  // namespace vecino
