// SPDX-License-Identifier: Apache-2.0
//
// Stability of a group as numbers: how far its seeds lie apart, what a moved camera and other
// parameters change, and how many pixels took another way than the others.
#pragma once

#include <cstddef>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/run_directory.h"
#include "eval/stability.h"

namespace vecino {

/// By how many per cent the mean squared error grows with one per cent of a parameter.
struct Elasticity {
    double low = 0, high = 0;  ///< the values between which it was measured
    double value = 0;  ///< log(error at high / error at low) / log(high / low), mean of seeds
};

struct GroupStability {
    std::optional<double> spread_db;  ///< sample standard deviation of psnr_float_db over seeds
    std::optional<double> worst_db;   ///< least psnr_float_db of a seed; none: none has a number
    std::vector<Shimmer> shimmer;
    /// Whether the noise of the references could be a tenth of what changes between them: shimmer
    /// is too low then.
    bool is_limited = false;
    std::map<std::string, Elasticity> elasticity;  ///< by parameter
    double fallback_share = 0;                     ///< of the traced pixels, largest of all seeds
    std::size_t dropped_samples = 0;               ///< over all seeds
    std::size_t non_finite_pixels = 0;             ///< likewise
    std::size_t failed = 0;                        ///< cells
};

/// A row of what is shown.
struct StabilityInfo {
    std::string_view name;     ///< of the column, or of several
    std::string_view formula;  ///< one line, or two
};

/// The columns of tables, and what each says.
std::vector<StabilityInfo> stability_columns();

/// Of the groups of whose rows some measured it, by group. Reads the images that the cells kept;
/// shimmer without noise is none where they are gone.
std::map<std::string, GroupStability> group_stability(const RunDirectory& directory,
                                                      const std::vector<nlohmann::json>& rows);

nlohmann::json group_stability_json(const GroupStability& stability);

}  // namespace vecino
