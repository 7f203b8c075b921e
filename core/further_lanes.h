// SPDX-License-Identifier: Apache-2.0
//
// Further samples of pixels of which some are known: in packets of one pixel, or few of many side
// by side. Included only by trace_kernel.cpp, after what it defines.
#pragma once

#include "core/cluster_lanes.h"

namespace vecino {
namespace {

// Samples whose light is looked at before a cluster counts as all in light or all in shadow.
constexpr float kClearSamples = 16.0f;

// ---------------------------------------------------------------- of one pixel

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

// ---------------------------------------------------------------- a few of many pixels

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
        add_lane(cluster.unshadowed, sums.unshadowed, lane);
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

/// Where a few samples come from and go to.
struct FewInputs {
    const TraceTask& task;
    const FewSamples& range;
    ClusterList* lists;
};

/// One sample that hit another surface than its pixel's first.
inline void add_other(const TraceTask& task, const SampleLanes& sample, int lane, ClusterList& list,
                      std::uint32_t number) {
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

inline void few_packet(Tracer& tracer, const FewInputs& inputs, int at) {
    const auto& [task, range, lists] = inputs;
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
            if (others[i] != 0) add_other(task, sample, i, lists[at + i], number);
        }
    }
    for (int i = 0; i < W && at + i < range.count; ++i)
        add_sums(task, sums, i, lists[at + i].clusters[0]);
}

std::uint64_t add_few(const TraceTask& task, const FewSamples& range, ClusterList* lists) {
    Tracer tracer(task);
    for (int at = 0; at < range.count; at += W) few_packet(tracer, {task, range, lists}, at);
    return tracer.rays();
}

}  // namespace
}  // namespace vecino
