// SPDX-License-Identifier: Apache-2.0
#include "filters/pixel_looks.h"

#include <algorithm>

#include "core/clones.h"

namespace vecino {
namespace {

constexpr int kLanes = kPilotPixels;
constexpr float kAlbedoJump2 = 1e-3f;   ///< squared difference that counts as an edge
constexpr float kCreaseCosine = 0.95f;  ///< between normals; below, there is an edge

VECINO_CLONES void look_at_block(const PilotBlock& block, const PilotLight* lights, int light_count,
                                 std::size_t at, LookRow& row) {
    std::int32_t* const own = row.own.data() + at;
    std::int32_t* const bits = row.lights.data() + at;
    for (int i = 0; i < kLanes; ++i) {
        row.object.data()[at + static_cast<std::size_t>(i)] = block.object[i];
        own[i] = 0;
        bits[i] = 0;
    }
    for (int c = 0; c < 3; ++c) {
        float* const albedo = row.albedo[c].data() + at;
        for (int i = 0; i < kLanes; ++i) {
            albedo[i] =
                block.albedo[c][i] * (1.0f / (block.count[i] > 1.0f ? block.count[i] : 1.0f));
        }
    }
    float* const normal[3] = {row.normal[0].data() + at, row.normal[1].data() + at,
                              row.normal[2].data() + at};
    for (int i = 0; i < kLanes; ++i) {
        const float x = block.normal[0][i], y = block.normal[1][i], z = block.normal[2][i];
        const float length2 = x * x + y * y + z * z;
        const float per_length = 1.0f / __builtin_sqrtf(length2 > 1e-30f ? length2 : 1e-30f);
        normal[0][i] = x * per_length;
        normal[1][i] = y * per_length;
        normal[2][i] = z * per_length;
    }
    if (light_count > kMostExactLights) {
        for (int i = 0; i < kLanes; ++i) own[i] |= lights[1].exact[i] > 0.0f ? kNeedsShadow : 0;
        return;
    }
    for (int l = 0; l < light_count; ++l) {
        const PilotLight& light = lights[l];
        for (int i = 0; i < kLanes; ++i) {
            const bool seen = light.seen[i] > 0.0f;
            bits[i] |= seen ? 1 << l : 0;
            bits[i] |= light.exact[i] > 0.0f ? 256 << l : 0;
            own[i] |= seen && light.seen[i] < light.open[i] ? kNeedsShadow : 0;
        }
    }
}

void add_list(const ClusterList& list, int light_count, std::int32_t& own) {
    own |= kNeedsCoverage;
    for (int k = 0; k < list.count; ++k) {
        const Cluster& cluster = list.clusters[k];
        if (light_count > kMostExactLights) {
            if (cluster.picked_square > 0) own |= kNeedsShadow;
            continue;
        }
        for (int l = 0; l < light_count; ++l) {
            const LightSums& sums = cluster.lights[l];
            if (sums.seen > 0 && sums.seen < sums.open) own |= kNeedsShadow;
        }
    }
}

/// Pixels of a row from one on.
struct LookPart {
    const std::int32_t* object;
    const std::int32_t* lights;
    const std::int32_t* own;
    const float* albedo[3];
    const float* normal[3];
};

LookPart part_of(const LookRow& row, std::size_t from) {
    LookPart part{
        row.object.data() + from, row.lights.data() + from, row.own.data() + from, {}, {}};
    for (int c = 0; c < 3; ++c) {
        part.albedo[c] = row.albedo[c].data() + from;
        part.normal[c] = row.normal[c].data() + from;
    }
    return part;
}

/// What either of two neighbours needs, pixel by pixel.
VECINO_CLONES void compare(const LookPart& a, const LookPart& b, std::size_t count,
                           std::int32_t* of_a, std::int32_t* of_b) {
    for (std::size_t i = 0; i < count; ++i) {
        float jump2 = 0, cosine = 0;
        for (int c = 0; c < 3; ++c) {
            const float jump = a.albedo[c][i] - b.albedo[c][i];
            jump2 += jump * jump;
            cosine += a.normal[c][i] * b.normal[c][i];
        }
        const bool same = a.object[i] == b.object[i];
        const bool crease = (a.object[i] >= 0) & (cosine < kCreaseCosine);
        const std::int32_t edge = (!same | crease | (jump2 > kAlbedoJump2)) ? kNeedsCoverage : 0;
        const std::int32_t reachable = (a.lights[i] & b.lights[i]) >> 8;
        const std::int32_t differs = (a.lights[i] ^ b.lights[i]) & reachable & 255;
        const std::int32_t shadow = same & (differs != 0) ? kNeedsShadow : 0;
        const std::int32_t needs = edge | shadow | a.own[i] | b.own[i];
        of_a[i] |= needs;
        of_b[i] |= needs;
    }
}

}  // namespace

void look_at_row(const TraceTask& task, const PixelClusters& clusters, int y, LookRow& row) {
    const RowRange rows = clusters.rows();
    const std::size_t padded =
        y < rows.begin || y >= rows.end
            ? 0
            : static_cast<std::size_t>((clusters.width() + kLanes - 1) / kLanes * kLanes);
    for (auto* plane : {&row.object, &row.lights, &row.own}) plane->resize(padded);
    for (int c = 0; c < 3; ++c) {
        row.albedo[c].resize(padded);
        row.normal[c].resize(padded);
    }
    if (padded == 0) return;
    const int light_count = static_cast<int>(task.light_count);
    for (int x = 0; x < clusters.width(); x += kLanes) {
        look_at_block(clusters.block(x, y), clusters.lights(x, y), light_count,
                      static_cast<std::size_t>(x), row);
        const int end = std::min(x + kLanes, clusters.width());
        for (int i = x; i < end; ++i) {
            const ClusterList* const list = clusters.list(i, y);
            if (list != nullptr) add_list(*list, light_count, row.own[static_cast<std::size_t>(i)]);
        }
    }
}

void compare_rows(const LookRow& above, const LookRow& below, std::vector<std::int32_t>& of_above,
                  std::vector<std::int32_t>& of_below) {
    if (above.object.empty() || below.object.empty()) return;
    const std::size_t width = of_above.size();
    compare(part_of(above, 0), part_of(below, 0), width, of_above.data(), of_below.data());
    compare(part_of(above, 1), part_of(below, 0), width - 1, of_above.data() + 1, of_below.data());
    compare(part_of(above, 0), part_of(below, 1), width - 1, of_above.data(), of_below.data() + 1);
}

void compare_in_row(const LookRow& row, std::vector<std::int32_t>& needs) {
    const std::size_t width = needs.size();
    for (std::size_t i = 0; i < width; ++i) needs[i] |= row.own[i];
    // Apart, so that what is read and what is written are not the same.
    std::vector<std::int32_t> of_right(width, 0);
    compare(part_of(row, 0), part_of(row, 1), width - 1, needs.data(), of_right.data() + 1);
    for (std::size_t i = 0; i < width; ++i) needs[i] |= of_right[i];
}

}  // namespace vecino
