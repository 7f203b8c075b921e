// SPDX-License-Identifier: Apache-2.0
//
// Exact irradiance of emitters that nothing hides but the horizon of the surface itself, for
// VECINO_WIDTH shading points side by side. Included only by trace_kernel.cpp, like lanes.h.
#pragma once

#include "core/lanes.h"
#include "core/light_lanes.h"

namespace vecino {
namespace {

/// The angle between two directions times the cosine between a normal and that of their plane.
inline Float edge_term(Float3 a, Float3 b, Float3 normal) {
    const Float3 across = cross(a, b);
    const Float sine = sqrt(dot(across, across));
    return angle_of(sine, dot(a, b)) * dot(across, normal) / max(sine, splat(1e-30f));
}

/// Irradiance over pi of a polygon of radiance 1 (Lambert 1760), clipped at the horizon. Corners
/// are relative to the surface. Either orientation.
template <int N>
inline Float polygon_irradiance(const Float3 (&corners)[N], Float3 normal) {
    Float heights[N];
    for (int i = 0; i < N; ++i) heights[i] = dot(corners[i], normal);
    Float3 exit{}, entry{};
    Mask crossed{};
    Float sum{};
    for (int i = 0; i < N; ++i) {
        const int next = (i + 1) % N;
        const Mask above = heights[i] > 0.0f;
        const Mask next_above = heights[next] > 0.0f;
        const Mask crosses = above ^ next_above;
        const Float t = select(crosses, heights[i] / (heights[i] - heights[next]), Float{});
        const Float3 crossing = corners[i] + (corners[next] - corners[i]) * t;
        const Float3 from = select(above, corners[i], crossing);
        const Float3 to = select(next_above, corners[next], crossing);
        sum += select(above | next_above, edge_term(from, to, normal), Float{});
        exit = select(crosses & above, crossing, exit);
        entry = select(crosses & next_above, crossing, entry);
        crossed |= crosses;
    }
    // The side along the horizon.
    if (any(crossed)) sum += select(crossed, edge_term(exit, entry, normal), Float{});
    return abs(sum) * (0.5f / kPi);
}

/// cos cos / (pi d^2) of a point on an emitter.
inline Float point_irradiance(Float3 to_point, Float3 light_normal, Float3 normal) {
    const Float per_distance2 = 1.0f / dot(to_point, to_point);
    const Float received = max(dot(to_point, normal), Float{});
    const Float sent = max(-dot(to_point, light_normal), Float{});
    return received * sent * per_distance2 * per_distance2 * (1.0f / kPi);
}

/// Of a small flat emitter, whose exact formula would lose its digits: Gauss's rule.
inline Float small_irradiance(const Emitter& light, Float3 to_origin, Float3 normal) {
    // Parallelograms: 2 x 2 points; triangles: 3 points, each of a third of the weight.
    constexpr float kLow = 0.21132487f, kHigh = 0.78867513f;
    constexpr float kPlaces[4][2] = {{kLow, kLow}, {kHigh, kLow}, {kLow, kHigh}, {kHigh, kHigh}};
    constexpr float kTriangle[4][2] = {
        {1.0f / 6, 1.0f / 6}, {2.0f / 3, 1.0f / 6}, {1.0f / 6, 2.0f / 3}, {0.0f, 0.0f}};
    constexpr float kWeights[4] = {1.0f / 3, 1.0f / 3, 1.0f / 3, 0.0f};
    Float sum{};
    for (int i = 0; i < 4; ++i) {
        const Float a = select(light.triangle, splat(kTriangle[i][0]), splat(kPlaces[i][0]));
        const Float b = select(light.triangle, splat(kTriangle[i][1]), splat(kPlaces[i][1]));
        const Float weight = select(light.triangle, splat(kWeights[i]), splat(0.25f));
        const Float3 to_point = to_origin + light.edge1 * a + light.edge2 * b;
        sum += weight * point_irradiance(to_point, light.normal, normal);
    }
    return sum * light.area;
}

inline Float flat_irradiance(const Emitter& light, Float3 from, Float3 normal) {
    constexpr float kSmall = 1e-2f;  // about a solid angle, in steradians
    const Float3 to_origin = light.origin - from;
    const Float height = -dot(to_origin, light.normal);
    const Float middle = select(light.triangle, splat(1.0f / 3.0f), splat(0.5f));
    const Float3 to_middle = to_origin + (light.edge1 + light.edge2) * middle;
    const Float distance2 = dot(to_middle, to_middle);
    const Mask sends = height > 0.0f;
    const Mask small = (light.area * height < kSmall * distance2 * sqrt(distance2)) &
                       (light.area * kSmall * 16.0f < distance2);
    Float value{};
    if (any(sends & small)) value = small_irradiance(light, to_origin, normal);
    if (any(sends & ~small)) {
        const Float3 far = select(light.triangle, light.edge2, light.edge1 + light.edge2);
        // A triangle is a quad whose last corner stands on its third.
        const Float3 corners[4] = {to_origin, to_origin + light.edge1, to_origin + far,
                                   to_origin + light.edge2};
        value = select(small, value, polygon_irradiance(corners, normal));
    }
    return select(sends, value, Float{});
}

/// Of a sphere, from outside: its cone in full, or cut by the horizon.
inline Float sphere_irradiance(const Emitter& light, Float3 from, Float3 normal) {
    const Float3 to_center = light.origin - from;
    const Float distance2 = dot(to_center, to_center);
    const Float sine2 = min(light.radius * light.radius / distance2, splat(1.0f));
    const Mask outside = light.radius * light.radius < distance2;
    const Float cosine = dot(to_center, normal) / sqrt(distance2);
    const Float sine_of_cosine = sqrt(max(1.0f - cosine * cosine, splat(1e-20f)));
    const Mask full = cosine * cosine > sine2;
    const Float whole = max(cosine, Float{}) * sine2;
    const Float x = sqrt(max(1.0f / max(sine2, splat(1e-20f)) - 1.0f, splat(0.0f)));
    const Float y = min(max(-x * cosine / sine_of_cosine, splat(-1.0f)), splat(1.0f));
    const Float root = sqrt(max(1.0f - y * y, splat(0.0f)));
    const Float sine_y = sine_of_cosine * root;
    const Float part =
        ((cosine * angle_of(root, y) - x * sine_y) * sine2 + angle_of(sine_y, x)) * (1.0f / kPi);
    return select(outside, select(full, whole, max(part, Float{})), Float{});
}

/// Irradiance over pi of emitters of radiance 1 that nothing hides.
inline Float exact_irradiance(const Emitter& light, Float3 from, Float3 normal) {
    Float value{};
    if (any(~light.sphere)) value = flat_irradiance(light, from, normal);
    if (any(light.sphere))
        value = select(light.sphere, sphere_irradiance(light, from, normal), value);
    return value;
}

}  // namespace
}  // namespace vecino
