// SPDX-License-Identifier: Apache-2.0
//
// Variance and bias apart: what renders that differ in their seed alone say about how much of their
// error another seed would change. With X_i the image of seed i of n and R the reference, and all
// means over pixels and channels:
//   mse_i   mean of w (X_i - R)^2
//   noise   mean of w (sample variance over seeds): unbiased, and the same as half of the mean of
//           w (X_i - X_j)^2 over all pairs of seeds
//   bias2   mean over seeds of mse_i, less noise: an unbiased estimate of w (expected X - R)^2, and
//           the same as the error of the mean image less noise/n. It still holds the reference's
//           own error, which without_reference takes off, and can be below 0 where there is little
//           bias.
// Mean over seeds of mse = bias2 + noise, always. In two spaces: of display values (clipped to
// [0,1], sRGB-encoded) with w = 1, which splits the error behind psnr_float_db, and of linear
// values with w = 1 / (R^2 + 0.01), which splits relmse.
#pragma once

#include <array>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/json_read.h"
#include "eval/regions.h"

namespace vecino {

/// An error and its two parts, in one space.
struct ErrorSplit {
    std::vector<double> mse;      ///< by seed; empty without pixels
    std::optional<double> noise;  ///< none below 2 seeds, or without pixels
    std::optional<double> bias2;  ///< none where noise is
    // Jackknife pseudo-values, for estimate(): their means are noise and bias2, and their spread
    // tells how sure those are. Empty below 3 seeds, or without pixels.
    std::vector<double> noise_by_seed;  ///< n noise - (n - 1) (noise without seed i)
    std::vector<double> bias2_by_seed;  ///< mse_i - noise_by_seed_i

    /// The same with the reference's own mean squared error taken off bias2: unbiased towards what
    /// a perfect reference would say.
    [[nodiscard]] ErrorSplit without_reference(double reference_mse) const;

    friend bool operator==(const ErrorSplit&, const ErrorSplit&) = default;
};

/// The split of display values, and beside it that of relmse.
struct SeedStatistics : ErrorSplit {
    std::size_t pixels = 0;
    ErrorSplit relative;

    friend bool operator==(const SeedStatistics&, const SeedStatistics&) = default;
};

/// A row of what is shown of a split.
struct SplitInfo {
    std::string_view name;     ///< of the column
    std::string_view formula;  ///< one line
};

/// Columns of summaries: variance and bias of psnr_float_db's error, then of relmse.
inline constexpr std::array<SplitInfo, 4> kSplitColumns = {{
    {"noise",
     "10 log10(1 / V) dB, V = mean over pixels and channels of the sample variance over seeds of "
     "display values: the part of psnr_float_db's error that another seed changes"},
    {"bias",
     "10 log10(1 / B) dB, B = mean over seeds of (x-r)^2 - V - E, E the reference's own error: the "
     "part of psnr_float_db's error that no seed changes, with what clipping and encoding make of "
     "noise; none where B is not above 0"},
    {"relmse noise", "mean of (sample variance over seeds) / (r^2 + 0.01), linear"},
    {"relmse bias", "relmse - relmse noise - that of the reference's own error"},
}};

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

/// {"pixels":, "mse": [...], "noise":, "bias2":, "noise_by_seed": [...], "bias2_by_seed": [...],
/// "relative": {the same without "pixels"}}, null for none; with regions also "regions":
/// {"emitter": {the same}, ...}.
nlohmann::json seed_statistics_json(const SeedStatisticsByRegion& statistics);

/// Reads what seed_statistics_json made, bit for bit; other keys play no part. Throws Error(usage)
/// naming what is missing or of another type.
SeedStatisticsByRegion read_seed_statistics(const JsonValue& json);

}  // namespace vecino
