// SPDX-License-Identifier: Apache-2.0
#include "filters/pixel_looks.h"

#include <algorithm>

#include "core/color.h"
#include "core/eight_lanes.h"

namespace vecino {
namespace {

constexpr float kAlbedoJump2 = 1e-3f;   ///< squared difference that counts as an edge
constexpr float kCreaseCosine = 0.95f;  ///< between normals; below, there is an edge
constexpr float kLightJump = 0.02f;     ///< of LookRow::light: beside a lamp

// As numbers, for vectors.
constexpr std::int32_t kCoverage = kNeedsCoverage, kShadow = kNeedsShadow;

/// First samples, and the light that goes with them.
struct LookedBlock {
    const TraceTask& task;
    const PilotBlock& block;
    const PilotLight* lights;
};

VECINO_CLONES void look_at_block(const LookedBlock& looked, std::size_t at, LookRow& row) {
    const auto& [task, block, lights] = looked;
    const bool picks = picks_lights(task);
    const Floats8 none = {};
    for (std::size_t i = 0; i < kPilotPixels; i += 8) {
        Floats8 count, x, y, z, value, seen, open, light = {};
        Masks8 object, own = {}, bits = {};
        load(block.object + i, object);
        store(object, row.object.data() + at + i);
        load(block.count + i, count);
        const Floats8 share = 1.0f / (count > 1.0f ? count : none + 1.0f);
        for (int c = 0; c < 3; ++c) {
            load(block.albedo[c] + i, value);
            store(value * share, row.albedo[c].data() + at + i);
        }
        load(block.normal[0] + i, x);
        load(block.normal[1] + i, y);
        load(block.normal[2] + i, z);
        Floats8 length2 = x * x + y * y + z * z;
        length2 = length2 > 1e-30f ? length2 : none + 1e-30f;
        for (int k = 0; k < 8; ++k) value[k] = 1.0f / __builtin_sqrtf(length2[k]);
        store(x * value, row.normal[0].data() + at + i);
        store(y * value, row.normal[1].data() + at + i);
        store(z * value, row.normal[2].data() + at + i);
        if (picks) {
            load(lights[1].exact + i, value);
            own |= (value > 0.0f) & kShadow;
        }
        if (sums_lights(task)) {
            load(lights[2].exact + i, x);
            load(lights[2].open + i, y);
            load(lights[2].seen + i, z);
            light = kLuminance[0] * x + kLuminance[1] * y + kLuminance[2] * z;
        }
        for (int l = 0; !picks && l < static_cast<int>(task.light_count); ++l) {
            const float* const radiance = task.lights[l].radiance;
            load(lights[l].seen + i, seen);
            load(lights[l].open + i, open);
            load(lights[l].exact + i, value);
            bits |= ((seen > 0.0f) & (1 << l)) | ((value > 0.0f) & (256 << l));
            own |= (seen > 0.0f) & (seen < open) & kShadow;
            light += value * luminance(radiance[0], radiance[1], radiance[2]);
        }
        light *= share;
        light = light < 1.0f ? light : none + 1.0f;
        light *= share;
        for (int k = 0; k < 8; ++k) value[k] = __builtin_sqrtf(light[k]);
        store(value, row.light.data() + at + i);
        store(own, row.own.data() + at + i);
        store(bits, row.lights.data() + at + i);
    }
}

void add_list(const ClusterList& list, const TraceTask& task, std::int32_t& own) {
    own |= kNeedsCoverage;
    for (int k = 0; k < list.count; ++k) {
        const Cluster& cluster = list.clusters[k];
        if (picks_lights(task)) {
            if (cluster.picked_square > 0) own |= kNeedsShadow;
            continue;
        }
        for (std::uint32_t l = 0; l < task.light_count; ++l) {
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
    const float* light;
    const float* albedo[3];
    const float* normal[3];
};

LookPart part_of(const LookRow& row, std::size_t from) {
    LookPart part{row.object.data() + from,
                  row.lights.data() + from,
                  row.own.data() + from,
                  row.light.data() + from,
                  {},
                  {}};
    for (int c = 0; c < 3; ++c) {
        part.albedo[c] = row.albedo[c].data() + from;
        part.normal[c] = row.normal[c].data() + from;
    }
    return part;
}

/// Numbers i to i + 7, as far as there are so many.
struct Eight {
    std::size_t i, count;
};

/// What either of eight pairs of neighbours needs.
VECINO_INLINE void needs_of_pairs(const LookPart& a, const LookPart& b, Eight eight,
                                  Masks8& needs) {
    const auto [i, count] = eight;
    Floats8 jump2 = {}, cosine = {}, of_a, of_b, light, other_light;
    Masks8 object, other, lights, other_lights, own, other_own;
    for (int c = 0; c < 3; ++c) {
        load(a.albedo[c] + i, of_a, count);
        load(b.albedo[c] + i, of_b, count);
        jump2 += (of_a - of_b) * (of_a - of_b);
        load(a.normal[c] + i, of_a, count);
        load(b.normal[c] + i, of_b, count);
        cosine += of_a * of_b;
    }
    load(a.light + i, light, count);
    load(b.light + i, other_light, count);
    light -= other_light;
    load(a.object + i, object, count);
    load(b.object + i, other, count);
    load(a.lights + i, lights, count);
    load(b.lights + i, other_lights, count);
    load(a.own + i, own, count);
    load(b.own + i, other_own, count);
    const Masks8 crease = (object >= 0) & (cosine < kCreaseCosine);
    const Masks8 steep = (light > kLightJump) | (light < -kLightJump);
    const Masks8 edge = (object != other) | crease | steep | (jump2 > kAlbedoJump2);
    const Masks8 reachable = (lights & other_lights) >> 8;
    const Masks8 differs = ((lights ^ other_lights) & reachable & 255) != 0;
    const Masks8 shadow = (object == other) & differs;
    needs = (edge & kCoverage) | (shadow & kShadow) | own | other_own;
}

/// What either of two neighbours needs, pixel by pixel.
VECINO_CLONES void compare(const LookPart& a, const LookPart& b, std::size_t count,
                           std::int32_t* of_a, std::int32_t* of_b) {
    for (std::size_t i = 0; i < count; i += 8) {
        const std::size_t some = count - i;
        Masks8 needs, before;
        needs_of_pairs(a, b, {i, some}, needs);
        load(of_a + i, before, some);
        store(before | needs, of_a + i, some);
        load(of_b + i, before, some);
        store(before | needs, of_b + i, some);
    }
}

}  // namespace

void look_at_row(const TraceTask& task, const PixelClusters& clusters, int y, LookRow& row) {
    const RowRange rows = clusters.rows();
    const std::size_t padded =
        y < rows.begin || y >= rows.end
            ? 0
            : static_cast<std::size_t>((clusters.width() + kPilotPixels - 1) / kPilotPixels *
                                       kPilotPixels);
    for (auto* plane : {&row.object, &row.lights, &row.own}) plane->resize(padded);
    for (int c = 0; c < 3; ++c) {
        row.albedo[c].resize(padded);
        row.normal[c].resize(padded);
    }
    row.light.resize(padded);
    if (padded == 0) return;
    for (int x = 0; x < clusters.width(); x += kPilotPixels) {
        look_at_block({task, clusters.block(x, y), clusters.lights(x, y)},
                      static_cast<std::size_t>(x), row);
        const int end = std::min(x + kPilotPixels, clusters.width());
        for (int i = x; i < end; ++i) {
            const ClusterList* const list = clusters.list(i, y);
            if (list != nullptr) add_list(*list, task, row.own[static_cast<std::size_t>(i)]);
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
