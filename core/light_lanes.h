// SPDX-License-Identifier: Apache-2.0
//
// Next-event estimation: picking an emitter and a point on it, for VECINO_WIDTH shading points side
// by side. Included only by trace_kernel.cpp, like lanes.h.
#pragma once

#include <cstddef>

#include "core/lanes.h"
#include "core/light_tree_lanes.h"
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

/// W emitters.
struct Emitter {
    Float3 origin, edge1, edge2, normal, radiance;
    Float area, radius, offset, inverse_length1, inverse_length2;
    Mask sphere, triangle, rectangle;
};

/// Emitters picked for W shading points.
struct PickedLight : Emitter {
    Float probability;  ///< of having been picked; 0 where no emitter can be seen
    Float u;            ///< the random number, stretched to [0, 1) again
};

/// Emitters from a reader of the fields of LightRecord: by offset, in floats.
template <class Read>
inline Emitter read_emitter(const Read& read) {
    const auto number = [&](std::size_t bytes) { return read(bytes / sizeof(float)); };
    const auto vector = [&](std::size_t bytes) {
        return Float3{number(bytes), number(bytes + 4), number(bytes + 8)};
    };
    Emitter light;
    light.origin = vector(offsetof(LightRecord, origin));
    light.edge1 = vector(offsetof(LightRecord, edge1));
    light.edge2 = vector(offsetof(LightRecord, edge2));
    light.normal = vector(offsetof(LightRecord, normal));
    light.radiance = vector(offsetof(LightRecord, radiance));
    light.area = number(offsetof(LightRecord, area));
    light.radius = number(offsetof(LightRecord, radius));
    light.offset = number(offsetof(LightRecord, offset_world));
    light.inverse_length1 = number(offsetof(LightRecord, inverse_length));
    light.inverse_length2 = number(offsetof(LightRecord, inverse_length) + 4);
    const Int kind = (Int)number(offsetof(LightRecord, kind));
    light.sphere = kind == static_cast<int>(LightKind::sphere);
    light.triangle = kind == static_cast<int>(LightKind::triangle);
    light.rectangle = kind == static_cast<int>(LightKind::rectangle);
    return light;
}

inline Emitter emitter_at(const TraceTask& task, Int number) {
    const auto* const fields = reinterpret_cast<const float*>(task.lights);
    if (task.light_count == 1) {
        return read_emitter([&](std::size_t place) { return splat(fields[place]); });
    }
    const Int base = record_of(number);
    return read_emitter([&](std::size_t place) { return gather(fields + place, base); });
}

inline std::int32_t pick_index(const TraceTask& task, float u) {
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
    return static_cast<std::int32_t>(low);
}

/// Chooses by power alone with u in [0, 1), which is stretched to [0, 1) again.
inline ChosenLight choose_by_power(const TraceTask& task, Float& u) {
    const auto* const fields = reinterpret_cast<const float*>(task.lights);
    ChosenLight choice;
    for (int i = 0; i < W; ++i) choice.light[i] = pick_index(task, u[i]);
    const Int base = record_of(choice.light);
    choice.probability =
        gather(fields + offsetof(LightRecord, selection_probability) / sizeof(float), base);
    const Float sum = gather(fields + offsetof(LightRecord, selection_cdf) / sizeof(float), base);
    const Float inside = (u - (sum - choice.probability)) / choice.probability;
    u = min(max(inside, splat(0.0f)), splat(0.99999994f));
    return choice;
}

inline Float probability_by_power(const TraceTask& task, Int light) {
    const auto* const fields = reinterpret_cast<const float*>(task.lights);
    const Int base = record_of(light);
    return gather(fields + offsetof(LightRecord, selection_probability) / sizeof(float), base);
}

inline PickedLight pick_light(const TraceTask& task, const Receiver& at, Float u) {
    ChosenLight choice{Int{}, splat(1.0f)};
    if (task.light_count > 1)
        choice =
            task.by_contribution ? choose_by_contribution(task, at, u) : choose_by_power(task, u);
    return {emitter_at(task, choice.light), choice.probability, u};
}

/// A point on an emitter as seen from a shading point.
struct LightPoint {
    Float3 position, normal;
    Float inverse_pdf;  ///< of the solid angle; 0 where the emitter cannot be seen
};

/// Uniform over the area: pdf d^2 / (cos A).
inline LightPoint sample_area(const Emitter& light, Float3 from, Pair u) {
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
inline LightPoint sample_sphere(const Emitter& light, Float3 from, Pair u) {
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
