// SPDX-License-Identifier: Apache-2.0
//
// The light that arrives at one surface by way of others and from the background: the kernel behind
// the records of the method surface_records. Included only by trace_kernel.cpp, after what it
// defines.
#pragma once

#include "core/lanes.h"
#include "core/record_task.h"
#include "core/surface_lanes.h"

namespace vecino {
namespace {

/// Sums over paths.
class GatherSums {
  public:
    void add(const SampleBlock& block, std::uint32_t count, RecordLight& out) {
        for (std::uint32_t at = 0; at < count; ++at) {
            float check = 0;
            for (int c = 0; c < 3; ++c) check += block.direct[c][at] + block.indirect[c][at];
            if (!(check - check == 0.0f)) {
                ++out.dropped;
                continue;
            }
            ++paths_;
            for (int c = 0; c < 3; ++c) {
                background_[c] += static_cast<double>(block.direct[c][at]);
                // As one float: what is summed is what was checked.
                both_[c] += static_cast<double>(block.direct[c][at] + block.indirect[c][at]);
            }
        }
    }

    void finish(RecordLight& out) const {
        if (paths_ == 0) return;
        for (int c = 0; c < 3; ++c) {
            out.background[c] = static_cast<float>(background_[c] / paths_);
            out.indirect[c] = static_cast<float>((both_[c] - background_[c]) / paths_);
        }
    }

  private:
    double both_[3]{};
    double background_[3]{};
    double paths_ = 0;
};

inline void describe_record(const SampleLanes& sample, RecordLight& out) {
    const Surface& s = sample.surface;
    out.hit = s.hit[0] != 0;
    out.object = sample.object[0];
    out.distance = sample.distance[0];
    out.cosine = __builtin_fabsf(dot(s.direction, s.shading_normal)[0]);
    put_lane(out.position, s.position, 0);
    put_lane(out.normal, s.shading_normal, 0);
}

/// All lanes the same: what one sample of a pixel shows.
inline SampleLanes look_of_sample(Tracer& tracer, const TraceTask& task, const RecordRange& range,
                                  std::uint32_t pixel) {
    const Pair jitter = PathRandom(task, pixel, splat(range.sample)).pair(0);
    const Ray ray = tracer.primary_ray(jitter.u + static_cast<float>(range.x),
                                       jitter.v + static_cast<float>(range.y));
    const Mask all = lane_numbers() >= 0;
    return first_look(tracer, task, tracer.trace(ray, all), all);
}

std::uint64_t gather_record(const TraceTask& whole, const RecordRange& range, RecordLight& out) {
    TraceTask task = whole;
    Tracer tracer(task);
    const auto pixel = static_cast<std::uint32_t>(range.y * task.width + range.x);
    const SampleLanes look = look_of_sample(tracer, task, range, pixel);
    out = RecordLight{};
    describe_record(look, out);
    task.max_depth -= look.mirrors[0];
    if (!out.hit || task.max_depth < 1) return tracer.rays();
    constexpr auto kBlock = static_cast<std::uint32_t>(kBlockSamples);
    GatherSums sums;
    SampleBlock block;
    float inverse_distance = 0;
    for (std::uint32_t first = 0; first < range.paths; first += kBlock) {
        __builtin_memset(&block, 0, sizeof block);
        const std::uint32_t end = range.paths - first < kBlock ? range.paths : first + kBlock;
        for (std::uint32_t at = first; at < end; at += static_cast<std::uint32_t>(W)) {
            const Uint number = (Uint)lane_numbers() + at;
            const Mask active = (Mask)(number < end);
            const PathRandom random(task, pixel, number);
            PathPacket packet(task, random);
            const Float nearness =
                packet.gather(tracer, look.surface, active, block, static_cast<int>(at - first));
            inverse_distance += sum_of(nearness, active);
        }
        sums.add(block, end - first, out);
    }
    sums.finish(out);
    out.inverse_distance = inverse_distance / static_cast<float>(range.paths);
    return tracer.rays();
}

}  // namespace
}  // namespace vecino
