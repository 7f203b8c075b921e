// SPDX-License-Identifier: Apache-2.0
#include "filters/record_resolve.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/clones.h"
#include "core/frame_planes.h"
#include "filters/record_blocks.h"

namespace vecino {
namespace {

/// What pixels of one surface each are made of, side by side.
struct ShadingBlock {
    alignas(64) float albedo[3][kPilotPixels];
    float emission[3][kPilotPixels];
    float direct[3][kPilotPixels];  ///< over pi, straight from emitters
};

/// Means of normals and positions, and what shading needs.
VECINO_CLONES void shade_block(const PilotBlock& block, const PilotLight* lights,
                               const TraceTask& task, PointBlock& points, ShadingBlock& out) {
    alignas(64) float share[kPilotPixels], shadow_share[kPilotPixels];
    for (int i = 0; i < kPilotPixels; ++i) {
        share[i] = 1.0f / (block.count[i] > 1.0f ? block.count[i] : 1.0f);
        shadow_share[i] = 1.0f / (block.shadow_count[i] > 1.0f ? block.shadow_count[i] : 1.0f);
    }
    for (int c = 0; c < 3; ++c) {
        for (int i = 0; i < kPilotPixels; ++i) {
            points.position_world[c][i] = block.position[c][i] * share[i];
            out.albedo[c][i] = block.albedo[c][i] * share[i];
            out.emission[c][i] = block.emission[c][i] * share[i];
            out.direct[c][i] = 0.0f;
        }
    }
    for (int i = 0; i < kPilotPixels; ++i) {
        const float x = block.normal[0][i], y = block.normal[1][i], z = block.normal[2][i];
        const float length2 = x * x + y * y + z * z;
        const float per_length = 1.0f / __builtin_sqrtf(length2 > 1e-30f ? length2 : 1e-30f);
        points.normal_world[0][i] = x * per_length;
        points.normal_world[1][i] = y * per_length;
        points.normal_world[2][i] = z * per_length;
    }
    if (picks_lights(task)) {
        const bool sums = sums_lights(task);
        const float* const picked[] = {lights[0].exact, lights[0].open, lights[0].seen};
        const float* const unshadowed[] = {lights[2].exact, lights[2].open, lights[2].seen};
        for (int c = 0; c < 3; ++c) {
            for (int i = 0; i < kPilotPixels; ++i) {
                const float left = unshadowed[c][i] - picked[c][i];
                const float light = sums ? (left > 0.0f ? left : 0.0f) : picked[c][i];
                out.direct[c][i] = light * shadow_share[i];
            }
        }
        return;
    }
    for (std::uint32_t l = 0; l < task.light_count; ++l) {
        const PilotLight& light = lights[l];
        const float r = task.lights[l].radiance[0], g = task.lights[l].radiance[1],
                    b = task.lights[l].radiance[2];
        for (int i = 0; i < kPilotPixels; ++i) {
            const bool known = light.open[i] > 0.0f;
            const float ratio = light.seen[i] / (known ? light.open[i] : 1.0f);
            const float in_sight = known ? (ratio < 1.0f ? ratio : 1.0f) : 1.0f;
            const float value = light.exact[i] * share[i] * in_sight;
            out.direct[0][i] += r * value;
            out.direct[1][i] += g * value;
            out.direct[2][i] += b * value;
        }
    }
}

/// Sums over the surfaces of a pixel.
struct PixelSums {
    PixelValues values;
    float samples = 0;

    /// albedo: weighed by samples. A mirror is a bounce like any other.
    void add(int mirrors, const glm::vec3& emission, const glm::vec3& straight,
             const glm::vec3& indirect) {
        glm::vec3* const planes[] = {&values.emission, &values.direct, &values.indirect};
        *planes[std::min(mirrors, 2)] += emission;
        *planes[std::min(mirrors + 1, 2)] += straight;
        values.indirect += indirect;
    }
};

class RowResolver {
  public:
    RowResolver(const ResolveInputs& inputs, int y, const RowExceptions& exceptions, Frame& frame)
        : inputs_(inputs), y_(y), exceptions_(exceptions), frame_(frame) {}

    std::uint64_t run() {
        for (int x = 0; x < inputs_.clusters.width(); x += kPilotPixels) resolve_block(x);
        for (const TracedPixel& pixel : exceptions_.traced)
            store_values(pixel.values, {pixel.x, y_}, frame_);
        return non_finite_;
    }

