// SPDX-License-Identifier: Apache-2.0
#include "core/overlays.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace vecino {
namespace {

using Corners = std::array<glm::vec3, 4>;

// Some 8 units in the last place of the coordinates.
constexpr float kRounding = 0x1p-21f;

// Of a packet, as RayRows lays them out.
constexpr unsigned kMostRays = 16;
constexpr unsigned kFarRow = 8;

// To the next distance or the one after it; infinity stays what it is.
constexpr float kNextDistance = 1.0f + 0x1p-23f;

struct Box {
    glm::vec3 lower, upper;
    float reach;  ///< the largest coordinate
};

Box box_of(const Corners& corners) {
    Box box{corners[0], corners[0], 0};
    for (const glm::vec3& corner : corners) {
        for (int k = 0; k < 3; ++k) {
            box.lower[k] = std::min(box.lower[k], corner[k]);
            box.upper[k] = std::max(box.upper[k], corner[k]);
            box.reach = std::max(box.reach, std::abs(corner[k]));
        }
    }
    return box;
}

/// Neighbours that share an edge do not cover each other.
bool cover(const Box& a, const Box& b, float rounding) {
    for (int k = 0; k < 3; ++k) {
        const float shared = std::min(a.upper[k], b.upper[k]) - std::max(a.lower[k], b.lower[k]);
        const bool is_flat = a.upper[k] - a.lower[k] <= 4 * rounding;
        if (shared < (is_flat ? -rounding : 4 * rounding)) return false;
    }
    return true;
}

bool lies_in_plane(const ParallelogramShape& plane, const Corners& corners, float rounding) {
    const glm::dvec3 normal(plane.normal[0], plane.normal[1], plane.normal[2]);
    return std::ranges::all_of(corners, [&](const glm::vec3& corner) {
        const double height = glm::dot(normal, glm::dvec3(corner)) - double{plane.height};
        return std::abs(height) <= double{rounding};
    });
}

/// Its own side stays its front.
void put_into_plane(const ParallelogramShape& plane, ParallelogramShape& shape) {
    float cosine = 0;
    for (int k = 0; k < 3; ++k) cosine += plane.normal[k] * shape.normal[k];
    const float sign = cosine < 0 ? -1.0f : 1.0f;
    for (int k = 0; k < 3; ++k) shape.normal[k] = sign * plane.normal[k];
    shape.height = sign * plane.height;
}

}  // namespace

std::vector<std::vector<unsigned>> find_overlays(std::span<const Corners> corners_world,
                                                 std::span<ParallelogramShape> shapes) {
    std::vector<Box> boxes;
    std::ranges::transform(corners_world, std::back_inserter(boxes), box_of);
    std::vector<std::vector<unsigned>> overlays(shapes.size());
    bool any = false;
    for (std::size_t below = 0; below < shapes.size(); ++below) {
        for (std::size_t above = below + 1; above < shapes.size(); ++above) {
            const float rounding = kRounding * std::max(boxes[below].reach, boxes[above].reach);
            if (!cover(boxes[below], boxes[above], rounding) ||
                !lies_in_plane(shapes[below], corners_world[above], rounding))
                continue;
            put_into_plane(shapes[below], shapes[above]);
            overlays[below].push_back(static_cast<unsigned>(above));
            any = true;
        }
    }
    return any ? overlays : std::vector<std::vector<unsigned>>();
}

void intersect_overlay(const ParallelogramShape& shape, const RayRows& rays, const HitRows& hits) {
    float* const t_far = rays.rows + kFarRow * rays.n;
    float before[kMostRays];
    float farther[kMostRays];
    for (unsigned i = 0; i < rays.n; ++i) {
        before[i] = t_far[i];
        farther[i] = t_far[i] = t_far[i] * kNextDistance;
    }
    intersect(shape, rays, hits);
    for (unsigned i = 0; i < rays.n; ++i)
        t_far[i] = t_far[i] < farther[i] ? std::min(t_far[i], before[i]) : before[i];
}

}  // namespace vecino
