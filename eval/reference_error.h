// SPDX-License-Identifier: Apache-2.0
//
// A reference's own error, in the metrics that it is told in, and whether it is what limits a
// result. As JSON, as rows of results.jsonl hold it:
//   {"source": "halves", "psnr_float_db":, "relmse":, "regions": {"edge": {"psnr_float_db":,
//   "relmse":}, ...}}
// psnr_float_db is null where there is no error to tell, or the region has no pixels; the whole is
// null where nothing is known. Sources: "halves", of two renders with independent seeds;
// "variance", of the file's Variance planes.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "core/frame.h"
#include "eval/regions.h"

namespace vecino {

/// Two independent renders that a reference is the mean of.
struct HalfPair {
    const Image& first;
    const Image& second;
    double second_weight = 0.5;  ///< share of the second in the mean, above 0 and below 1
};

/// Of the mean of two halves whose squared errors are s/n1 and s/n2; regions may be null. Null when
/// a value is not finite.
nlohmann::json reference_error(const HalfPair& halves, const RegionMap* regions);

/// Of a file with the variance of every pixel's mean, whose values are taken for gamma distributed.
/// Null without that plane, or when a value is not finite.
nlohmann::json reference_error(const Frame& reference, const RegionMap* regions);

/// A result is limited by its reference when its root mean square error is within that many times
/// of the reference's own: 9.54 dB. Beyond, the reference makes at most 1/9 of the squared error.
constexpr double kLimitedWithin = 3.0;

/// Of errors that psnr_float_db tells. None for the result: its images are identical.
bool is_limited(std::optional<double> result_db, double reference_db);

/// Whether "psnr_float_db" of metrics (of a row, or of one of its regions) is limited by what error
/// says of the same part. None: one of them is not known.
std::optional<bool> limited_by_reference(const nlohmann::json& metrics,
                                         const nlohmann::json& error);

/// What error says of a region, or of the whole image ("").
nlohmann::json part_of_error(const nlohmann::json& error, const std::string& region);

/// Puts "limited_by_reference", and "limited_regions" by region, into a row of results.jsonl that
/// has metrics.
void mark_limited(nlohmann::json& row);

/// A mean squared error in the decibels of psnr_float_db, and back.
double decibels_of(double mse);
double mse_of(double decibels);

/// One line on the rule, for tables and reports.
inline constexpr std::string_view kLimitedFormula =
    "limited by the reference: root mean square error (display values) at most 3 times the "
    "reference's own, which is psnr_float_db at most 9.54 dB below it";

}  // namespace vecino
