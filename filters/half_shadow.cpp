// SPDX-License-Identifier: Apache-2.0
#include "filters/half_shadow.h"

#include <algorithm>
#include <vector>

#include "core/clones.h"
#include "core/parallel.h"

namespace vecino {
namespace {

constexpr int kLanes = kPilotPixels;
constexpr int kMostReach = 3;         ///< of the window, in pixels to each side
constexpr float kSameSurface = 0.9f;  ///< cosine between normals
constexpr int kNothing = -2;          ///< object of a pixel that has no value
constexpr int kChannels = 3;          ///< of light by picked emitters; else the first alone

float luminance(float r, float g, float b) {
    return 0.2126f * r + 0.7152f * g + 0.0722f * b;
}

/// What pixels of a row saw of a light; from kMostReach before the first pixel on.
struct FieldRow {
    std::vector<std::int32_t> object;
    std::vector<float> normal[3];
    std::vector<float> value;               ///< that decides what is noise
    std::vector<float> channel[kChannels];  ///< what is averaged
    std::vector<float> right, below;        ///< squared difference to that neighbour; < 0: no such

    void resize(std::size_t size) {
        object.assign(size, kNothing);
        for (auto* plane :
             {&normal[0], &normal[1], &normal[2], &value, &channel[0], &channel[1], &channel[2]}) {
            plane->assign(size, 0.0f);
        }
        right.assign(size, -1.0f);
        below.assign(size, -1.0f);
    }
};

/// Of pixel x >= -kMostReach in a FieldRow.
std::size_t index_of(int x) {
    return static_cast<std::size_t>(x) + std::size_t{kMostReach};
}

/// Sums over the windows of pixels side by side.
struct LaneSums {
    alignas(64) float count[kLanes];
    float squares[kLanes], sum[kLanes], channel[kChannels][kLanes];
    float differences[kLanes], pairs[kLanes];
};

/// Where pixels are in their row, and those that are added to them in theirs.
struct Places {
    std::size_t at, from;
};

VECINO_CLONES void add_pixels(const FieldRow& own, const FieldRow& row, const Places& places,
                              LaneSums& sums) {
    const std::size_t at = places.at, from = places.from;
    for (std::size_t i = 0; i < kLanes; ++i) {
        const float cosine = own.normal[0].data()[at + i] * row.normal[0].data()[from + i] +
                             own.normal[1].data()[at + i] * row.normal[1].data()[from + i] +
                             own.normal[2].data()[at + i] * row.normal[2].data()[from + i];
        const bool like =
            (own.object.data()[at + i] == row.object.data()[from + i]) & (cosine > kSameSurface);
        const float weight = like ? 1.0f : 0.0f;
        const float value = row.value.data()[from + i];
        sums.count[i] += weight;
        sums.sum[i] += weight * value;
        sums.squares[i] += weight * value * value;
        for (int c = 0; c < kChannels; ++c)
            sums.channel[c][i] += weight * row.channel[c].data()[from + i];
        const float right = row.right.data()[from + i], below = row.below.data()[from + i];
        const float of_right = like & (right >= 0.0f) ? 1.0f : 0.0f;
        const float of_below = like & (below >= 0.0f) ? 1.0f : 0.0f;
        sums.differences[i] += of_right * right + of_below * below;
        sums.pairs[i] += of_right + of_below;
    }
}

/// How far a value is to be replaced by the mean. Of noise, neighbours differ by as much as any two
/// pixels do; on both sides of an edge they are alike.
float grain(const LaneSums& sums, std::size_t i) {
    constexpr float kEdge = 0.45f, kNoise = 0.75f;
    const float mean = sums.sum[i] / sums.count[i];
    const float variance = sums.squares[i] / sums.count[i] - mean * mean;
    if (!(sums.pairs[i] > 0) || !(variance > 1e-12f * mean * mean)) return 0;
    const float ratio = sums.differences[i] / sums.pairs[i] / (2 * variance);
    return std::clamp((ratio - kEdge) / (kNoise - kEdge), 0.0f, 1.0f);
}

/// A light, or all of them where each sample picks one.
class LightField {
  public:
    LightField(const PixelClusters& clusters, int light, bool picks)
        : clusters_(clusters), light_(light), picks_(picks) {}

    [[nodiscard]] int light() const { return light_; }
    [[nodiscard]] bool picks() const { return picks_; }

    void read(int y, FieldRow& row) const {
        const RowRange rows = clusters_.rows();
        const auto width = static_cast<std::size_t>(clusters_.width());
        row.resize(width + 2 * kMostReach + kLanes);
        if (y < rows.begin || y >= rows.end) return;
        for (int x = 0; x < clusters_.width(); ++x) read_pixel(x, y, row);
        for (std::size_t i = kMostReach; i + 1 < kMostReach + width; ++i) {
            if (row.object[i] != kNothing && row.object[i] == row.object[i + 1])
                row.right[i] = squared(row.value[i] - row.value[i + 1]);
        }
    }

    static void compare(FieldRow& row, const FieldRow& next) {
        for (std::size_t i = 0; i < row.object.size(); ++i) {
            if (row.object[i] != kNothing && row.object[i] == next.object[i])
                row.below[i] = squared(row.value[i] - next.value[i]);
        }
    }

  private:
    static float squared(float v) { return v * v; }

