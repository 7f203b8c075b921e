// SPDX-License-Identifier: Apache-2.0
//
// What a sample of a pixel sees, for W of them side by side: a surface, by way of mirrors, and
// light on it. Included only by trace_kernel.cpp, after what it defines.
#pragma once

#include "core/lanes.h"
#include "core/polygon_lanes.h"
#include "core/record_task.h"
#include "core/surface_lanes.h"

namespace vecino {
namespace {

// Shading normals within 45 degrees of the first belong to the same side of a surface.
constexpr float kSameSide = 0.7f;
// Dimensions of the points on emitters that are looked at one by one: beyond those of any path.
constexpr std::uint32_t kLightDimensions = 0x10000;

inline bool picks_lights(const TraceTask& task) {
    return task.light_count > static_cast<std::uint32_t>(kMostExactLights);
}

/// Of those, whether what is picked is hidden light.
inline bool sums_lights(const TraceTask& task) {
    return picks_lights(task) && task.light_count <= static_cast<std::uint32_t>(kMostSummedLights);
}

struct LightLanes {
    Float exact, open, seen;
};

/// What W samples saw.
struct SampleLanes {
    Surface surface;  ///< by way of mirrors; its albedo is times theirs
    Int object;       ///< stands for it and for them
    Int mirrors;
    Float distance;  ///< from the camera
    Float3 emission;
    Mask looked;  ///< whose light was looked at
    LightLanes lights[kMostExactLights];
    Float3 unshadowed, picked;
};

inline Surface select(Mask m, const Surface& a, const Surface& b) {
    Surface s;
    s.hit = select(m, a.hit, b.hit);
    s.position = select(m, a.position, b.position);
    s.geometric_normal = select(m, a.geometric_normal, b.geometric_normal);
    s.normal = select(m, a.normal, b.normal);
    s.shading_normal = select(m, a.shading_normal, b.shading_normal);
    s.albedo = select(m, a.albedo, b.albedo);
    s.offset = select(m, a.offset, b.offset);
    s.distance = select(m, a.distance, b.distance);
    s.index = select(m, a.index, b.index);
    s.front = select(m, a.front, b.front);
    s.direction = select(m, a.direction, b.direction);
    return s;
}

inline Int object_of(const TraceTask& task, const Surface& s) {
    if (task.surfaces.count == 0) return Int{} - 1;  // an empty table has no column to read
    const auto* const table = reinterpret_cast<const float*>(task.surfaces.object_id);
    return select(s.hit, (Int)gather(table, s.index), Int{} - 1);
}

inline Emitter emitter_number(const TraceTask& task, std::uint32_t number) {
    const auto* const fields = reinterpret_cast<const float*>(task.lights + number);
    return read_emitter([&](std::size_t place) { return splat(fields[place]); });
}

/// Light over pi from one point on an emitter.
inline void look_at_point(Tracer& tracer, const Surface& s, const Emitter& light,
                          const LightPoint& point, Mask asked, LightLanes& out) {
    const Float3 from = ray_origin(s);
    const Ray shadow = {from, point.position + point.normal * light.offset - from};
    const Float distance = sqrt(dot(shadow.direction, shadow.direction));
    const Float cosine = dot(shadow.direction, s.shading_normal) / distance;
    const Mask lit = asked & (point.inverse_pdf > 0.0f) & (cosine > 0.0f);
    const Mask tested = lit & (dot(shadow.direction, s.normal) > 0.0f);
    if (!any(lit)) return;
    out.open = select(lit, cosine * point.inverse_pdf * (1.0f / kPi), Float{});
    if (!any(tested)) return;
    const Mask visible = tested & ~tracer.occluded(shadow, splat(1.0f), tested);
    out.seen = select(visible, out.open, Float{});
}

/// active: samples whose surface can reflect light; asked: those that want a shadow ray.
inline LightLanes look_at_light(Tracer& tracer, const TraceTask& task, const Surface& s,
                                std::uint32_t number, Mask active, Mask asked, Pair random) {
    const Emitter light = emitter_number(task, number);
    const Float3 from = ray_origin(s);
    LightLanes out{};
    out.exact = select(active, exact_irradiance(light, from, s.shading_normal), Float{});
    const Mask facing = asked & (out.exact > 0.0f);
    if (!any(facing)) return out;
    const PickedLight picked{light, splat(1.0f), random.u};
    const LightSample sample = sample_light(task, picked, from, random);
    look_at_point(tracer, s, light, sample.point, facing, out);
    return out;
}

/// Light over pi of all emitters, as if nothing were in between.
inline Float3 unshadowed_light(const TraceTask& task, const Surface& s, Mask active) {
    const Float3 from = ray_origin(s);
    Float3 sum{};
    for (std::uint32_t i = 0; i < task.light_count; ++i) {
        const Emitter light = emitter_number(task, i);
        sum = sum + light.radiance * exact_irradiance(light, from, s.shading_normal);
    }
    return select(active, sum, Float3{});
}

/// Light over pi by one of many emitters: what is hidden of it, or what is seen.
inline Float3 look_at_picked(Tracer& tracer, const TraceTask& task, const Surface& s, Mask active,
                             Pair random) {
    const Float3 from = ray_origin(s);
    const PickedLight light = pick_light(task, {from, s.shading_normal}, random.u);
    const LightSample sample = sample_light(task, light, from, {light.u, random.v});
    LightLanes lanes{};
    look_at_point(tracer, s, light, sample.point, active & (light.probability > 0.0f), lanes);
    const Float share = 1.0f / max(light.probability, splat(1e-30f));
    const Float light_there = sums_lights(task) ? lanes.open - lanes.seen : lanes.seen;
    return light.radiance * (light_there * share);
}

inline Mask reflects(const Surface& s) {
    return s.hit & ((s.albedo.x + s.albedo.y + s.albedo.z) > 0.0f);
}

/// asked(light): samples whose light from that emitter wants a shadow ray.
template <class Asked>
inline void look_at_lights(Tracer& tracer, const TraceTask& task, const PathRandom& random,
                           const Asked& asked, SampleLanes& sample) {
    sample.looked = Mask{};
    sample.unshadowed = sample.picked = Float3{};
    for (LightLanes& light : sample.lights) light = LightLanes{};
    if (task.max_depth < 1) return;
    // Light that has come by mirrors has bounces behind it.
    const Mask active = reflects(sample.surface) & (sample.mirrors < task.max_depth);
    if (!any(active)) return;
    if (picks_lights(task)) {
        sample.looked = active;
        if (sums_lights(task)) sample.unshadowed = unshadowed_light(task, sample.surface, active);
        sample.picked = look_at_picked(tracer, task, sample.surface, active, random.pair(1));
        return;
    }
    for (std::uint32_t i = 0; i < task.light_count; ++i) {
        const Mask wanted = active & asked(static_cast<int>(i));
        const Pair pair = any(wanted) ? random.pair(i == 0 ? 1 : kLightDimensions + i) : Pair{};
        sample.lights[i] = look_at_light(tracer, task, sample.surface, i, active, wanted, pair);
        sample.looked |= wanted;
    }
}

/// A number that tells a surface seen through mirrors from others. Misses stay negative.
inline Int through_mirror(Int mirror, Int object) {
    const Uint mixed = ((Uint)mirror * 0x9E3779B1u) ^ ((Uint)object * 0x85EBCA77u);
    const Int number = (Int)((mixed ^ (mixed >> 15)) & 0x3FFFFFFFu) | 0x40000000;
    return select(object < 0, ~number, number);
}

/// Goes on from mirrors to what they show, as far as the depth of paths allows.
inline void look_through_mirrors(Tracer& tracer, const TraceTask& task, SampleLanes& sample) {
    Float3 shine = {splat(1.0f), splat(1.0f), splat(1.0f)};
    Mask mirror = tracer.mirrors(sample.surface);
    for (int bounce = 0; bounce < task.max_depth && any(mirror); ++bounce) {
        const Surface& s = sample.surface;
        shine = select(mirror, shine * s.albedo, shine);
        const Surface next = tracer.trace({ray_origin(s), mirror_direction(s)}, mirror);
        const Int object = object_of(task, next);
        const Float3 emission = select(next.hit, tracer.emission(next), splat3(task.background));
        sample.object = select(mirror, through_mirror(sample.object, object), sample.object);
        sample.mirrors -= mirror;
        sample.distance =
            select(mirror & next.hit, sample.distance + next.distance, sample.distance);
        sample.emission = select(mirror, shine * emission, sample.emission);
        sample.surface = select(mirror, next, s);
        mirror &= tracer.mirrors(sample.surface);
    }
    sample.surface.albedo = sample.surface.albedo * shine;
    // A mirror that is left reflects what no path may follow.
    sample.surface.albedo = select(mirror, Float3{}, sample.surface.albedo);
}

inline SampleLanes first_look(Tracer& tracer, const TraceTask& task, const Surface& surface,
                              Mask active) {
    SampleLanes sample;
    sample.surface = surface;
    sample.object = object_of(task, surface);
    sample.mirrors = Int{};
    sample.distance = surface.distance;
    sample.emission =
        select(active & ~surface.hit, splat3(task.background), tracer.emission(surface));
    if (task.has_mirrors) look_through_mirrors(tracer, task, sample);
    return sample;
}

inline Float luminance(Float3 v) {
    return 0.2126f * v.x + 0.7152f * v.y + 0.0722f * v.z;
}

inline Float square_of(Float3 v) {
    const Float y = luminance(v);
    return y * y;
}

/// On the side of the surface that a cluster stands for.
inline Mask belongs(const SampleLanes& sample, Int object, Float3 first_normal) {
    const Mask same = dot(sample.surface.shading_normal, first_normal) > kSameSide;
    return (sample.object == object) & ((object < 0) | same);
}

}  // namespace
}  // namespace vecino
