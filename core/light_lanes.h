// SPDX-License-Identifier: Apache-2.0
//
// Next-event estimation: picking an emitter and a point on it, for VECINO_WIDTH shading points side
// by side. Included only by trace_kernel.cpp, like lanes.h.
#pragma once

#include "core/lanes.h"
#include "core/random_lanes.h"
#include "core/rectangle_lanes.h"
#include "core/trace_task.h"

namespace vecino {
namespace {

/// Two unit vectors that make a right-handed basis with a third (Duff et al., JCGT 2017).
struct Basis {
    Float3 tangent, bitangent;
};
inline Basis basis_around(Float3 n) {
    const Float sign = copysign(1.0f, n.z);
    const Float a = -1.0f / (sign + n.z);
    const Float b = n.x * n.y * a;
    return {{1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

/// Emitters picked for W shading points.
struct PickedLight {
    Float3 origin, edge1, edge2, normal, radiance;
    Float area, radius, offset, probability;
    Mask sphere, triangle, rectangle;
    Float u;  ///< the random number, stretched to [0, 1) again
};

inline std::uint32_t pick_index(const TraceTask& task, float u) {
    std::uint32_t low = 0;
    std::uint32_t high = task.light_count - 1;
    while (low < high) {
        const std::uint32_t middle = (low + high) / 2;
        if (u < task.lights[middle].selection_cdf) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    return low;
}

inline PickedLight pick_light(const TraceTask& task, Float u) {
    constexpr int kFields = 19;  // origin to selection_probability
    alignas(64) float gathered[kFields][W];
    alignas(64) std::int32_t sphere[W];
    alignas(64) std::int32_t triangle[W];
    alignas(64) std::int32_t rectangle[W];
    alignas(64) float stretched[W];
    for (int i = 0; i < W; ++i) {
        const LightRecord& light = task.lights[task.light_count > 1 ? pick_index(task, u[i]) : 0];
        float fields[kFields];
        __builtin_memcpy(fields, &light.origin, sizeof fields);
        for (int k = 0; k < kFields; ++k) gathered[k][i] = fields[k];
        sphere[i] = light.kind == LightKind::sphere ? -1 : 0;
        triangle[i] = light.kind == LightKind::triangle ? -1 : 0;
        rectangle[i] = light.kind == LightKind::rectangle ? -1 : 0;
        const float p = light.selection_probability;
        const float inside = (u[i] - (light.selection_cdf - p)) / p;
        stretched[i] = inside < 0.0f ? 0.0f : inside > 0.99999994f ? 0.99999994f : inside;
    }
    const auto vector = [&](int k) {
        return Float3{load<Float>(gathered[k]), load<Float>(gathered[k + 1]),
                      load<Float>(gathered[k + 2])};
    };
    return {vector(0),
            vector(3),
            vector(6),
            vector(9),
            vector(12),
            load<Float>(gathered[15]),
            load<Float>(gathered[16]),
            load<Float>(gathered[17]),
            load<Float>(gathered[18]),
            load<Mask>(sphere),
            load<Mask>(triangle),
            load<Mask>(rectangle),
            load<Float>(stretched)};
}

/// A point on an emitter as seen from a shading point.
struct LightPoint {
    Float3 position, normal;
    Float inverse_pdf;  ///< of the solid angle; 0 where the emitter cannot be seen
};

/// Uniform over the area: pdf d^2 / (cos A).
inline LightPoint sample_area(const PickedLight& light, Float3 from, Pair u) {
    const Mask fold = light.triangle & (u.u + u.v > 1.0f);
    const Float a = select(fold, 1.0f - u.u, u.u);
    const Float b = select(fold, 1.0f - u.v, u.v);
    LightPoint point;
    point.position = light.origin + light.edge1 * a + light.edge2 * b;
    point.normal = light.normal;
    const Float3 to_light = point.position - from;
    const Float distance2 = dot(to_light, to_light);
    const Float cosine = -dot(to_light, point.normal) / sqrt(distance2);
    point.inverse_pdf = select(cosine > 0.0f, cosine * light.area / distance2, splat(0.0f));
    return point;
}

/// Uniform over the cone that a sphere fills (Shirley et al. 1996): pdf 1 / (2 pi (1 - cos)).
inline LightPoint sample_sphere(const PickedLight& light, Float3 from, Pair u) {
    const Float3 to_center = light.origin - from;
    const Float distance2 = dot(to_center, to_center);
    const Float distance = sqrt(distance2);
    const Float sine2_max = light.radius * light.radius / distance2;
    const Mask outside = sine2_max < 1.0f;
    const Float cosine_max = sqrt(max(1.0f - sine2_max, splat(0.0f)));
    // 1 - cos without cancellation for small spheres
    const Float height_max = sine2_max / (1.0f + cosine_max);
    const Float height = u.u * height_max;
    const Float sine2 = height * (2.0f - height);
    const Float cosine = 1.0f - height;
    const Float t =
        distance * cosine - sqrt(max(light.radius * light.radius - distance2 * sine2, splat(0.0f)));
    Float sin_phi, cos_phi;
    sincos_turns(u.v, sin_phi, cos_phi);
    const Float3 axis = to_center * (1.0f / distance);
    const Basis basis = basis_around(axis);
    const Float sine = sqrt(max(sine2, splat(0.0f)));
    const Float3 direction =
        basis.tangent * (sine * cos_phi) + basis.bitangent * (sine * sin_phi) + axis * cosine;
    LightPoint point;
    point.normal = normalise(from + direction * t - light.origin);
    point.position = light.origin + point.normal * light.radius;
    point.inverse_pdf = select(outside, 2.0f * kPi * height_max, splat(0.0f));
    return point;
}

}  // namespace
}  // namespace vecino
