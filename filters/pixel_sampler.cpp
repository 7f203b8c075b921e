// SPDX-License-Identifier: Apache-2.0
#include "filters/pixel_sampler.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

#include "filters/surface_records_stages.h"

namespace vecino {

void PixelSampler::sample(std::span<const NeedyPlace> places, const Take& take) const {
    Few few[std::bit_width(unsigned{kOwnPacketSpp})];  // by the power of two below their samples
    for (const NeedyPlace& place : places) {
        if (!wants(place)) continue;
        if (!shares_packets(place)) {
            take(place, sample_one(place));
            continue;
        }
        Few& queue = few[std::bit_width(place.pixel.samples) - 1];
        queue.places[queue.count++] = place;
        if (queue.count == kPilotPixels) sample_few(queue, take);
    }
    for (Few& queue : few) {
        if (queue.count > 0) sample_few(queue, take);
    }
}

SampledPixel PixelSampler::sample_one(const NeedyPlace& place) const {
    const auto& [pixel, y] = place;
    const RecordTracer& tracer = inputs_.tracer;
    SampledPixel out{};
    out.clusters = inputs_.clusters.clusters(pixel.x, y);
    const int before = out.clusters.count;
    if (paths_of(pixel, out.clusters.crowded) == 0) {
        out.rays += tracer.kernel.add_samples(
            tracer.task,
            {pixel.x, y, pilot_spp(), pixel.samples, known_surface(pixel, out.clusters),
             (pixel.needs & kNeedsShadow) != 0},
            out.clusters);
        out.samples = pixel.samples - pilot_spp();
    }
    finish(place, before, out);
    return out;
}

void PixelSampler::sample_few(Few& few, const Take& take) const {
    FewSamples range;
    ClusterList lists[kPilotPixels];
    int before[kPilotPixels];
    range.count = few.count;
    range.begin = pilot_spp();
    for (int i = 0; i < few.count; ++i) {
        const auto& [pixel, y] = few.places[i];
        range.x[i] = pixel.x;
        range.y[i] = y;
        range.end[i] = pixel.samples;
        lists[i] = inputs_.clusters.clusters(pixel.x, y);
        before[i] = lists[i].count;
    }
    const RecordTracer& tracer = inputs_.tracer;
    std::uint64_t rays = tracer.kernel.add_few(tracer.task, range, lists);
    for (int i = 0; i < few.count; ++i) {
        SampledPixel out{};
        out.clusters = lists[i];
        out.rays = std::exchange(rays, 0);  // of all, counted once
        out.samples = few.places[i].pixel.samples - pilot_spp();
        finish(few.places[i], before[i], out);
        take(few.places[i], out);
    }
    few.count = 0;
}

/// What no cluster is known well enough for.
void PixelSampler::finish(const NeedyPlace& place, int known_clusters, SampledPixel& out) const {
    const Pixel at{place.pixel.x, place.y};
    // By now it may be crowded.
    if (const std::uint32_t paths = paths_of(place.pixel, out.clusters.crowded); paths > 0) {
        trace_paths(at, paths, out);
    } else {
        for (int k = known_clusters; k < out.clusters.count; ++k) adopt(k, at, out);
    }
}

bool PixelSampler::is_crowded(const NeedyPlace& place) const {
    const ClusterList* const list = inputs_.clusters.list(place.pixel.x, place.y);
    return list != nullptr && list->crowded;
}

bool PixelSampler::wants(const NeedyPlace& place) const {
    return place.pixel.samples > pilot_spp() || is_crowded(place);
}

bool PixelSampler::shares_packets(const NeedyPlace& place) const {
    return place.pixel.samples < kOwnPacketSpp && paths_of(place.pixel, is_crowded(place)) == 0;
}

double PixelSampler::work(const NeedyPlace& place) const {
    if (!wants(place)) return 0;
    const std::uint32_t paths = paths_of(place.pixel, is_crowded(place));
    return paths > 0 ? kPathWork * paths + kEdgeStart
                     : further_work(place.pixel.samples, pilot_spp());
}

/// Plain paths of a pixel; none where records and clusters do.
std::uint32_t PixelSampler::paths_of(const NeedyPixel& pixel, bool crowded) const {
    // What is known of a crowded pixel is not all: it needs more samples than its clusters say.
    constexpr std::uint32_t kMore = 8;
    const SurfaceRecordsPlan& plan = inputs_.plan;
    if (crowded) return std::max(pixel.samples, kMore * static_cast<std::uint32_t>(plan.edge_spp));
    const bool wanted = plan.edge_light == EdgeLight::paths && (pixel.needs & kNeedsCoverage) != 0;
    // Fewer than a packet has room for take as long.
    return wanted ? std::max(pixel.samples, std::uint32_t{kOwnPacketSpp}) : 0;
}

void PixelSampler::trace_paths(Pixel at, std::uint32_t paths, SampledPixel& out) const {
    PixelAccumulator sums(VarianceOf::nothing);
    SampleBlock block;
    for (std::uint32_t done = 0; done < paths; done += kBlockSamples) {
        const int count = std::min(kBlockSamples, static_cast<int>(paths - done));
        out.rays +=
            inputs_.kernel.trace_samples(inputs_.tracer.task, {at.x, at.y, done, count}, block, {});
        sums.add(block, count);
    }
    std::array<ExactSum::Digits, kMostSums> digits;
    sums.sums(digits);
    out.samples = paths;
    out.traced = TracedPixel{at.x, pixel_values(digits, VarianceOf::nothing)};
}

/// The quad or sphere that fills a pixel and all around it; else -1.
std::int32_t PixelSampler::known_surface(const NeedyPixel& pixel, const ClusterList& list) const {
    const TraceTask& task = inputs_.tracer.task;
    const Cluster& cluster = list.clusters[0];
    const auto surface = static_cast<std::uint32_t>(cluster.surface);
    const bool simple = surface < task.first_triangle || surface >= task.first_sphere;
    const bool alone =
        (pixel.needs & kNeedsCoverage) == 0 && list.count == 1 && cluster.mirrors == 0;
    return alone && cluster.object >= 0 && simple ? cluster.surface : -1;
}

/// Gathers light for a surface that the first samples missed, if no record is near.
void PixelSampler::adopt(int number, Pixel at, SampledPixel& out) const {
    const Cluster& cluster = out.clusters.clusters[number];
    const ClusterMeans means = means_of(cluster);
    const bool reflects = means.albedo.x + means.albedo.y + means.albedo.z > 0;
    const RecordTracer& tracer = inputs_.tracer;
    if (!has_records(tracer.task) || cluster.object < 0 || !reflects) return;
    const SurfacePoint point{at.x, at.y, cluster.object, means.position, means.normal};
    if (is_near_record(inputs_.records, point)) return;
    Orphan orphan{at.x, number, {}};
    RecordLight light;
    out.rays +=
        tracer.kernel.gather(tracer.task,
                             {at.x, at.y, cluster.first_sample,
                              static_cast<std::uint32_t>(inputs_.plan.refined_record_paths)},
                             light);
    for (std::size_t c = 0; c < 3; ++c) {
        orphan.light[c] = light.indirect[c];
        orphan.light[c + 3] = light.background[c];
    }
    out.orphans.push_back(orphan);
}

bool has_records(const TraceTask& task) {
    return task.max_depth > 1 || (task.max_depth == 1 && task.has_background);
}

}  // namespace vecino
