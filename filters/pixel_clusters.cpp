// SPDX-License-Identifier: Apache-2.0
#include "filters/pixel_clusters.h"

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace vecino {

PixelClusters::PixelClusters(int width, int most_rows, int lights)
    : width_(width),
      blocks_per_row_(static_cast<std::size_t>((width + kPilotPixels - 1) / kPilotPixels)),
      picks_(lights > kMostExactLights),
      light_planes_(picks_ ? 3 : static_cast<std::size_t>(lights)),
      blocks_(
          std::make_unique<PilotBlock[]>(blocks_per_row_ * static_cast<std::size_t>(most_rows))),
      lights_(std::make_unique<PilotLight[]>(blocks_per_row_ * static_cast<std::size_t>(most_rows) *
                                             light_planes_)) {
    begin({0, most_rows});
}

void PixelClusters::begin(RowRange rows) {
    rows_ = rows;
    const auto count = static_cast<std::size_t>(rows.end - rows.begin);
    list_index_.assign(static_cast<std::size_t>(width_) * count, -1);
    lists_.assign(count, {});
}

ClusterList PixelClusters::clusters(int x, int y) const {
    const ClusterList* const found = list(x, y);
    if (found != nullptr) return *found;
    ClusterList one;
    one.count = 1;
    one.crowded = false;
    one.clusters[0] = first_cluster(x, y);
    return one;
}

void PixelClusters::store(int x, int y, const ClusterList& list) {
    if (list.count > 1 || list_index_[pixel_index(x, y)] >= 0) {
        make_list(x, y) = list;
    } else {
        store_first(x, y, list.clusters[0]);
    }
}

ClusterList& PixelClusters::make_list(int x, int y) {
    std::int32_t& index = list_index_[pixel_index(x, y)];
    std::vector<ClusterList>& lists = lists_[row(y)];
    if (index < 0) {
        index = static_cast<std::int32_t>(lists.size());
        ClusterList& list = lists.emplace_back();
        list.count = 1;
        list.crowded = false;
        list.clusters[0] = first_cluster(x, y);
    }
    return lists[static_cast<std::size_t>(index)];
}

Cluster PixelClusters::first_cluster(int x, int y) const {
    const PilotBlock& from = block(x, y);
    const int i = x % kPilotPixels;
    Cluster to{};
    to.object = from.object[i];
    to.surface = from.surface[i];
    to.mirrors = from.mirrors[i];
    to.count = from.count[i];
    to.shadow_count = from.shadow_count[i];
    for (int k = 0; k < 3; ++k) {
        to.first_normal[k] = from.first_normal[k][i];
        to.position[k] = from.position[k][i];
        to.normal[k] = from.normal[k][i];
        to.albedo[k] = from.albedo[k][i];
        to.emission[k] = from.emission[k][i];
    }
    const PilotLight* const planes = lights(x, y);
    if (picks_) {
        to.picked[0] = planes[0].exact[i];
        to.picked[1] = planes[0].open[i];
        to.picked[2] = planes[0].seen[i];
        to.picked_square = planes[1].exact[i];
        to.unshadowed[0] = planes[2].exact[i];
        to.unshadowed[1] = planes[2].open[i];
        to.unshadowed[2] = planes[2].seen[i];
        return to;
    }
    for (std::size_t k = 0; k < light_planes_; ++k)
        to.lights[k] = {planes[k].exact[i], planes[k].open[i], planes[k].seen[i]};
    return to;
}

void PixelClusters::store_first(int x, int y, const Cluster& from) {
    PilotBlock& to = blocks_[block_index(x, y)];
    const int i = x % kPilotPixels;
    to.count[i] = from.count;
    to.shadow_count[i] = from.shadow_count;
    for (int k = 0; k < 3; ++k) {
        to.position[k][i] = from.position[k];
        to.normal[k][i] = from.normal[k];
        to.albedo[k][i] = from.albedo[k];
        to.emission[k][i] = from.emission[k];
    }
    PilotLight* const planes = lights_.get() + block_index(x, y) * light_planes_;
    if (picks_) {
        planes[0].exact[i] = from.picked[0];
        planes[0].open[i] = from.picked[1];
        planes[0].seen[i] = from.picked[2];
        planes[1].exact[i] = from.picked_square;
        planes[2].exact[i] = from.unshadowed[0];
        planes[2].open[i] = from.unshadowed[1];
        planes[2].seen[i] = from.unshadowed[2];
        return;
    }
    for (std::size_t k = 0; k < light_planes_; ++k) {
        planes[k].exact[i] = from.lights[k].exact;
        planes[k].open[i] = from.lights[k].open;
        planes[k].seen[i] = from.lights[k].seen;
    }
}

std::uint64_t PixelClusters::trace_row(const RecordTracer& tracer, int y, int samples,
                                       FirstHitRecord* first_hits) {
    std::uint64_t rays = 0;
    PilotSpill spill;
    for (int x = 0; x < width_; x += kPilotPixels) {
        const PilotRange range{x, y, std::min(kPilotPixels, width_ - x), samples};
        const std::size_t at = block_index(x, y);
        rays += tracer.kernel.trace_pilot(tracer.task, range,
                                          {blocks_[at], lights_.get() + at * light_planes_, spill,
                                           first_hits == nullptr ? nullptr : first_hits + x});
        take_spill(spill, x, y);
    }
    return rays;
}

void PixelClusters::try_samples(const RecordTracer& tracer, Pixel at, int samples) const {
    PilotBlock block;
    PilotLight lights[kMostExactLights];
    PilotSpill spill;
    tracer.kernel.trace_pilot(tracer.task,
                              {at.x, at.y, std::min(kPilotPixels, width_ - at.x), samples},
                              {block, lights, spill, nullptr});
}

void PixelClusters::take_spill(const PilotSpill& spill, int x, int y) {
    for (int i = 0; i < spill.count; ++i) {
        ClusterList& list = make_list(x + spill.pixel[i], y);
        list.clusters[list.count++] = spill.clusters[i];
    }
    for (int i = 0; i < kPilotPixels; ++i) {
        if (spill.crowded[i]) make_list(x + i, y).crowded = true;
    }
}

namespace {

glm::vec3 vector(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

}  // namespace

ClusterMeans means_of(const Cluster& cluster) {
    const float share = 1.0f / std::max(cluster.count, 1.0f);
    const glm::vec3 normal = vector(cluster.normal);
    const float length = glm::length(normal);
    return {vector(cluster.position) * share,
            length > 0 ? normal / length : vector(cluster.first_normal),
            vector(cluster.albedo) * share, vector(cluster.emission) * share};
}

float share_in_sight(const LightSums& sums) {
    return sums.open > 0 ? std::min(sums.seen / sums.open, 1.0f) : 1.0f;
}

glm::vec3 direct_light(const TraceTask& task, const Cluster& cluster) {
    if (picks_lights(task)) {
        const float share = 1.0f / std::max(cluster.shadow_count, 1.0f);
        if (!sums_lights(task)) return vector(cluster.picked) * share;
        const glm::vec3 left = vector(cluster.unshadowed) - vector(cluster.picked);
        return glm::max(left, glm::vec3(0.0f)) * share;
    }
    glm::vec3 light(0.0f);
    const float share = 1.0f / std::max(cluster.count, 1.0f);
    for (std::uint32_t i = 0; i < task.light_count; ++i) {
        const LightSums& sums = cluster.lights[i];
        light += vector(task.lights[i].radiance) * (sums.exact * share * share_in_sight(sums));
    }
    return light;
}

}  // namespace vecino
