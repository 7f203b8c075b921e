// SPDX-License-Identifier: Apache-2.0
#include "filters/needed_samples.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/color.h"
#include "core/parallel.h"
#include "filters/records.h"

namespace vecino {
namespace {

/// What is known of the light of a needy pixel.
struct PixelEstimate {
    glm::vec3 mean{0.0f};                    ///< radiance
    glm::vec3 variance{0.0f};                ///< between its surfaces
    glm::vec3 emitters[kMostExactLights]{};  ///< radiance that hangs on each emitter's visibility
    float in_sight[kMostExactLights]{};      ///< share of it that is in sight
    float picked = 0, picked_square = 0;     ///< luminance by picked emitters: sums
    float samples = 0;
};

float luminance(glm::vec3 v) {
    return vecino::luminance(v.x, v.y, v.z);
}

glm::vec3 vector(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

class Estimator {
  public:
    explicit Estimator(const NeedInputs& inputs)
        : inputs_(inputs), task_(inputs.tracer.task), picks_(picks_lights(task_)) {}

    [[nodiscard]] PixelEstimate estimate(int x, int y) const {
        PixelEstimate out;
        glm::vec3 squares(0.0f);
        inputs_.clusters.visit(x, y, [&](const Cluster& cluster) {
            const ClusterMeans means = means_of(cluster);
            const glm::vec3 light = light_of(cluster, means, x, y);
            out.mean += light * cluster.count;
            squares += light * light * cluster.count;
            out.samples += cluster.count;
            if (picks_) {
                add_picked(cluster, means, out);
            } else {
                add_emitters(cluster, means, out);
            }
        });
        const float share = 1.0f / out.samples;
        out.mean *= share;
        out.variance = glm::max(squares * share - out.mean * out.mean, glm::vec3(0.0f));
        for (std::uint32_t i = 0; !picks_ && i < task_.light_count; ++i) {
            const float whole = luminance(out.emitters[i]);
            out.in_sight[i] = whole > 0 ? out.in_sight[i] / whole : 0.0f;
            out.emitters[i] *= share;
        }
        return out;
    }

  private:
    [[nodiscard]] glm::vec3 light_of(const Cluster& cluster, const ClusterMeans& means, int x,
                                     int y) const {
        if (cluster.object < 0 || task_.max_depth < 1) return means.emission;
        RecordValue records;
        rough_light(inputs_.records, {x, y, cluster.object, means.position, means.normal}, records);
        const glm::vec3 indirect =
            inputs_.ambient +
            glm::vec3(records[0] + records[3], records[1] + records[4], records[2] + records[5]);
        return means.emission + means.albedo * (direct_light(task_, cluster) + indirect);
    }

    void add_emitters(const Cluster& cluster, const ClusterMeans& means, PixelEstimate& out) const {
        for (std::uint32_t i = 0; i < task_.light_count; ++i) {
            const LightSums& sums = cluster.lights[i];
            const glm::vec3 whole = means.albedo * vector(task_.lights[i].radiance) * sums.exact;
            out.emitters[i] += whole;
            out.in_sight[i] += luminance(whole) * share_in_sight(sums);
        }
    }

    static void add_picked(const Cluster& cluster, const ClusterMeans& means, PixelEstimate& out) {
        const float albedo = luminance(means.albedo);
        out.picked += albedo * luminance(vector(cluster.picked));
        out.picked_square += albedo * albedo * cluster.picked_square;
    }

    const NeedInputs& inputs_;
    const TraceTask& task_;
    bool picks_;
};

/// What is too bright to be shown counts less and less.
float shown_slope(float light) {
    const float slope = srgb_slope(light);
    return light > 1.0f ? slope / (light * light) : slope;
}

/// Standard deviation of one sample of a pixel in sRGB, from the pixel and its needy neighbours.
class Spread {
  public:
    Spread(const PixelEstimate& own, std::uint8_t needs, int lights, bool picks)
        : own_(own),
          needs_(needs),
          lights_(lights),
          picks_(picks),
          weight_(own.samples),
          mean_(own.mean * own.samples),
          square_((own.variance + own.mean * own.mean) * own.samples),
          picked_(own.picked),
          picked_square_(own.picked_square),
          picked_samples_(own.samples) {
        for (int i = 0; i < lights; ++i) in_sight_[i] = own.in_sight[i] * own.samples;
    }

    void add_neighbour(const PixelEstimate& other) {
        constexpr float kWeight = 0.25f;  // of one sample
        weight_ += kWeight;
        mean_ += other.mean * kWeight;
        square_ += (other.variance + other.mean * other.mean) * kWeight;
        for (int i = 0; i < lights_; ++i) in_sight_[i] += other.in_sight[i] * kWeight;
        picked_ += other.picked;
        picked_square_ += other.picked_square;
        picked_samples_ += other.samples;
    }

    [[nodiscard]] PixelSpread of_one_sample() const {
        // Of it, where fit_half_shadow() makes use of the pixels around; of a narrow one, as far as
        // it is not a hard edge.
        constexpr float kWide = 0.4f, kNarrow = 0.6f;
        const bool shared = (needs_ & kNeedsCoverage) != 0;
        const bool fitted = (needs_ & kWideShadow) != 0 && !shared;
        const glm::vec3 mean = mean_ / weight_;
        glm::vec3 variance(0.0f);
        if (shared) variance += glm::max(square_ / weight_ - mean * mean, glm::vec3(0.0f));
        for (int i = 0; (needs_ & kNeedsShadow) != 0 && i < lights_; ++i) {
            const float v = (in_sight_[i] + 0.25f) / (weight_ + 0.5f);
            variance += own_.emitters[i] * own_.emitters[i] * (v * (1.0f - v));
        }
        if (picks_) {
            const float picked = picked_ / picked_samples_;
            variance +=
                glm::vec3(std::max(picked_square_ / picked_samples_ - picked * picked, 0.0f));
        }
        float sum = 0;
        bool clipped = false;
        for (int c = 0; c < 3; ++c) {
            clipped |= shared && mean[c] > 1.0f;
            const float slope = shown_slope(mean[c]);
            sum += variance[c] * slope * slope;
        }
        const float left = shared ? 1.0f : fitted ? kWide : kNarrow;
        return {std::sqrt(sum) * left, fitted, shared && !picks_, clipped};
    }

  private:
    const PixelEstimate& own_;
    std::uint8_t needs_;
    int lights_;
    bool picks_;
    float weight_;
    glm::vec3 mean_, square_;
    float in_sight_[kMostExactLights]{};
    float picked_, picked_square_, picked_samples_;
};

using EstimateRow = std::vector<PixelEstimate>;
using SpreadRows = std::vector<std::vector<PixelSpread>>;

/// A row of needy pixels and what is known of them.
struct KnownRow {
    const std::vector<NeedyPixel>* needy = nullptr;  ///< null: there is no such row
    EstimateRow estimates;
    std::size_t first = 0;  ///< of those that are not yet left behind
};

/// Goes down rows, with those above and below at hand: estimates of all rows would be more than
/// caches hold.
class SpreadFinder {
  public:
    /// needy: of rows. Begins at row number first of these.
    SpreadFinder(const NeedInputs& inputs, RowRange rows, const NeedyRows& needy, std::size_t first)
        : estimator_(inputs),
          picks_(picks_lights(inputs.tracer.task)),
          lights_(picks_ ? 0 : static_cast<int>(inputs.tracer.task.light_count)),
          rows_(rows),
          needy_(needy) {
        if (first > 0) know(first - 1, known_[0]);
        know(first, known_[1]);
    }

    /// Of row number r, the next one.
    std::vector<PixelSpread> next(std::size_t r) {
        know(r + 1, known_[2]);
        for (KnownRow& row : known_) row.first = 0;
        std::vector<PixelSpread> spreads;
        spreads.reserve(needy_[r].size());
        for (std::size_t i = 0; i < needy_[r].size(); ++i) spreads.push_back(spread(i));
        std::rotate(std::begin(known_), std::begin(known_) + 1, std::end(known_));
        return spreads;
    }

  private:
    void know(std::size_t r, KnownRow& row) const {
        row.estimates.clear();
        row.needy = r < needy_.size() ? &needy_[r] : nullptr;
        if (row.needy == nullptr) return;
        for (const NeedyPixel& pixel : *row.needy) {
            row.estimates.push_back(
                estimator_.estimate(pixel.x, rows_.begin + static_cast<int>(r)));
        }
    }

    PixelSpread spread(std::size_t i) {
        const NeedyPixel& pixel = (*known_[1].needy)[i];
        Spread spread(known_[1].estimates[i], pixel.needs, lights_, picks_);
        for (KnownRow& row : known_) {
            if (row.needy == nullptr) continue;
            const std::vector<NeedyPixel>& needy = *row.needy;
            while (row.first < needy.size() && needy[row.first].x < pixel.x - 1) ++row.first;
            for (std::size_t k = row.first; k < needy.size() && needy[k].x <= pixel.x + 1; ++k) {
                if (&needy[k] != &pixel) spread.add_neighbour(row.estimates[k]);
            }
        }
        return spread.of_one_sample();
    }

    Estimator estimator_;
    bool picks_;
    int lights_;
    RowRange rows_;
    const NeedyRows& needy_;
    KnownRow known_[3];  ///< above, own, below
};

SpreadRows spread_all(const NeedInputs& inputs, RowRange rows, const NeedyRows& needy) {
    constexpr std::size_t kRowsPerBlock = 16;
    SpreadRows spreads(needy.size());
    for_each_block(needy.size(), kRowsPerBlock, inputs.tracer.threads, [&](BlockRange block) {
        SpreadFinder finder(inputs, rows, needy, block.begin);
        for (std::size_t r = block.begin; r < block.end; ++r) spreads[r] = finder.next(r);
    });
    return spreads;
}

double mean_of(const SpreadRows& spreads) {
    double sum = 0;
    std::size_t count = 0;
    for (const auto& row : spreads) {
        for (const PixelSpread& spread : row) sum += static_cast<double>(spread.srgb);
        count += row.size();
    }
    return count > 0 ? sum / static_cast<double>(count) : 0.0;
}

}  // namespace

NeededSamples::NeededSamples(const NeedInputs& inputs, RowRange rows, const NeedyRows& needy)
    : spreads_(spread_all(inputs, rows, needy)),
      mean_(mean_of(spreads_)),
      pilot_spp_(inputs.pilot_spp) {}

std::uint32_t NeededSamples::samples(std::size_t row, std::size_t i, int edge_spp) const {
    return mean_ > 0 ? SampleShare(mean_, edge_spp, pilot_spp_).of(spreads_[row][i]) : 0;
}

NeededSamples::Outlook NeededSamples::outlook(const NeedyRows& needy,
                                              const Question& question) const {
    Outlook out;
    if (!(mean_ > 0)) return out;
    const SampleShare share(mean_, question.edge_spp, question.pilot_spp);
    const NoiseLeft noise(question.pilot_spp);
    const auto pilot = static_cast<std::uint32_t>(question.pilot_spp);
    std::size_t skipped = 0;
    for (std::size_t r = 0; r < spreads_.size(); ++r) {
        for (; skipped < spreads_[r].size(); skipped += question.one_of) {
            const PixelSpread& spread = spreads_[r][skipped];
            const std::uint8_t needs = needy[r][skipped].needs;
            const std::uint32_t given = share.of(spread);
            const double square = static_cast<double>(spread.srgb * spread.srgb) / 3;
            out.error += square * (given > pilot ? noise.of(given) : noise.of_pilot(needs));
            if ((needs & kNeedsCoverage) == 0) out.error += square * noise.missed();
            if (given > pilot) out.work += further_work(given, pilot);
            if ((needs & kNeedsShadow) != 0) out.work += kSmoothingWork;
            ++out.pixels;
        }
        skipped -= spreads_[r].size();
    }
    return out;
}

void NeededSamples::give(int edge_spp, NeedyRows& needy) const {
    for (std::size_t r = 0; r < needy.size(); ++r) {
        for (std::size_t i = 0; i < needy[r].size(); ++i)
            needy[r][i].samples = samples(r, i, edge_spp);
    }
}

}  // namespace vecino
