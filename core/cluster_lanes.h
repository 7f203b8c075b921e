// SPDX-License-Identifier: Apache-2.0
//
// Sums of what the samples of pixels see, surface by surface: the kernels behind the first two
// stages of the method surface_records. Included only by trace_kernel.cpp, after what it defines.
#pragma once

#include "core/sample_lanes.h"

namespace vecino {
namespace {

// Samples whose light is looked at before a cluster counts as all in light or all in shadow.
constexpr float kClearSamples = 16.0f;

// ---------------------------------------------------------------- sums of single samples

inline float lane_of(const Float& v, int lane) {
    return v[lane];
}
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
    Float3 first_normal{}, position{}, normal{}, albedo{}, emission{}, picked{};
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

// ---------------------------------------------------------------- further samples of one pixel

/// Whether shadow rays may still tell something about a cluster's light from an emitter.
inline bool is_unclear(const Cluster& cluster, int light) {
    const LightSums& sums = cluster.lights[light];
    return cluster.shadow_count < kClearSamples || (sums.seen > 0.0f && sums.seen < sums.open);
}

/// Puts samples into the clusters of their pixel.
class ClusterSorter {
  public:
    ClusterSorter(ClusterList& list, Uint numbers) : list_(list), numbers_(numbers) {}

    /// Slots of the list; -1 for lanes that are not active. New surfaces get a slot, if there is
    /// one.
    Int sort(const SampleLanes& sample, Mask active) {
        Int slot = Int{} - 1;
        for (int k = 0; k < list_.count; ++k) take(sample, k, active, slot);
        for (int i = 0; i < W; ++i) {
            if (active[i] == 0 || slot[i] >= 0) continue;
            if (list_.count == kMostClusters) {
                list_.crowded = true;
                return slot;
            }
            list_.clusters[list_.count] = empty_cluster(sample, i, numbers_[i]);
            take(sample, list_.count++, active, slot);
            slot[i] = list_.count - 1;
        }
        return slot;
    }

  private:
    void take(const SampleLanes& sample, int k, Mask active, Int& slot) const {
        const Cluster& cluster = list_.clusters[k];
        const Mask same = belongs(sample, Int{} + cluster.object, splat3(cluster.first_normal));
        slot = select(active & (slot < 0) & same, Int{} + k, slot);
    }

