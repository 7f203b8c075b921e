// SPDX-License-Identifier: Apache-2.0
//
// Sampling until the samples of a pixel vary little. The three readings of the thesis's rule look
// at one pixel alone; the sound rule looks at pixels of a surface together, pass by pass.
#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "core/pixel_tracer.h"
#include "core/render_task.h"
#include "core/sample_sums.h"
#include "core/timing.h"
#include "filters/partial_frame.h"
#include "filters/plans.h"
#include "filters/variation_rules.h"

namespace vecino {
namespace {

// What a pixel's error is held against where it is nearly black: a value no screen tells from
// black.
constexpr double kLeastValue = 1e-3;
constexpr int kFewest = 16;           ///< samples before the first look
constexpr int kFewestByChance = 512;  ///< with fewer, many pixels have found no light yet

int first_look(const MethodRequest& request) {
    const bool by_chance = request.settings.light_sampling == LightSampling::none;
    const int given = request.parameters.min_spp;
    const int asked = given > 0 ? given : by_chance ? kFewestByChance : kFewest;
    const std::int64_t rounded = (std::int64_t{asked} + kStreams - 1) / kStreams * kStreams;
    return static_cast<int>(std::min<std::int64_t>(rounded, request.settings.spp));
}

/// The next look after one at n samples.
int next_look(int n, int most) {
    return static_cast<int>(std::min<std::int64_t>(2 * std::int64_t{n}, most));
}

// ---------------------------------------------------------------- the thesis's rule

using Statistic = double (*)(std::span<const glm::vec3>);

Statistic statistic_of(VariationRule rule) {
    if (rule == VariationRule::sample_difference) return sample_difference;
    return rule == VariationRule::mean_change ? mean_change : standard_error;
}

void keep_samples(const SampleBlock& block, int count, std::vector<glm::vec3>& samples) {
    for (int i = 0; i < count; ++i) {
        glm::vec3 sample;
        for (int c = 0; c < 3; ++c)
            sample[c] = block.emission[c][i] + block.direct[c][i] + block.indirect[c][i];
        samples.push_back(sample);
    }
}

MethodRender by_pixel(const MethodRequest& request, const Progress& progress) {
    PartialFrame partial(request, progress);
    const int most = request.settings.spp;
    const auto bound = static_cast<double>(request.parameters.variation_bound);
    const Statistic statistic = statistic_of(request.parameters.variation_rule);
    std::atomic<std::size_t> capped = 0;
    partial.trace_all([&](PixelTrace& pixel) {
        std::vector<glm::vec3> samples;
        int done = 0;
        for (int look = first_look(request); done < most; look = next_look(look, most)) {
            pixel.trace({done, look}, [&](const SampleBlock& block, int, int count) {
                keep_samples(block, count, samples);
            });
            done = look;
            if (done < most && statistic(samples) < bound) return;
        }
        ++capped;
    });
    return partial.finish({{"capped_share", share(capped, partial.area())}});
}

// ---------------------------------------------------------------- the sound rule

class ByScramblings {
  public:
    ByScramblings(const MethodRequest& request, const Progress& progress)
        : request_(request),
          progress_(progress),
          partial_(request, progress, VarianceOf::streams),
          sums_(partial_.size(), sum_count(VarianceOf::streams)) {}

    MethodRender run() {
        const int most = request_.settings.spp;
        PixelList active(partial_.area());
        for (std::uint32_t i = 0; i < active.size(); ++i) active[i] = i;
        int done = 0;
        for (int look = first_look(request_); !active.empty(); look = next_look(look, most)) {
            trace(active, {done, look});
            done = look;
            if (done == most) break;
            active = unfinished(active);
        }
        const auto capped = done == most ? active.size() : 0;
        return partial_.finish(
            {{"capped_share", share(capped, partial_.area())}, {"neyman_gain", neyman_gain_}});
    }

  private:
    void trace(const PixelList& pixels, SampleInterval samples) {
        const double most = request_.settings.spp;
        partial_.trace(
            pixels,
            [&](PixelTrace& pixel) {
                pixel.trace(samples);
                std::array<ExactSum::Digits, kMostSums> sums;
                pixel.sums().sums(sums);
                sums_.add(pixel.index(), sums);
                sums_.load(pixel.index(), sums);
                return pixel_values(sums, VarianceOf::streams);
            },
            stage(progress_, samples.begin / most, samples.end / most));
    }

    /// Those whose interval is too wide, and what of the given ones touches them: an interval from
    /// few samples is itself uncertain.
    PixelList unfinished(const PixelList& active) {
        std::vector<std::uint8_t> is_wide(partial_.area());
        std::vector<double> variances(active.size());  // of one sample
        PixelList places(active.size());
        for (std::uint32_t i = 0; i < places.size(); ++i) places[i] = i;
        partial_.for_each(places, [&](std::size_t i) {
            is_wide[active[i]] = is_within_bound(active[i], variances[i]) ? 0 : 1;
        });
        if (active.size() == partial_.area()) neyman_gain_ = neyman_gain(variances);
        PixelList left;
        for (const std::uint32_t pixel : active) {
            bool touches = false;
            for_neighbours(pixel, [&](std::size_t other) { touches |= is_wide[other] != 0; });
            if (touches) left.push_back(pixel);
        }
        return left;
    }

    template <class Visit>
    void for_neighbours(std::size_t pixel, const Visit& visit) const {
        const Extent size = partial_.size();
        const auto [x, y] = pixel_at(pixel, size);
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, size.height - 1); ++v) {
            for (int u = std::max(x - 1, 0); u <= std::min(x + 1, size.width - 1); ++u)
                visit(static_cast<std::size_t>(v) * static_cast<std::size_t>(size.width) +
                      static_cast<std::size_t>(u));
        }
    }

    /// Of 95 % confidence, from the pixel and its neighbours of the same surface.
    [[nodiscard]] bool is_within_bound(std::size_t pixel, double& sample_variance) const {
        const Frame& frame = partial_.frame();
        glm::dvec3 variance(0.0);
        int pooled = 0;
        for_neighbours(pixel, [&](std::size_t other) {
            if (!partial_.guide().is_same_surface(pixel, other)) return;
            const auto samples = static_cast<double>(frame.sample_count.values()[other]);
            variance += samples * glm::dvec3(frame.variance.values()[other]);
            ++pooled;
        });
        variance /= pooled;
        sample_variance = (variance.x + variance.y + variance.z) / 3;
        const double quantile = student_quantile(pooled * (kStreams - 1));
        const auto samples = static_cast<double>(frame.sample_count.values()[pixel]);
        for (int c = 0; c < 3; ++c) {
            const auto value = static_cast<double>(frame.radiance.values()[pixel][c]);
            const double allowed = static_cast<double>(request_.parameters.variation_bound) *
                                   std::sqrt(std::max(value, kLeastValue));
            if (quantile * std::sqrt(variance[c] / samples) > allowed) return false;
        }
        return true;
    }

    const MethodRequest& request_;
    const Progress& progress_;
    PartialFrame partial_;
    SampleSums sums_;
    double neyman_gain_ = 1;
};

}  // namespace

MethodRender render_variation(const MethodRequest& request, const Progress& progress) {
    if (request.parameters.variation_rule == VariationRule::scramblings)
        return ByScramblings(request, progress).run();
    return by_pixel(request, progress);
}

}  // namespace vecino