  private:
    void resolve_block(int x) {
        const PilotBlock& block = inputs_.clusters.block(x, y_);
        PointBlock points;
        ShadingBlock shading;
        points.x = x;
        points.y = y_;
        points.count = std::min(kPilotPixels, inputs_.clusters.width() - x);
        shade_block(block, inputs_.clusters.lights(x, y_), inputs_.task, points, shading);
        bool single[kPilotPixels];
        for (int i = 0; i < points.count; ++i) {
            single[i] = inputs_.clusters.list(x + i, y_) == nullptr;
            points.object[i] = block.object[i];
            points.wanted[i] = single[i] && reflects(block.object[i], block.mirrors[i]);
        }
        LightBlock light;
        record_light(inputs_.records, points, light);
        for (int i = 0; i < points.count; ++i) {
            const bool needs_search = points.wanted[i] && !light.found[i];
            if (single[i] && !needs_search) {
                put_single(block, i, shading, light, points);
            } else {
                put_list(x + i);
            }
        }
    }

    [[nodiscard]] bool reflects(std::int32_t object, std::int32_t mirrors) const {
        return object >= 0 && mirrors < inputs_.task.max_depth;
    }

    void put_single(const PilotBlock& block, int i, const ShadingBlock& shading,
                    const LightBlock& light, const PointBlock& points) {
        const auto vector = [i](const auto& planes, int first) {
            return glm::vec3(planes[first][i], planes[first + 1][i], planes[first + 2][i]);
        };
        PixelSums sums;
        sums.values.samples = static_cast<std::uint64_t>(block.count[i]);
        glm::vec3 straight(0.0f), indirect(0.0f);
        if (points.wanted[i]) {
            const glm::vec3 albedo = vector(shading.albedo, 0);
            straight = albedo * vector(shading.direct, 0);
            if (light.found[i]) {
                indirect = albedo * vector(light.light, 0);
                if (inputs_.records.channels > 3) straight += albedo * vector(light.light, 3);
            }
        }
        sums.add(block.mirrors[i], vector(shading.emission, 0), straight, indirect);
        put(sums.values, points.x + i);
    }

    void put_list(int x) {
        PixelSums sums;
        int number = 0;
        inputs_.clusters.visit(x, y_, [&](const Cluster& cluster) {
            const ClusterMeans means = means_of(cluster);
            sums.samples += cluster.count;
            glm::vec3 straight(0.0f), indirect(0.0f);
            if (reflects(cluster.object, cluster.mirrors)) {
                const glm::vec3 reflected = means.albedo * cluster.count;
                const RecordValue light = light_at(cluster, means, x, number);
                straight = reflected * (direct_light(inputs_.task, cluster) +
                                        glm::vec3(light[3], light[4], light[5]));
                indirect = reflected * glm::vec3(light[0], light[1], light[2]);
            }
            sums.add(cluster.mirrors, means.emission * cluster.count, straight, indirect);
            ++number;
        });
        const float share = 1.0f / sums.samples;
        sums.values.emission *= share;
        sums.values.direct *= share;
        sums.values.indirect *= share;
        sums.values.samples = static_cast<std::uint64_t>(sums.samples);
        put(sums.values, x);
    }

    [[nodiscard]] RecordValue light_at(const Cluster& cluster, const ClusterMeans& means, int x,
                                       int number) const {
        RecordValue light;
        if (record_light(inputs_.records, {x, y_, cluster.object, means.position, means.normal},
                         light)) {
            return light;
        }
        for (const Orphan& orphan : exceptions_.orphans) {
            if (orphan.x == x && orphan.cluster == number) return orphan.light;
        }
        return light;
    }

    void put(const PixelValues& values, int x) {
        store_values(values, {x, y_}, frame_);
        if (!is_finite(values.radiance())) ++non_finite_;
    }

    const ResolveInputs& inputs_;
    int y_;
    const RowExceptions& exceptions_;
    Frame& frame_;
    std::uint64_t non_finite_ = 0;
};

}  // namespace

std::uint64_t resolve_row(const ResolveInputs& inputs, int y, const RowExceptions& exceptions,
                          Frame& frame) {
    return RowResolver(inputs, y, exceptions, frame).run();
}

}  // namespace vecino
