// SPDX-License-Identifier: Apache-2.0
#include "filters/pixel_sampler.h"

#include <algorithm>
#include <array>

#include "filters/surface_records_stages.h"

namespace vecino {

SampledPixel PixelSampler::sample(const NeedyPixel& pixel, int y) const {
    const auto pilot = static_cast<std::uint32_t>(inputs_.plan.pilot_spp);
    const RecordTracer& tracer = inputs_.tracer;
    SampledPixel out{};
    out.clusters = inputs_.clusters.clusters(pixel.x, y);
    const int before = out.clusters.count;
    if (paths_of(pixel, out.clusters.crowded) == 0) {
        out.rays += tracer.kernel.add_samples(
            tracer.task,
            {pixel.x, y, pilot, pixel.samples, known_surface(pixel, out.clusters),
             (pixel.needs & kNeedsShadow) != 0},
            out.clusters);
        out.samples = pixel.samples - pilot;
    }
    // By now it may be crowded.
    if (const std::uint32_t paths = paths_of(pixel, out.clusters.crowded); paths > 0) {
        trace_paths({pixel.x, y}, paths, out);
    } else {
        for (int k = before; k < out.clusters.count; ++k) adopt(k, {pixel.x, y}, out);
    }
    return out;
}

bool PixelSampler::is_crowded(const NeedyPixel& pixel, int y) const {
    const ClusterList* const list = inputs_.clusters.list(pixel.x, y);
    return list != nullptr && list->crowded;
}

bool PixelSampler::wants(const NeedyPixel& pixel, int y) const {
    const auto pilot = static_cast<std::uint32_t>(inputs_.plan.pilot_spp);
    return pixel.samples > pilot || is_crowded(pixel, y);
}

double PixelSampler::work(const NeedyPixel& pixel, int y) const {
    if (!wants(pixel, y)) return 0;
    const auto pilot = static_cast<std::uint32_t>(inputs_.plan.pilot_spp);
    const std::uint32_t paths = paths_of(pixel, is_crowded(pixel, y));
    return (paths > 0 ? kPathWork * paths : pixel.samples - pilot) + kEdgeStart;
}

/// Plain paths of a pixel; none where records and clusters do.
std::uint32_t PixelSampler::paths_of(const NeedyPixel& pixel, bool crowded) const {
    // What is known of a crowded pixel is not all: it needs more samples than its clusters say.
    constexpr std::uint32_t kMore = 8;
    const SurfaceRecordsPlan& plan = inputs_.plan;
    if (crowded) return std::max(pixel.samples, kMore * static_cast<std::uint32_t>(plan.edge_spp));
    const bool wanted = plan.edge_light == EdgeLight::paths && (pixel.needs & kNeedsCoverage) != 0;
    return wanted ? pixel.samples : 0;
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
    Orphan orphan{at.x, number, {}};
    if (record_light(inputs_.records, {at.x, at.y, cluster.object, means.position, means.normal},
                     orphan.light)) {
        return;
    }
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
