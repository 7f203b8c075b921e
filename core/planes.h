// SPDX-License-Identifier: Apache-2.0
//
// The names of the planes: in --planes lists, and as channels of an EXR file. The one table that
// ties a name to a member of Frame; reading, writing, help and errors all follow from it.
#pragma once

#include <array>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "core/frame.h"

namespace vecino {

enum class Plane : unsigned {
    radiance,
    direct,
    indirect,
    emission,
    albedo,
    position,
    normal,
    distance,
    id,
    count,
    variance,
};

/// A set of planes.
class Planes {
  public:
    constexpr Planes() = default;
    constexpr Planes(std::initializer_list<Plane> planes) {
        for (const Plane plane : planes) bits_ |= bit(plane);
    }
    [[nodiscard]] constexpr bool has(Plane plane) const { return (bits_ & bit(plane)) != 0; }
    constexpr void add(Plane plane) { bits_ |= bit(plane); }
    static constexpr Planes all() {
        Planes planes;
        for (unsigned i = 0; i <= static_cast<unsigned>(Plane::variance); ++i)
            planes.bits_ |= 1u << i;
        return planes;
    }
    friend constexpr bool operator==(const Planes&, const Planes&) = default;

  private:
    static constexpr unsigned bit(Plane plane) { return 1u << static_cast<unsigned>(plane); }
    unsigned bits_ = 0;
};

/// The member of Frame that holds a plane: three floats, one float or one integer per pixel.
using PlaneMember =
    std::variant<Grid<glm::vec3> Frame::*, Grid<float> Frame::*, Grid<std::int32_t> Frame::*>;

struct PlaneInfo {
    Plane plane;
    std::string_view name;                     ///< in --planes and in errors
    std::array<std::string_view, 3> channels;  ///< in EXR files; unused entries are empty
    PlaneMember member;

    [[nodiscard]] std::size_t channel_count() const { return channels[1].empty() ? 1 : 3; }
};

/// All planes, in file order.
std::span<const PlaneInfo> all_planes();

/// "all" or a comma-separated list of names. Throws Error(usage) naming the allowed ones.
Planes parse_planes(const std::string& list);

/// The planes that a frame holds.
Planes planes_of(const Frame& frame);

}  // namespace vecino
