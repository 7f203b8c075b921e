// SPDX-License-Identifier: Apache-2.0
//
// Results over seeds. Errors are averaged as mean squared errors and then turned into decibels;
// times are medians.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/statistics.h"

namespace vecino {

struct GroupSummary {
    std::string group;  ///< cell name without seed
    std::string scene;
    std::string method;
    nlohmann::json params;  ///< of the first cell
    std::size_t seeds = 0;  ///< finished ones
    std::size_t failed = 0;
    std::optional<Estimate> psnr_float_db, psnr_db, ssim, relmse;  ///< none: no finite value
    double time_s = 0;                                             ///< total, median over seeds
    double reconstruct_s = 0;
    double time_share = 0;  ///< of plain path tracing's on the same scene; 0 when that is not there
    double samples_ratio = 0;
    std::size_t fallback_pixels = 0;  ///< of the first seed
    std::vector<std::string> cells;
};

/// Groups in the order in which their first cells stand in rows (of results.jsonl).
std::vector<GroupSummary> summarise(const std::vector<nlohmann::json>& rows);

nlohmann::json summary_json(const GroupSummary& group);

/// A table for a terminal.
std::string summary_table(const std::vector<GroupSummary>& groups);

}  // namespace vecino
