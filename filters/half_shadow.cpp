// SPDX-License-Identifier: Apache-2.0
#include "filters/half_shadow.h"

#include <algorithm>
#include <vector>

#include "core/eight_lanes.h"
#include "filters/shadow_field.h"

namespace vecino {
namespace {

constexpr int kChannels = kFieldChannels;

/// And by how much neighbours differ.
struct MeanRow {
    FieldRow field;
    std::vector<float> right, below;  ///< squared difference to that neighbour; < 0: no such
};

constexpr int kSummed = 8;  ///< pixels of a row at a time

/// Sums over the windows of pixels side by side.
struct LaneSums {
    Floats8 count, sum, squares, channel[kChannels];
    Floats8 differences, pairs;  ///< of neighbours: squared
};

/// Where pixels are in their row, and those that are added to them in theirs.
struct Places {
    std::size_t at, from;
};

VECINO_CLONES void add_pixels(const MeanRow& own, const MeanRow& row, const Places& places,
                              LaneSums& sums) {
    const auto [at, from] = places;
    Floats8 normal, other, cosine = {}, value, right, below, light;
    for (int c = 0; c < 3; ++c) {
        load(own.field.normal[c].data() + at, normal);
        load(row.field.normal[c].data() + from, other);
        cosine += normal * other;
    }
    Masks8 object, object_there;
    load(own.field.object.data() + at, object);
    load(row.field.object.data() + from, object_there);
    load(row.field.value.data() + from, value);
    load(row.right.data() + from, right);
    load(row.below.data() + from, below);
    const Masks8 like = (object == object_there) & (cosine > kSameSurface);
    const Masks8 of_right = like & (right >= 0.0f), of_below = like & (below >= 0.0f);
    const Floats8 one = Floats8{} + 1.0f;
    add_masked(one, like, sums.count);
    add_masked(value, like, sums.sum);
    add_masked(value * value, like, sums.squares);
    for (int c = 0; c < kChannels; ++c) {
        load(row.field.channel[c].data() + from, light);
        add_masked(light, like, sums.channel[c]);
    }
    add_masked(right, of_right, sums.differences);
    add_masked(below, of_below, sums.differences);
    add_masked(one, of_right, sums.pairs);
    add_masked(one, of_below, sums.pairs);
}

/// How far a value is to be replaced by the mean. Of noise, neighbours differ by as much as any two
/// pixels do; on both sides of an edge they are alike.
float grain(const LaneSums& sums, int i) {
    constexpr float kEdge = 0.45f, kNoise = 0.75f;
    const float mean = sums.sum[i] / sums.count[i];
    const float variance = sums.squares[i] / sums.count[i] - mean * mean;
    if (!(sums.pairs[i] > 0) || !(variance > 1e-12f * mean * mean)) return 0;
    const float ratio = sums.differences[i] / sums.pairs[i] / (2 * variance);
    return std::clamp((ratio - kEdge) / (kNoise - kEdge), 0.0f, 1.0f);
}

float squared(float v) {
    return v * v;
}

void read_row(const LightField& field, int y, RowRange rows, MeanRow& row) {
    field.read(y, rows, row.field);
    const std::vector<std::int32_t>& object = row.field.object;
    const std::vector<float>& value = row.field.value;
    row.right.assign(object.size(), -1.0f);
    row.below.assign(object.size(), -1.0f);
    for (std::size_t i = 0; i + 1 < object.size(); ++i) {
        if (object[i] != kNoField && object[i] == object[i + 1])
            row.right[i] = squared(value[i] - value[i + 1]);
    }
}

void compare(MeanRow& row, const MeanRow& next) {
    for (std::size_t i = 0; i < row.field.object.size(); ++i) {
        if (row.field.object[i] != kNoField && row.field.object[i] == next.field.object[i])
            row.below[i] = squared(row.field.value[i] - next.field.value[i]);
    }
}

/// Goes down rows with those around at hand.
class RowSmoother {
  public:
    RowSmoother(const LightField& field, RowRange rows, int reach)
        : field_(field), rows_(rows), reach_(reach), window_(reach, reach + 1) {}

    std::vector<Smoothed> next(int y, const std::vector<int>& pixels) {
        window_.go_to(y, [this](int k, MeanRow& row) {
            read_row(field_, k, rows_, row);
            if (!window_[k - 1].field.object.empty()) compare(window_[k - 1], row);
        });
        std::vector<Smoothed> out;
        LaneSums sums;
        int summed = -1;  // block
        for (const int x : pixels) {
            if (x / kSummed != summed) {
                summed = x / kSummed;
                sums = sums_of(y, summed * kSummed);
            }
            const int i = x % kSummed;
            const FieldRow& own = window_[y].field;
            const auto at = field_index(x);
            if (own.object[at] == kNoField) continue;
            const float share = grain(sums, i);
            if (!(share > 0)) continue;
            Smoothed pixel{x, {}};
            for (int c = 0; c < kChannels; ++c) {
                const float mean = sums.channel[c][i] / sums.count[i];
                pixel.channel[c] = own.channel[c][at] + share * (mean - own.channel[c][at]);
            }
            out.push_back(pixel);
        }
        return out;
    }

  private:
    LaneSums sums_of(int y, int x) {
        LaneSums sums{};
        const auto at = field_index(x);
        for (int dy = -reach_; dy <= reach_; ++dy) {
            for (int dx = -reach_; dx <= reach_; ++dx) {
                add_pixels(window_[y], window_[y + dy], {at, field_index(x + dx)}, sums);
            }
        }
        return sums;
    }

    const LightField& field_;
    RowRange rows_;
    int reach_;
    RowWindow<MeanRow> window_;
};

}  // namespace

void smooth_half_shadow(const RecordTracer& tracer, const GivenSamples& given,
                        PixelClusters& clusters) {
    // The fewer samples, the larger the window.
    const int reach = given.pilot_spp > 1 ? kFieldReach - 1 : kFieldReach;
    const RowRange rows = clusters.rows();
    const auto smooth = [&](const LightField& field, const FieldPixels& open) {
        return go_down_rows(open, tracer.threads, [&] { return RowSmoother(field, rows, reach); });
    };
    smooth_lights(tracer, shadow_pixels(given.rows, given.needy, given.pilot_spp), smooth,
                  clusters);
}

}  // namespace vecino
