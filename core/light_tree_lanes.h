// SPDX-License-Identifier: Apache-2.0
//
// Choosing an emitter by what it may contribute, for VECINO_WIDTH shading points side by side: from
// the root of the tree (core/light_tree.h) down, at each node to one of its children in proportion
// to a bound of its light. Included only by trace_kernel.cpp, like lanes.h.
#pragma once

#include <cstddef>

#include "core/lanes.h"
#include "core/trace_task.h"

namespace vecino {
namespace {

/// Where light is gathered.
struct Receiver {
    Float3 position, normal;
};

/// Where emitters' records begin, in floats.
inline Int record_of(Int emitter) {
    return emitter * static_cast<int>(sizeof(LightRecord) / sizeof(float));
}

/// An angle in [0, pi].
struct Angle {
    Float cosine, sine;
};

/// max(a - b, 0)
inline Angle less(Angle a, Angle b) {
    const Mask within = a.cosine > b.cosine;
    return {select(within, splat(1.0f), a.cosine * b.cosine + a.sine * b.sine),
            select(within, splat(0.0f), a.sine * b.cosine - a.cosine * b.sine)};
}

inline Angle angle_between(Float cosine) {
    return {cosine, sqrt(max(1.0f - cosine * cosine, splat(0.0f)))};
}

inline Float light_node(const TraceTask& task, int field, Int node) {
    const LightTree& tree = task.light_tree;
    return lookup(tree.fields + static_cast<std::size_t>(field) * tree.stride, tree.count, node);
}
inline Float3 light_node3(const TraceTask& task, int field, Int node) {
    return {light_node(task, field, node), light_node(task, field + 1, node),
            light_node(task, field + 2, node)};
}

/// Power / d^2 times the largest cosines that the node's sphere and cone allow at both ends; 0 only
/// where none of its emitters can be seen.
inline Float importance(const TraceTask& task, const Receiver& at, Int node) {
    const Float3 to_center = light_node3(task, kLightNodeCenter, node) - at.position;
    const Float radius2 = light_node(task, kLightNodeRadius2, node);
    const Float distance2 = dot(to_center, to_center);
    const Mask outside = distance2 > radius2;
    const Float per_distance = 1.0f / sqrt(max(distance2, splat(1e-30f)));
    const Float sine = sqrt(radius2) * per_distance;
    const Angle sphere = {sqrt(max(1.0f - sine * sine, splat(0.0f))), sine};
    const Angle received = angle_between(dot(to_center, at.normal) * per_distance);
    const Angle off_axis =
        angle_between(-dot(to_center, light_node3(task, kLightNodeAxis, node)) * per_distance);
    const Angle cone = {light_node(task, kLightNodeCosine, node),
                        light_node(task, kLightNodeSine, node)};
    const Float cosines = max(less(received, sphere).cosine, splat(0.0f)) *
                          max(less(less(off_axis, cone), sphere).cosine, splat(0.0f));
    return light_node(task, kLightNodePower, node) * select(outside, cosines, splat(1.0f)) /
           max(distance2, radius2);
}

/// Close enough to emitters for the noise of points by area to be worth another ray: within some
/// radii of the sphere around all of them.
inline Mask is_near_emitters(const TraceTask& task, Float3 position) {
    constexpr float kRadii = 2.0f;
    const Float3 to_center = light_node3(task, kLightNodeCenter, Int{}) - position;
    const Float radius2 = light_node(task, kLightNodeRadius2, Int{});
    return dot(to_center, to_center) < kRadii * kRadii * radius2;
}

/// Emitters at the ends of W ways down the tree.
struct ChosenLight {
    Int light;
    Float probability;  ///< 0 where no emitter can be seen
};

/// take_first(first, both): in which lanes to go on to the first child, whose importance is given
/// beside that of both children.
template <class TakeFirst>
inline ChosenLight walk_light_tree(const TraceTask& task, const Receiver& at,
                                   const TakeFirst& take_first) {
    Int node{};
    ChosenLight choice{Int{}, splat(1.0f)};
    for (;;) {
        const Int next = (Int)light_node(task, kLightNodeNext, node);
        const Mask inner = next > 0;
        choice.light = ~next;
        if (!any(inner)) return choice;
        const Int second = select(inner, next, node);
        const Int first = select(inner, node + 1, node);
        const Float of_first = importance(task, at, first);
        const Float of_second = importance(task, at, second);
        const Float both = of_first + of_second;
        const Mask is_first = take_first(of_first, both, inner);
        const Float taken = select(is_first, of_first, of_second);
        const Float share = select(taken > 0.0f, taken / both, splat(0.0f));
        choice.probability = select(inner, choice.probability * share, choice.probability);
        node = select(is_first, first, second);
    }
}

/// Chooses with u in [0, 1), which is stretched to [0, 1) again.
inline ChosenLight choose_by_contribution(const TraceTask& task, const Receiver& at, Float& u) {
    return walk_light_tree(task, at, [&](Float first, Float both, Mask inner) -> Mask {
        const Float second = both - first;
        const Float place = u * both;
        const Mask is_first = (second <= 0.0f) | (place < first);
        const Float inside = select(is_first, place / first, (place - first) / second);
        const Float stretched = min(max(inside, splat(0.0f)), splat(0.99999994f));
        u = select(inner & (both > 0.0f), stretched, u);
        return is_first;
    });
}

/// With what probability an emitter is chosen.
inline Float probability_by_contribution(const TraceTask& task, const Receiver& at, Int light) {
    const auto* const trails = reinterpret_cast<const float*>(task.lights);
    Uint trail =
        (Uint)gather(trails + offsetof(LightRecord, trail) / sizeof(float), record_of(light));
    const ChosenLight choice = walk_light_tree(task, at, [&](Float, Float, Mask) -> Mask {
        const Mask is_first = (trail & 1u) == 0u;
        trail >>= 1;
        return is_first;
    });
    return choice.probability;
}

}  // namespace
}  // namespace vecino
