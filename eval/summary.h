// SPDX-License-Identifier: Apache-2.0
//
// Results over seeds. Errors are averaged as mean squared errors and then turned into decibels;
// times are medians.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/seed_statistics.h"
#include "eval/stability_summary.h"
#include "eval/statistics.h"

namespace vecino {

struct GroupSummary {
    std::string group;  ///< cell name without seed
    std::string scene;
    std::string method;
    nlohmann::json params;  ///< of the first cell
    std::size_t seeds = 0;  ///< finished ones
    std::size_t failed = 0;
    std::vector<std::uint32_t> seeds_done;                         ///< which
    std::optional<Estimate> psnr_float_db, psnr_db, ssim, relmse;  ///< none: no finite value
    PerRegion<std::optional<Estimate>> region_psnr_float_db;
    std::map<std::string, Estimate> metrics;    ///< by name, those that every finished seed has
    std::optional<Estimate> noise_db, bias_db;  ///< parts of psnr_float_db's error, in its dB
    std::optional<Estimate> relmse_noise, relmse_bias;  ///< parts of relmse
    std::optional<double> reference_db;                 ///< the reference's own psnr_float_db
    std::optional<double> predicted_db;  ///< psnr_float_db that the method expected: median
    double reference_relmse = 0;         ///< its own relmse; 0 where that is not known
    std::optional<bool> is_limited;      ///< by the reference (eval/reference_error.h)
    PerRegion<std::optional<bool>> region_is_limited;
    double time_s = 0;            ///< total, median over seeds
    std::vector<double> times_s;  ///< total, by seed
    double reconstruct_s = 0;
    double trace_s = 0;     ///< median over seeds; 0 where nothing was traced
    std::string against;    ///< the group of path tracing that its time is a share of
    double time_share = 0;  ///< 0 when that is not there
    double samples_ratio = 0;
    std::size_t fallback_pixels = 0;  ///< of the first seed
    std::size_t dropped_samples = 0;  ///< over all seeds
    std::optional<SeedStatisticsByRegion> statistics;
    std::optional<GroupStability> stability;  ///< none: the matrix did not ask for it
    /// Of the failure that the scene shows, by seed; at least a tenth of its pass_below.
    std::vector<double> signature_by_seed;
    std::vector<std::string> cells;

    /// Time of tracing and reconstruction alone; of images that came otherwise, all there is.
    [[nodiscard]] double work_s() const { return trace_s > 0 ? trace_s + reconstruct_s : time_s; }

    /// Of a region by name, or of the whole image (""). Null without finished images.
    [[nodiscard]] const SeedStatistics* statistics_of(const std::string& region) const;
};

using StatisticsByGroup = std::map<std::string, SeedStatisticsByRegion>;

/// Groups in the order in which their first cells stand in rows (of results.jsonl).
std::vector<GroupSummary> summarise(const std::vector<nlohmann::json>& rows,
                                    const StatisticsByGroup& statistics = {});

/// {"mean":, "low":, "high":}, null for none.
nlohmann::json estimate_json(const std::optional<Estimate>& estimate);

nlohmann::json summary_json(const GroupSummary& group);

/// A table for a terminal, with what its columns mean.
std::string summary_table(const std::vector<GroupSummary>& groups);

}  // namespace vecino
