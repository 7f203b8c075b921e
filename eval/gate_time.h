// SPDX-License-Identifier: Apache-2.0
//
// Time against a baseline's: always compared, gated only where the comparison is fair.
#pragma once

#include <optional>

#include "eval/gate.h"

namespace vecino {

/// Fewer seeds say too little about how much times scatter.
inline constexpr std::size_t kLeastTimings = 3;

/// How many times as long as the baseline's, with a 95 % confidence interval (Welch's t of the
/// logarithms); without one below 2 timings on either side.
struct TimeRatio {
    double ratio = 1;
    std::optional<double> low, high;
};
TimeRatio time_ratio(const MetricSpread& now, std::size_t now_timings, const MetricSpread& then,
                     std::size_t then_timings);

/// None where a side has no time: nothing was traced for it.
std::optional<Verdict> judge_time(const RunGroup& group, const GateClass& gate,
                                  const BaselineGroup& baseline);

}  // namespace vecino
