// SPDX-License-Identifier: Apache-2.0
//
// Surface elements: what a guide says of the surfaces in a pixel, of the low-resolution frame or of
// the result. A pixel has as many surfels as surfaces are in it; each covers a share of it. Both
// grids are made from the guide by the same rule, so that low-resolution samples are known by all
// that their area shows, not by one jittered ray of theirs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "core/frame.h"
#include "filters/exp_of_negative.h"

namespace vecino {

enum class SurfelKind : std::uint8_t {
    diffuse,  ///< radiance = emission + albedo * irradiance / pi
    emitter,  ///< its emission is known, and it reflects nothing
    unknown,  ///< no albedo is known, or one of 0: a mirror, a metal
    miss,     ///< no surface
    broken,   ///< position or normal are not finite
};

struct Surfel {
    glm::vec3 position{0.0f};    ///< mean over its part of the pixel
    glm::vec3 normal{0.0f};      ///< unit, or zeros: not known
    glm::vec3 modulation{1.0f};  ///< what the irradiance is multiplied by: albedo, 0 or 1
    glm::vec3 emission{0.0f};
    glm::vec2 place{0.0f};          ///< mean in the image, in low-resolution pixels
    float inverse_footprint = 0;    ///< 1 over the distance of low-resolution pixels on a surface
                                    ///< that faces the camera; 0: not known
    float inverse_distance = 0;     ///< from the camera; where no position is known
    glm::vec2 inverse_slope{0.0f};  ///< its change per low-resolution pixel
    float coverage = 1;             ///< share of the pixel, 0 to 1
    float purity = 1;  ///< how much the pixel's light tells of it, where others are whole
    std::int32_t id = 0;
    SurfelKind kind = SurfelKind::diffuse;
};

/// Low-resolution pixels that a distance is wide, where only distances are known and no angle of
/// view: about that of a usual camera at a few hundred pixels.
constexpr float kAssumedPixelsPerDistance = 200.0f;

/// Whole powers by squaring.
constexpr float power_of(float x, int exponent) {
    float result = 1.0f;
    for (; exponent > 0; exponent /= 2, x *= x) {
        if (exponent % 2 == 1) result *= x;
    }
    return result;
}

/// How far a surfel is from another one's plane, in low-resolution pixels; 0 where that is not
/// known.
inline float distance_from_plane(const Surfel& plane, const Surfel& q) {
    if (plane.inverse_footprint > 0) {
        const glm::vec3 d = q.position - plane.position;
        return std::abs(glm::dot(plane.normal, d)) * plane.inverse_footprint;
    }
    if (plane.inverse_distance > 0) {
        // On a plane the inverse of the distance is linear in the image.
        const glm::vec2 step = q.place - plane.place;
        const float there = plane.inverse_distance + glm::dot(plane.inverse_slope, step);
        return std::abs(q.inverse_distance - there) / plane.inverse_distance *
               kAssumedPixelsPerDistance;
    }
    return 0.0f;
}

/// How surely a pixel's surfel p is of the surface of a low-resolution surfel q, 0 to 1: of the
/// same id, near to its plane, of a like normal. far is added to the distance from the plane.
template <int kNormalPower>
float likeness(const Surfel& q, const Surfel& p, float far = 0.0f) {
    if (p.kind != q.kind || p.id != q.id) return 0.0f;
    if (p.kind == SurfelKind::miss || p.kind == SurfelKind::broken) return 1.0f;
    const float weight = exp_of_negative(-(distance_from_plane(q, p) + far));
    if (p.normal == glm::vec3(0.0f)) return weight;
    return weight * power_of(std::max(glm::dot(p.normal, q.normal), 0.0f), kNormalPower);
}

/// What a guide says of its own pixels.
class GuideView {
  public:
    /// The low-resolution frame's size fixes footprints and places. The guide must outlive it.
    GuideView(const Frame& guide, Extent low);

    [[nodiscard]] Extent size() const { return size_; }
    /// Of coverage 1, without what neighbours tell: footprint, slope, and the normal if the guide
    /// has none. Precondition: inside.
    [[nodiscard]] Surfel sample(int x, int y) const;
    /// Adds that.
    void fill_slopes(Surfel& surfel, int x, int y) const;
    /// What a pixel of the result is compared by: a normal in any case.
    [[nodiscard]] Surfel pixel(int x, int y) const;
    /// Whether misses and emitters are accounted for by the guide's own emission.
    [[nodiscard]] bool knows_emission() const { return !guide_.emission.empty(); }

  private:
    [[nodiscard]] bool is_miss(int x, int y) const;
    [[nodiscard]] bool is_inside(int x, int y) const;
    [[nodiscard]] glm::dvec3 step_between(int x, int y, int dx, int dy) const;
    [[nodiscard]] float inverse_distance(int x, int y) const;
    void fill_geometry(Surfel& surfel, int x, int y) const;
    void fill_colour(Surfel& surfel, int x, int y) const;

    const Frame& guide_;
    Extent size_;
    glm::vec2 low_per_pixel_;
};

/// The surfels of a grid of pixels.
class SurfelGrid {
  public:
    SurfelGrid() = default;
    /// Of pixels that lie over those of a guide.
    SurfelGrid(const GuideView& guide, Extent cells, int threads);
    /// Of pixels of the result, each of which the guide has many samples of.
    static SurfelGrid of_samples(const GuideView& guide, Extent pixels, int threads);
    /// Of low-resolution pixels, from those of the result.
    SurfelGrid(const SurfelGrid& fine, Extent cells, int threads);

    [[nodiscard]] Extent size() const { return size_; }
    [[nodiscard]] std::span<const Surfel> at(int x, int y) const {
        const Row& row = rows_[static_cast<std::size_t>(y)];
        const auto i = static_cast<std::size_t>(x);
        return {row.surfels.data() + row.first[i], row.first[i + 1] - row.first[i]};
    }
    /// The number of the first surfel of a pixel, counted over all of them.
    [[nodiscard]] std::size_t index(int x, int y) const {
        const Row& row = rows_[static_cast<std::size_t>(y)];
        return row.before + row.first[static_cast<std::size_t>(x)];
    }
    [[nodiscard]] std::size_t count() const {
        return rows_.empty() ? 0 : rows_.back().before + rows_.back().surfels.size();
    }

  private:
    struct Row {
        std::size_t before = 0;  ///< surfels in rows above
        std::vector<Surfel> surfels;
        std::vector<std::uint32_t> first;  ///< of each pixel, and one more
    };
    template <class Source>
    void fill(const Source& source, int threads);

    Extent size_;
    std::vector<Row> rows_;
};

}  // namespace vecino
