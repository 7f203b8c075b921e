// SPDX-License-Identifier: Apache-2.0
//
// Noise and bias apart: what renders that differ in their seed alone say about how much of their
// error another seed would change. All errors are means over pixels and channels of squares of
// display values (clipped to [0,1], sRGB-encoded): the mean squared error behind psnr_float_db.
//
// With X_i the image of seed i of n and R the reference:
//   mse_i   mean (X_i - R)^2
//   noise   mean over pixels and channels of the sample variance over seeds; unbiased, and the same
//           as half of the mean of (X_i - X_j)^2 over all pairs of seeds
//   bias2   mean over seeds of mse_i, less noise: an unbiased estimate of the squared bias. It
//           includes the reference's own error, and can be below 0 where there is little bias.
// One is of linear values, as relMSE is, of which it is the part that noise makes:
//   relative_variance   mean of (sample variance over seeds) / (R^2 + 0.01)
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/json_read.h"
#include "eval/regions.h"

namespace vecino {

struct SeedStatistics {
    std::size_t pixels = 0;
    std::vector<double> mse;                  ///< by seed; empty without pixels
    std::optional<double> noise;              ///< none below 2 seeds, or without pixels
    std::optional<double> bias2;              ///< none where noise is
    std::optional<double> relative_variance;  ///< none where noise is
    // Jackknife pseudo-values, for estimate(): their means are noise and bias2, and their spread
    // tells how sure those are. Empty below 3 seeds, or without pixels.
    std::vector<double> noise_by_seed;  ///< n noise - (n - 1) (noise without seed i)
    std::vector<double> bias2_by_seed;  ///< mse_i - noise_by_seed_i

    friend bool operator==(const SeedStatistics&, const SeedStatistics&) = default;
};

struct SeedStatisticsByRegion {
    SeedStatistics whole;
    std::optional<PerRegion<SeedStatistics>> regions;  ///< none: no regions were given

    friend bool operator==(const SeedStatisticsByRegion&, const SeedStatisticsByRegion&) = default;
};

/// Of linear RGB images, one per seed. None when there is no image, or when a value of an image or
/// of the reference is not finite: such a group is never scored. Throws Error(mismatch) when sizes
/// differ, naming them. The same bits on every call.
std::optional<SeedStatisticsByRegion> seed_statistics(std::span<const Image> images,
                                                      const Image& reference,
                                                      const RegionMap* regions = nullptr);

/// {"pixels":, "mse": [...], "noise":, "bias2":, "relative_variance":, "noise_by_seed": [...],
/// "bias2_by_seed": [...]}, null for none; with regions also "regions": {"emitter": {the same},
/// ...}.
nlohmann::json seed_statistics_json(const SeedStatisticsByRegion& statistics);

/// Reads what seed_statistics_json made, bit for bit; other keys play no part. Throws Error(usage)
/// naming what is missing or of another type.
SeedStatisticsByRegion read_seed_statistics(const JsonValue& json);

}  // namespace vecino
