// SPDX-License-Identifier: Apache-2.0
#include "core/packet_shapes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "core/clones.h"

namespace vecino {
namespace {

constexpr unsigned kMaxPacket = 16;
// Rows of a packet; origins are the first.
constexpr unsigned kNear = 3;
constexpr unsigned kDirection = 4;
constexpr unsigned kFar = 8;

void put(float (&to)[3], const glm::dvec3& from) {
    for (int k = 0; k < 3; ++k) to[k] = static_cast<float>(from[k]);
}

/// The rows of a packet that a test reads.
struct Rays {
    const float* origin;
    const float* t_near;
    const float* direction;
    const float* t_far;
};

VECINO_INLINE float dot(const float* a, const float* rows, unsigned i, unsigned n) {
    return a[0] * rows[i] + a[1] * rows[i + n] + a[2] * rows[i + 2 * n];
}

// The distance at which ray i of n hits, in (t_near, t_far); t_far where it does not. The
// discriminant is taken from the distance of the centre to the ray, which keeps its digits when the
// sphere is far away (Haines et al., Ray Tracing Gems, chapter 7).
VECINO_INLINE float nearest_hit(const SphereShape& sphere, const Rays& rays, unsigned i,
                                unsigned n) {
    const float fx = sphere.center[0] - rays.origin[i];
    const float fy = sphere.center[1] - rays.origin[i + n];
    const float fz = sphere.center[2] - rays.origin[i + 2 * n];
    const float dx = rays.direction[i];
    const float dy = rays.direction[i + n];
    const float dz = rays.direction[i + 2 * n];
    const float a = dx * dx + dy * dy + dz * dz;
    const float along = fx * dx + fy * dy + fz * dz;
    const float closest = along / a;
    const float ex = fx - closest * dx;
    const float ey = fy - closest * dy;
    const float ez = fz - closest * dz;
    const float rr = sphere.radius * sphere.radius;
    const float discriminant = rr - (ex * ex + ey * ey + ez * ez);
    const float root = std::sqrt(a * (discriminant > 0.0f ? discriminant : 0.0f));
    const float q = along + (along < 0.0f ? -root : root);
    const float c = fx * fx + fy * fy + fz * fz - rr;
    const float s = c / q;
    const float t = q / a;
    const float first = s < t ? s : t;
    const float second = s < t ? t : s;
    const float hit = first > rays.t_near[i] ? first : second;
    const bool is_hit = (hit > rays.t_near[i]) & (hit < rays.t_far[i]) & (discriminant > 0.0f);
    return is_hit ? hit : rays.t_far[i];
}

VECINO_INLINE float nearest_hit(const ParallelogramShape& shape, const Rays& rays, unsigned i,
                                unsigned n) {
    // A ray along the plane has no t, or an infinite one.
    const float t = (shape.height - dot(shape.normal, rays.origin, i, n)) /
                    dot(shape.normal, rays.direction, i, n);
    const float u = dot(shape.u, rays.origin, i, n) + t * dot(shape.u, rays.direction, i, n);
    const float v = dot(shape.v, rays.origin, i, n) + t * dot(shape.v, rays.direction, i, n);
    const bool is_hit = (u >= shape.u_least) & (u <= shape.u_most) & (v >= shape.v_least) &
                        (v <= shape.v_most) & (t > rays.t_near[i]) & (t < rays.t_far[i]);
    return is_hit ? t : rays.t_far[i];
}

template <class Shape>
VECINO_INLINE void nearest_hits(const Shape& shape, const RayRows& rays, unsigned n,
                                float* __restrict nearest) {
    const float* const rows = rays.rows;
    const Rays read{rows, rows + kNear * n, rows + kDirection * n, rows + kFar * n};
    for (unsigned i = 0; i < n; ++i) nearest[i] = nearest_hit(shape, read, i, n);
}

// Two loops each: in one, the compiler takes the writes for branches.
template <class Shape>
VECINO_INLINE void intersect_rays(const Shape& shape, const RayRows& rays, const HitRows& hits,
                                  unsigned n) {
    float nearest[kMaxPacket];
    nearest_hits(shape, rays, n, nearest);
    float* __restrict t_far = rays.rows + kFar * n;
    unsigned* __restrict primitive = hits.primitive;
    unsigned* __restrict geometry = hits.geometry;
    const int* __restrict valid = rays.valid;
    const unsigned primitive_id = hits.primitive_id;
    const unsigned geometry_id = hits.geometry_id;
    for (unsigned i = 0; i < n; ++i) {
        const bool is_nearer = (valid[i] != 0) & (nearest[i] < t_far[i]);
        primitive[i] = is_nearer ? primitive_id : primitive[i];
        geometry[i] = is_nearer ? geometry_id : geometry[i];
        t_far[i] = is_nearer ? nearest[i] : t_far[i];
    }
}

template <class Shape>
VECINO_INLINE void occlude_rays(const Shape& shape, const RayRows& rays, unsigned n) {
    float nearest[kMaxPacket];
    nearest_hits(shape, rays, n, nearest);
    float* __restrict t_far = rays.rows + kFar * n;
    const int* __restrict valid = rays.valid;
    for (unsigned i = 0; i < n; ++i) {
        const bool is_blocked = (valid[i] != 0) & (nearest[i] < t_far[i]);
        t_far[i] = is_blocked ? -std::numeric_limits<float>::infinity() : t_far[i];
    }
}

}  // namespace

ParallelogramShape parallelogram_shape(const std::array<glm::vec3, 4>& corners_world) {
    const glm::dvec3 origin = corners_world[0];
    const glm::dvec3 edge1 = glm::dvec3(corners_world[1]) - origin;
    const glm::dvec3 edge2 = glm::dvec3(corners_world[3]) - origin;
    const glm::dvec3 cross = glm::cross(edge1, edge2);
    const glm::dvec3 normal = glm::normalize(cross);
    const glm::dvec3 u = glm::cross(edge2, cross) / glm::dot(cross, cross);
    const glm::dvec3 v = glm::cross(cross, edge1) / glm::dot(cross, cross);
    float reach = 0;
    ParallelogramShape shape;
    for (int k = 0; k < 3; ++k) {
        const auto [low, high] = std::minmax(
            {corners_world[0][k], corners_world[1][k], corners_world[2][k], corners_world[3][k]});
        shape.lower[k] = low;
        shape.upper[k] = high;
        reach = std::max({reach, std::abs(low), std::abs(high)});
    }
    // Some 8 units in the last place of the coordinates, which a hit is off by.
    const float rounding = 0x1p-21f * reach;
    for (int k = 0; k < 3; ++k) {
        shape.lower[k] -= 2.0f * rounding;
        shape.upper[k] += 2.0f * rounding;
    }
    put(shape.normal, normal);
    put(shape.u, u);
    put(shape.v, v);
    shape.height = static_cast<float>(glm::dot(normal, origin));
    const double u_slack = static_cast<double>(rounding) * glm::length(u);
    const double v_slack = static_cast<double>(rounding) * glm::length(v);
    shape.u_least = static_cast<float>(glm::dot(u, origin) - u_slack);
    shape.u_most = static_cast<float>(glm::dot(u, origin) + 1.0 + u_slack);
    shape.v_least = static_cast<float>(glm::dot(v, origin) - v_slack);
    shape.v_most = static_cast<float>(glm::dot(v, origin) + 1.0 + v_slack);
    return shape;
}

// With the constant number of rays that packets have, a loop is one vector instruction after the
// other. No lambda: it would not be compiled for the instruction set of the clone.
#define VECINO_FOR_WIDTH(n, call)           \
    switch (n) {                            \
        case 16: {                          \
            constexpr unsigned kWidth = 16; \
            return call;                    \
        }                                   \
        case 8: {                           \
            constexpr unsigned kWidth = 8;  \
            return call;                    \
        }                                   \
        default: {                          \
            const unsigned kWidth = n;      \
            return call;                    \
        }                                   \
    }
#define VECINO_SHAPE(Shape)                                                                     \
    VECINO_CLONES void intersect(const Shape& shape, const RayRows& rays, const HitRows& hits){ \
        VECINO_FOR_WIDTH(rays.n, intersect_rays(shape, rays, hits, kWidth))} VECINO_CLONES void \
    occlude(const Shape& shape, const RayRows& rays) {                                          \
        VECINO_FOR_WIDTH(rays.n, occlude_rays(shape, rays, kWidth))                             \
    }
VECINO_SHAPE(SphereShape)
VECINO_SHAPE(ParallelogramShape)

}  // namespace vecino
