// SPDX-License-Identifier: Apache-2.0
//
// Sums of what the samples of pixels see, surface by surface: the kernel behind the first samples
// of the method surface_records. Included only by trace_kernel.cpp, after what it defines.
#pragma once

#include "core/sample_lanes.h"

namespace vecino {
namespace {

// ---------------------------------------------------------------- sums of single samples

inline void put_lane(float (&to)[3], const Float3& v, int lane) {
    to[0] = v.x[lane];
    to[1] = v.y[lane];
    to[2] = v.z[lane];
}

/// A cluster without samples, for surfaces like that of a sample.
inline Cluster empty_cluster(const SampleLanes& sample, int lane, std::uint32_t number) {
    Cluster cluster{};
    cluster.object = sample.object[lane];
    cluster.surface = cluster.object < 0 ? -1 : sample.surface.index[lane];
    cluster.first_sample = number;
    cluster.mirrors = sample.mirrors[lane];
    if (cluster.object >= 0) put_lane(cluster.first_normal, sample.surface.shading_normal, lane);
    return cluster;
}

/// Sums of the lanes in a mask, halves first.
inline float sum_of(Float v, Mask mask) {
    alignas(sizeof(Float)) float kept[W];
    store(kept, select(mask, v, Float{}));
    for (int half = W / 2; half > 0; half /= 2) {
        for (int i = 0; i < half; ++i) kept[i] += kept[i + half];
    }
    return kept[0];
}
inline void add(float (&to)[3], const Float3& v, Mask mask) {
    to[0] += sum_of(v.x, mask);
    to[1] += sum_of(v.y, mask);
    to[2] += sum_of(v.z, mask);
}

/// Adds the samples of a mask to a cluster.
inline void add_to_cluster(const TraceTask& task, const SampleLanes& sample, Mask mask,
                           Cluster& cluster) {
    cluster.count += static_cast<float>(count(mask));
    cluster.shadow_count += static_cast<float>(count(mask & sample.looked));
    add(cluster.emission, sample.emission, mask);
    if (cluster.object < 0) return;
    add(cluster.position, sample.surface.position, mask);
    add(cluster.normal, sample.surface.shading_normal, mask);
    add(cluster.albedo, sample.surface.albedo, mask);
    if (picks_lights(task)) {
        add(cluster.unshadowed, sample.unshadowed, mask);
        add(cluster.picked, sample.picked, mask);
        cluster.picked_square += sum_of(square_of(sample.picked), mask);
        return;
    }
    for (std::uint32_t i = 0; i < task.light_count; ++i) {
        LightSums& sums = cluster.lights[i];
        sums.exact += sum_of(sample.lights[i].exact, mask);
        sums.open += sum_of(sample.lights[i].open, mask);
        sums.seen += sum_of(sample.lights[i].seen, mask);
    }
}

inline void add_lane(float (&to)[3], const Float3& v, int lane) {
    to[0] += v.x[lane];
    to[1] += v.y[lane];
    to[2] += v.z[lane];
}

/// Adds one sample to a cluster.
inline void add_to_cluster(const TraceTask& task, const SampleLanes& sample, int lane,
                           Cluster& cluster) {
    cluster.count += 1;
    if (sample.looked[lane] != 0) cluster.shadow_count += 1;
    add_lane(cluster.emission, sample.emission, lane);
    if (cluster.object < 0) return;
    add_lane(cluster.position, sample.surface.position, lane);
    add_lane(cluster.normal, sample.surface.shading_normal, lane);
    add_lane(cluster.albedo, sample.surface.albedo, lane);
    if (picks_lights(task)) {
        add_lane(cluster.unshadowed, sample.unshadowed, lane);
        add_lane(cluster.picked, sample.picked, lane);
        cluster.picked_square += square_of(sample.picked)[lane];
        return;
    }
    for (std::uint32_t i = 0; i < task.light_count; ++i) {
        LightSums& sums = cluster.lights[i];
        sums.exact += sample.lights[i].exact[lane];
        sums.open += sample.lights[i].open[lane];
        sums.seen += sample.lights[i].seen[lane];
    }
}

/// Whether one sample is of a cluster.
inline bool belongs(const SampleLanes& sample, int lane, const Cluster& cluster) {
    if (sample.object[lane] != cluster.object) return false;
    const Float3& normal = sample.surface.shading_normal;
    const float cosine = normal.x[lane] * cluster.first_normal[0] +
                         normal.y[lane] * cluster.first_normal[1] +
                         normal.z[lane] * cluster.first_normal[2];
    return cluster.object < 0 || cosine > kSameSide;
}

// ---------------------------------------------------------------- first samples of many pixels

/// Sums of the samples of W pixels, each of its first surface.
struct PilotLanes {
    Int object{}, surface{}, mirrors{};
    Float3 first_normal{}, position{}, normal{}, albedo{}, emission{}, unshadowed{}, picked{};
    Float count{}, shadow_count{}, picked_square{};
    LightLanes lights[kMostExactLights]{};
};

inline void add(PilotLanes& sums, const TraceTask& task, const SampleLanes& sample, Mask mask) {
    const auto add3 = [mask](Float3& to, const Float3& v) { to = to + select(mask, v, Float3{}); };
    sums.count += select(mask, splat(1.0f), Float{});
    sums.shadow_count += select(mask & sample.looked, splat(1.0f), Float{});
    add3(sums.position, sample.surface.position);
    add3(sums.normal, sample.surface.shading_normal);
    add3(sums.albedo, sample.surface.albedo);
    add3(sums.emission, sample.emission);
    if (picks_lights(task)) {
        add3(sums.unshadowed, sample.unshadowed);
        add3(sums.picked, sample.picked);
        sums.picked_square += select(mask, square_of(sample.picked), Float{});
        return;
    }
    for (std::uint32_t i = 0; i < task.light_count; ++i) {
        sums.lights[i].exact += select(mask, sample.lights[i].exact, Float{});
        sums.lights[i].open += select(mask, sample.lights[i].open, Float{});
        sums.lights[i].seen += select(mask, sample.lights[i].seen, Float{});
    }
}

inline void store(float (&to)[3][kPilotPixels], int at, const Float3& v) {
    store(to[0] + at, v.x);
    store(to[1] + at, v.y);
    store(to[2] + at, v.z);
}

inline void store(const PilotOutput& out, int at, const TraceTask& task, const PilotLanes& sums) {
    PilotBlock& block = out.block;
    store(block.object + at, sums.object);
    store(block.surface + at, sums.surface);
    store(block.mirrors + at, sums.mirrors);
    store(block.count + at, sums.count);
    store(block.shadow_count + at, sums.shadow_count);
    store(block.first_normal, at, sums.first_normal);
    store(block.position, at, sums.position);
    store(block.normal, at, sums.normal);
    store(block.albedo, at, sums.albedo);
    store(block.emission, at, sums.emission);
    PilotLight* const lights = out.lights;
    if (picks_lights(task)) {
        store(lights[0].exact + at, sums.picked.x);
        store(lights[0].open + at, sums.picked.y);
        store(lights[0].seen + at, sums.picked.z);
        store(lights[1].exact + at, sums.picked_square);
        store(lights[2].exact + at, sums.unshadowed.x);
        store(lights[2].open + at, sums.unshadowed.y);
        store(lights[2].seen + at, sums.unshadowed.z);
        return;
    }
    for (std::uint32_t i = 0; i < task.light_count; ++i) {
        store(lights[i].exact + at, sums.lights[i].exact);
        store(lights[i].open + at, sums.lights[i].open);
        store(lights[i].seen + at, sums.lights[i].seen);
    }
}

/// Counts one sample to another surface of its pixel than the first.
inline void spill_lane(const TraceTask& task, const SampleLanes& sample, int lane, int pixel,
                       std::uint32_t number, PilotSpill& spill) {
    int of_pixel = 0;
    for (int i = 0; i < spill.count; ++i) {
        if (spill.pixel[i] != pixel) continue;
        if (belongs(sample, lane, spill.clusters[i])) {
            add_to_cluster(task, sample, lane, spill.clusters[i]);
            return;
        }
        ++of_pixel;
    }
    if (of_pixel == kMostClusters - 1 || spill.count == kMostSpills) {
        spill.crowded[pixel] = true;
        return;
    }
    spill.pixel[spill.count] = pixel;
    spill.clusters[spill.count] = empty_cluster(sample, lane, number);
    add_to_cluster(task, sample, lane, spill.clusters[spill.count++]);
}

inline void pilot_packet(Tracer& tracer, const TraceTask& task, const PilotRange& range, int at,
                         const PilotOutput& out) {
    const Int lane = lane_numbers() + at;
    const Mask active = lane < range.count;
    const Int x = lane + range.x;
    const Uint pixel = (Uint)(x + range.y * task.width);
    PilotLanes sums;
    for (int number = 0; number < range.samples; ++number) {
        const auto sample_number = static_cast<std::uint32_t>(number);
        const PathRandom random(task, pixel, splat(sample_number));
        const Pair jitter = random.pair(0);
        const Ray ray = tracer.primary_ray(jitter.u + __builtin_convertvector(x, Float),
                                           jitter.v + static_cast<float>(range.y));
        const Surface surface = tracer.trace(ray, active);
        SampleLanes sample = first_look(tracer, task, surface, active);
        look_at_lights(
            tracer, task, random, [&](int) { return active; }, sample);
        if (number == 0) {
            sums.object = sample.object;
            sums.mirrors = sample.mirrors;
            sums.surface = select(sample.surface.hit, sample.surface.index, Int{} - 1);
            sums.first_normal = sample.surface.shading_normal;
            for (int i = 0; out.first_hits != nullptr && i < W && at + i < range.count; ++i)
                record_first_hit(task, surface, i, out.first_hits[at + i]);
        }
        const Mask first = active & belongs(sample, sums.object, sums.first_normal);
        add(sums, task, sample, first);
        const Mask others = active & ~first;
        for (int i = 0; any(others) && i < W; ++i) {
            if (others[i] != 0) spill_lane(task, sample, i, at + i, sample_number, out.spill);
        }
    }
    store(out, at, task, sums);
}

std::uint64_t trace_pilot(const TraceTask& task, const PilotRange& range, const PilotOutput& out) {
    Tracer tracer(task);
    out.spill.count = 0;
    for (bool& crowded : out.spill.crowded) crowded = false;
    for (int at = 0; at < range.count; at += W) pilot_packet(tracer, task, range, at, out);
    return tracer.rays();
}

}  // namespace
}  // namespace vecino