    void read_pixel(int x, int y, FieldRow& row) const {
        const PilotBlock& block = clusters_.block(x, y);
        const PilotLight* const lights = clusters_.lights(x, y);
        const int lane = x % kLanes;
        const float samples = picks_ ? block.shadow_count[lane] : lights[light_].open[lane];
        if (block.object[lane] < 0 || !(samples > 0) || clusters_.list(x, y) != nullptr) return;
        const auto i = index_of(x);
        row.object[i] = block.object[lane];
        for (int c = 0; c < 3; ++c) row.normal[c][i] = block.first_normal[c][lane];
        if (picks_) {
            const float rgb[] = {lights[0].exact[lane], lights[0].open[lane], lights[0].seen[lane]};
            for (int c = 0; c < 3; ++c) row.channel[c][i] = rgb[c] / samples;
            row.value[i] = luminance(rgb[0], rgb[1], rgb[2]) / samples;
        } else {
            row.value[i] = std::min(lights[light_].seen[lane] / samples, 1.0f);
            row.channel[0][i] = row.value[i];
        }
    }

    const PixelClusters& clusters_;
    int light_;
    bool picks_;
};

struct Smoothed {
    int x;
    float channel[kChannels];
};

/// Goes down rows with those around at hand.
class RowSmoother {
  public:
    RowSmoother(const LightField& field, int reach, int first)
        : field_(field), reach_(reach), window_(static_cast<std::size_t>(2 * reach + 2)) {
        for (int dy = -reach; dy <= reach; ++dy) load(first + dy);
    }

    std::vector<Smoothed> next(int y, const std::vector<int>& pixels) {
        load(y + reach_ + 1);
        std::vector<Smoothed> out;
        LaneSums sums;
        int summed = -1;  // block
        for (const int x : pixels) {
            if (x / kLanes != summed) {
                summed = x / kLanes;
                sums = sums_of(y, summed * kLanes);
            }
            const auto i = static_cast<std::size_t>(x % kLanes);
            const FieldRow& own = row(y);
            const auto at = index_of(x);
            if (own.object[at] == kNothing) continue;
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
    FieldRow& row(int y) {
        const int size = static_cast<int>(window_.size());
        return window_[static_cast<std::size_t>((y % size + size) % size)];
    }

    void load(int y) {
        field_.read(y, row(y));
        if (!row(y - 1).object.empty()) LightField::compare(row(y - 1), row(y));
    }

    LaneSums sums_of(int y, int x) {
        LaneSums sums{};
        const auto at = index_of(x);
        for (int dy = -reach_; dy <= reach_; ++dy) {
            for (int dx = -reach_; dx <= reach_; ++dx) {
                add_pixels(row(y), row(y + dy), {at, index_of(x + dx)}, sums);
            }
        }
        return sums;
    }

    const LightField& field_;
    int reach_;
    std::vector<FieldRow> window_;  ///< by row, around and around
};

using SmoothedRows = std::vector<std::vector<Smoothed>>;

struct OpenPixels {
    RowRange rows;
    std::vector<std::vector<int>> x;  ///< by row
};

/// Those that get no further samples.
OpenPixels open_pixels(const GivenSamples& given) {
    const NeedyRows& needy = given.needy;
    OpenPixels open{given.rows, std::vector<std::vector<int>>(needy.size())};
    for (std::size_t r = 0; r < needy.size(); ++r) {
        for (const NeedyPixel& pixel : needy[r]) {
            const bool sampled = pixel.samples > static_cast<std::uint32_t>(given.pilot_spp);
            if (!sampled && (pixel.needs & kNeedsShadow) != 0) open.x[r].push_back(pixel.x);
        }
    }
    return open;
}

SmoothedRows smooth(const LightField& field, const OpenPixels& open, int reach, int threads) {
    constexpr std::size_t kRowsPerBlock = 32;
    SmoothedRows out(open.x.size());
    for_each_block(out.size(), kRowsPerBlock, threads, [&](BlockRange block) {
        const auto y_of = [&](std::size_t r) { return open.rows.begin + static_cast<int>(r); };
        RowSmoother smoother(field, reach, y_of(block.begin));
        for (std::size_t r = block.begin; r < block.end; ++r)
            out[r] = smoother.next(y_of(r), open.x[r]);
    });
    return out;
}

void store_pixel(const LightField& field, const Smoothed& pixel, int y, PixelClusters& clusters) {
    Cluster cluster = clusters.first_cluster(pixel.x, y);
    if (field.picks()) {
        for (int c = 0; c < kChannels; ++c)
            cluster.picked[c] = pixel.channel[c] * cluster.shadow_count;
    } else {
        LightSums& sums = cluster.lights[field.light()];
        sums.seen = pixel.channel[0] * sums.open;
    }
    clusters.store_first(pixel.x, y, cluster);
}

}  // namespace

void smooth_half_shadow(const RecordTracer& tracer, const GivenSamples& given,
                        PixelClusters& clusters) {
    const OpenPixels open = open_pixels(given);
    if (std::ranges::all_of(open.x, [](const auto& row) { return row.empty(); })) return;
    const bool picks = tracer.task.light_count > static_cast<std::uint32_t>(kMostExactLights);
    const int lights = picks ? 1 : static_cast<int>(tracer.task.light_count);
    // The fewer samples, the larger the window.
    const int reach = given.pilot_spp > 1 ? kMostReach - 1 : kMostReach;
    for (int l = 0; l < lights; ++l) {
        const LightField field(clusters, l, picks);
        const SmoothedRows smoothed = smooth(field, open, reach, tracer.threads);
        // Only now: pixels are smoothed by what their neighbours saw themselves.
        for_each_block(smoothed.size(), 1, tracer.threads, [&](BlockRange block) {
            for (const Smoothed& pixel : smoothed[block.begin])
                store_pixel(field, pixel, open.rows.begin + static_cast<int>(block.begin),
                            clusters);
        });
    }
}

}  // namespace vecino
