// SPDX-License-Identifier: Apache-2.0
#include "eval/unbiased.h"

#include <algorithm>
#include <cmath>

#include "eval/distributions.h"
#include "eval/pixel_values.h"

namespace vecino {
namespace {

/// A t this small is not the worst of many: its p is not worth computing.
constexpr double kSmall = 2.5;
constexpr std::size_t kMany = 1000;

/// Sums over the pixels of a test, of one channel.
struct Sums {
    double difference = 0;
    double magnitude = 0;  ///< of the values: what rounding is relative to
    double variance = 0;
    double satterthwaite = 0;  ///< of variance^2 / degrees of freedom

    void add(double a, double b) {
        difference += a - b;
        magnitude += std::abs(a) + std::abs(b);
    }
    void add_variance(double of_mean, double degrees) {
        variance += of_mean;
        satterthwaite += of_mean * of_mean / degrees;
    }

    /// Without noise on either side only rounding may tell them apart.
    [[nodiscard]] bool differs_beyond_rounding() const {
        return std::abs(difference) > 1e-6 * magnitude;
    }
    [[nodiscard]] double t() const { return std::abs(difference) / std::sqrt(variance); }
    [[nodiscard]] double p() const {
        if (!(variance > 0)) return differs_beyond_rounding() ? 0 : 1;
        return 2 * student_tail(t(), variance * variance / satterthwaite);
    }
};

double degrees_of(const NoisyImage& image, int x, int y) {
    const double estimates = image.streams > 0 ? static_cast<double>(image.streams)
                                               : static_cast<double>(image.sample_count(x, y));
    return std::max(1.0, estimates - 1);
}

Sums sums_over(const NoisyImage& a, const NoisyImage& b, glm::ivec2 first, glm::ivec2 last,
               int channel) {
    Sums sums;
    for (int y = first.y; y < last.y; ++y) {
        for (int x = first.x; x < last.x; ++x) {
            sums.add(static_cast<double>(a.mean(x, y)[channel]),
                     static_cast<double>(b.mean(x, y)[channel]));
            for (const NoisyImage* image : {&a, &b})
                sums.add_variance(static_cast<double>(image->variance(x, y)[channel]),
                                  degrees_of(*image, x, y));
        }
    }
    return sums;
}

void take(UnbiasedRule& rule, const Sums& sums, glm::ivec2 first, glm::ivec2 last, int channel) {
    const bool is_small = sums.variance > 0 && sums.t() < kSmall;
    if (is_small && rule.tests > kMany && rule.least_p < 1) return;
    const double p = sums.p();
    if (p >= rule.least_p) return;
    const double pixels = (last.x - first.x) * (last.y - first.y);
    rule.least_p = p;
    rule.where = first;
    rule.channel = channel;
    rule.difference = sums.difference / pixels;
    rule.standard_error = std::sqrt(sums.variance) / pixels;
}

/// The chance per test with which so many of them have that chance together.
double sidak(double level, std::size_t tests) {
    return -std::expm1(std::log1p(-level) / static_cast<double>(tests));
}

UnbiasedRule test_tiles(const NoisyImage& a, const NoisyImage& b, std::string_view name,
                        glm::ivec2 tile) {
    const glm::ivec2 size(a.mean.size().width, a.mean.size().height);
    const glm::ivec2 tiles = (size + tile - 1) / tile;
    UnbiasedRule rule;
    rule.name = name;
    rule.tests = 3 * static_cast<std::size_t>(tiles.x) * static_cast<std::size_t>(tiles.y);
    for (int y = 0; y < size.y; y += tile.y) {
        for (int x = 0; x < size.x; x += tile.x) {
            const glm::ivec2 first(x, y);
            const glm::ivec2 last(std::min(x + tile.x, size.x), std::min(y + tile.y, size.y));
            for (int c = 0; c < 3; ++c) take(rule, sums_over(a, b, first, last, c), first, last, c);
        }
    }
    return rule;
}

}  // namespace

std::vector<UnbiasedRule> test_unbiased(const NoisyImage& a, const NoisyImage& b, double level) {
    require_comparable(a.mean, b.mean);
    const glm::ivec2 all(a.mean.size().width, a.mean.size().height);
    std::vector<UnbiasedRule> rules{test_tiles(a, b, "pixel", {1, 1}),
                                    test_tiles(a, b, "block", {16, 16}),
                                    test_tiles(a, b, "image", all)};
    for (UnbiasedRule& rule : rules) rule.limit_p = sidak(sidak(level, rules.size()), rule.tests);
    return rules;
}

}  // namespace vecino
