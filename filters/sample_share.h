// SPDX-License-Identifier: Apache-2.0
//
// From how much samples of a pixel differ to how many it gets, and to the error that they leave.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "filters/pixel_needs.h"
#include "filters/surface_records_stages.h"

namespace vecino {

/// Of one sample of a pixel.
struct PixelSpread {
    float srgb;          ///< standard deviation, less what fit_half_shadow() takes of it as a rule
    bool is_fitted;      ///< in the middle of a wide half-shadow: that rule holds
    bool is_clear_edge;  ///< between surfaces; emitters are looked at one by one
    bool is_clipped;     ///< some of it may be too bright to be shown: by one sample all or none
};

/// Powers of two: Sobol points are best in such numbers.
inline std::uint32_t power_of_two_near(float samples) {
    return 1u << static_cast<unsigned>(std::lround(std::log2(samples)));
}

/// Who gets how many.
class SampleShare {
  public:
    /// mean_spread: of needy pixels, > 0.
    SampleShare(double mean_spread, int edge_spp, int pilot_spp)
        : per_spread_(static_cast<float>(edge_spp) / static_cast<float>(mean_spread)),
          least_of_edges_(least_of_edges(edge_spp, pilot_spp)),
          most_(kMany * static_cast<float>(std::max(edge_spp, 1))),
          fewest_wanted_(fewest_wanted(pilot_spp)) {
        constexpr float kOfUnfitted = 0.75f;
        const float few = kMany / std::max(static_cast<float>(edge_spp), kMany);
        unfitted_ = kOfUnfitted * few * few;
    }

    [[nodiscard]] std::uint32_t of(const PixelSpread& spread) const {
        const float wanted = spread.srgb * per_spread_;
        const bool few = spread.is_clear_edge && !spread.is_clipped;
        const float least = few ? least_of_edges_ : kMany;
        const float fewest = fewest_wanted_ * (least / kMany) * (spread.is_fitted ? 1 : unfitted_);
        if (wanted < fewest && !spread.is_clipped) return 0;
        return power_of_two_near(std::clamp(wanted, least, std::max(least, most_)));
    }

  private:
    static constexpr auto kMany = static_cast<float>(kOwnPacketSpp);

    /// The least that a pixel gets, if any: half-shadow is smooth with fewer.
    static float least_of_edges(int edge_spp, int pilot_spp) {
        constexpr float kFewest = 4;
        const auto least = static_cast<float>(std::max(edge_spp, 2 * pilot_spp));
        return std::clamp(least, kFewest, kMany);
    }

    /// A pixel that wants fewer is left with its first samples: the least that it could get, with
    /// what a pixel takes to begin with, take more of the error elsewhere. The fewer first ones,
    /// the more.
    static float fewest_wanted(int pilot_spp) {
        constexpr float kOfOne = 4, kPower = 0.75f;
        return std::min(kOfOne * std::pow(static_cast<float>(pilot_spp), kPower), kMany);
    }

    float per_spread_, least_of_edges_, most_;
    float fewest_wanted_;
    // What is told of a pixel's error by a few samples is often too little: the more samples there
    // are, the less is left to that. Only of a wide half-shadow those around tell what they do not.
    float unfitted_;
};

/// Of a pixel's error, what its samples leave: Sobol points. Measured on the scenes of this
/// repository, by kinds of pixels.
class NoiseLeft {
  public:
    explicit NoiseLeft(int pilot_spp)
        : of_pilot_(after(pilot_spp)), of_smooth_pilot_(smooth_after(pilot_spp)) {
        for (int k = 0; k < kPowers; ++k) by_power_[k] = after(std::exp2(k));
    }

    /// samples: a power of two.
    [[nodiscard]] double of(std::uint32_t samples) const {
        return by_power_[std::countr_zero(samples)];
    }
    /// Of first samples alone: half-shadow is smoothed.
    [[nodiscard]] double of_pilot(std::uint8_t needs) const {
        return (needs & kNeedsCoverage) != 0 ? of_pilot_ : of_smooth_pilot_;
    }

    /// Where there is half-shadow there is some that first samples do not show.
    [[nodiscard]] double missed() const {
        constexpr double kShare = 0.03;
        return kShare * of_smooth_pilot_;
    }

  private:
    static constexpr int kPowers = 32;
    static double after(double samples) {
        constexpr double kOfOne = 0.35, kSlope = 1.2;
        return kOfOne * std::pow(samples, -kSlope);
    }

    static double smooth_after(double samples) {
        constexpr double kOfOne = 0.2, kSlope = 1.4;
        return kOfOne * std::pow(samples, -kSlope);
    }

    double of_pilot_, of_smooth_pilot_;
    double by_power_[kPowers];
};

}  // namespace vecino
