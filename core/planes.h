// SPDX-License-Identifier: Apache-2.0

/// @file
/// The names of the planes: in `--planes` lists, and as channels of an EXR file. The one table that
/// ties a name to a member of Frame; reading, writing, help and errors all follow from it.
#pragma once

#include <array>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "core/frame.h"

namespace vecino {

/// The planes of a Frame, each by the name that `--planes` has for it.
enum class Plane : unsigned {
    radiance,     ///< Frame::radiance
    direct,       ///< Frame::direct
    indirect,     ///< Frame::indirect
    emission,     ///< Frame::emission
    albedo,       ///< Frame::albedo
    position,     ///< Frame::position_world
    normal,       ///< Frame::normal_world
    distance,     ///< Frame::distance_world
    id,           ///< Frame::object_id
    count,        ///< Frame::sample_count
    variance,     ///< Frame::variance
    albedo_mean,  ///< Frame::albedo_mean
    normal_mean,  ///< Frame::normal_world_mean
};

/// A set of planes.
class Planes {
  public:
    /// None.
    constexpr Planes() = default;
    /// Those listed.
    constexpr Planes(std::initializer_list<Plane> planes) {
        for (const Plane plane : planes) bits_ |= bit(plane);
    }
    /// Whether the plane is in the set.
    [[nodiscard]] constexpr bool has(Plane plane) const { return (bits_ & bit(plane)) != 0; }
    /// Puts the plane into the set, if it is not there.
    constexpr void add(Plane plane) { bits_ |= bit(plane); }
    /// Adds all of a set.
    constexpr void add(Planes planes) { bits_ |= planes.bits_; }
    /// Every plane but the means of the first hits, which only denoisers read: those are made
    /// where they are named.
    static constexpr Planes all() {
        Planes planes;
        for (unsigned i = 0; i <= static_cast<unsigned>(Plane::variance); ++i)
            planes.bits_ |= 1u << i;
        return planes;
    }
    /// Whether both hold the same planes.
    friend constexpr bool operator==(const Planes&, const Planes&) = default;

  private:
    static constexpr unsigned bit(Plane plane) { return 1u << static_cast<unsigned>(plane); }
    unsigned bits_ = 0;
};

/// The member of Frame that holds a plane: three floats, one float or one integer per pixel.
using PlaneMember =
    std::variant<Grid<glm::vec3> Frame::*, Grid<float> Frame::*, Grid<std::int32_t> Frame::*>;

/// A row of the table of planes.
struct PlaneInfo {
    Plane plane;                               ///< what the row is about
    std::string_view name;                     ///< in `--planes` and in errors
    std::array<std::string_view, 3> channels;  ///< in EXR files; unused entries are empty
    PlaneMember member;                        ///< where a Frame holds it

    /// Channels in EXR files: 1 or 3.
    [[nodiscard]] std::size_t channel_count() const { return channels[1].empty() ? 1 : 3; }
};

/// All planes, in file order.
std::span<const PlaneInfo> all_planes();

/// "all", that is Planes::all(), or a comma-separated list of names. Throws Error(usage) naming the
/// allowed ones.
Planes parse_planes(const std::string& list);

/// The planes that a frame holds.
Planes planes_of(const Frame& frame);

}  // namespace vecino