    ClusterList& list_;
    Uint numbers_;
};

inline void sample_packet(Tracer& tracer, const TraceTask& task, const PixelSamples& range,
                          std::uint32_t first, ClusterList& list) {
    const Uint number = (Uint)lane_numbers() + first;
    const Mask active = (Mask)(number >= range.begin) & (Mask)(number < range.end);
    const auto pixel = static_cast<std::uint32_t>(range.y * task.width + range.x);
    const PathRandom random(task, pixel, number);
    const Pair jitter = random.pair(0);
    const Ray ray = tracer.primary_ray(jitter.u + static_cast<float>(range.x),
                                       jitter.v + static_cast<float>(range.y));
    const Surface surface = range.known_surface < 0
                                ? tracer.trace(ray, active)
                                : tracer.revisit(ray, range.known_surface, active);
    SampleLanes sample = first_look(tracer, task, surface, active);
    const Int slot = ClusterSorter(list, number).sort(sample, active);
    look_at_lights(
        tracer, task, random,
        [&](int light) {
            if (range.half_shadow) return active;
            Mask asked{};
            for (int k = 0; k < list.count; ++k) {
                if (is_unclear(list.clusters[k], light)) asked |= slot == k;
            }
            return asked;
        },
        sample);
    for (int k = 0; k < list.count; ++k) {
        const Mask mine = slot == k;
        if (any(mine)) add_to_cluster(task, sample, mine, list.clusters[k]);
    }
}

std::uint64_t add_samples(const TraceTask& task, const PixelSamples& range, ClusterList& list) {
    Tracer tracer(task);
    constexpr auto kStep = static_cast<std::uint32_t>(W);
    for (std::uint32_t at = range.begin / kStep * kStep; at < range.end && !list.crowded;
         at += kStep)
        sample_packet(tracer, task, range, at, list);
    return tracer.rays();
}

// ---------------------------------------------------------------- a few samples of many pixels

/// Adds the sums of one pixel to its first surface.
inline void add_sums(const TraceTask& task, const PilotLanes& sums, int lane, Cluster& cluster) {
    cluster.count += sums.count[lane];
    cluster.shadow_count += sums.shadow_count[lane];
    add_lane(cluster.emission, sums.emission, lane);
    if (cluster.object < 0) return;
    add_lane(cluster.position, sums.position, lane);
    add_lane(cluster.normal, sums.normal, lane);
    add_lane(cluster.albedo, sums.albedo, lane);
    if (picks_lights(task)) {
        add_lane(cluster.picked, sums.picked, lane);
        cluster.picked_square += sums.picked_square[lane];
        return;
    }
    for (std::uint32_t i = 0; i < task.light_count; ++i) {
        cluster.lights[i].exact += sums.lights[i].exact[lane];
        cluster.lights[i].open += sums.lights[i].open[lane];
        cluster.lights[i].seen += sums.lights[i].seen[lane];
    }
}

/// One sample that hit another surface than its pixel's first.
inline void add_other(const TraceTask& task, const SampleLanes& sample, int lane,
                      std::uint32_t number, ClusterList& list) {
    for (int k = 1; k < list.count; ++k) {
        if (belongs(sample, lane, list.clusters[k]))
            return add_to_cluster(task, sample, lane, list.clusters[k]);
    }
    if (list.count == kMostClusters) {
        list.crowded = true;
        return;
    }
    list.clusters[list.count] = empty_cluster(sample, lane, number);
    add_to_cluster(task, sample, lane, list.clusters[list.count++]);
}

inline void few_packet(Tracer& tracer, const TraceTask& task, const FewSamples& range, int at,
                       ClusterList* lists) {
    Int x{}, y{};
    Uint end{};
    PilotLanes sums;
    std::uint32_t last = range.begin;
    for (int i = 0; i < W && at + i < range.count; ++i) {
        const Cluster& first = lists[at + i].clusters[0];
        x[i] = range.x[at + i];
        y[i] = range.y[at + i];
        end[i] = range.end[at + i];
        last = range.end[at + i] > last ? range.end[at + i] : last;
        sums.object[i] = first.object;
        sums.first_normal.x[i] = first.first_normal[0];
        sums.first_normal.y[i] = first.first_normal[1];
        sums.first_normal.z[i] = first.first_normal[2];
    }
    for (std::uint32_t number = range.begin; number < last; ++number) {
        const Mask active = (Mask)(splat(number) < end);
        const PathRandom random(task, (Uint)(x + y * task.width), splat(number));
        const Pair jitter = random.pair(0);
        const Ray ray = tracer.primary_ray(jitter.u + __builtin_convertvector(x, Float),
                                           jitter.v + __builtin_convertvector(y, Float));
        SampleLanes sample = first_look(tracer, task, tracer.trace(ray, active), active);
        look_at_lights(
            tracer, task, random, [&](int) { return active; }, sample);
        const Mask first = active & belongs(sample, sums.object, sums.first_normal);
        add(sums, task, sample, first);
        const Mask others = active & ~first;
        for (int i = 0; any(others) && i < W; ++i) {
            if (others[i] != 0) add_other(task, sample, i, number, lists[at + i]);
        }
    }
    for (int i = 0; i < W && at + i < range.count; ++i)
        add_sums(task, sums, i, lists[at + i].clusters[0]);
}

std::uint64_t add_few(const TraceTask& task, const FewSamples& range, ClusterList* lists) {
    Tracer tracer(task);
    for (int at = 0; at < range.count; at += W) few_packet(tracer, task, range, at, lists);
    return tracer.rays();
}

}  // namespace
}  // namespace vecino
