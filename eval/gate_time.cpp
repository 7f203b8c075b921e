// SPDX-License-Identifier: Apache-2.0
#include "eval/gate_time.h"

#include <cmath>

#include "eval/commands.h"
#include "eval/distributions.h"

namespace vecino {
namespace {

/// Why a fair comparison cannot be made, or is not asked for; empty where it can.
std::string why_not_gated(const RunGroup& group, const GateClass& gate,
                          const BaselineGroup& baseline, std::size_t timings) {
    if (!gate.time_tolerance) return "not gated: its class has no time_tolerance_percent";
    if (group.host() != baseline.host)
        return "not gated: other host, \"" + baseline.host + "\" then, \"" + group.host() +
               "\" now";
    if (timings < kLeastTimings || baseline.seeds < kLeastTimings)
        return "not gated: fewer than " + std::to_string(kLeastTimings) + " seeds on a side";
    return "";
}

}  // namespace

TimeRatio time_ratio(const MetricSpread& now, std::size_t now_timings, const MetricSpread& then,
                     std::size_t then_timings) {
    TimeRatio result{now.mean / then.mean, {}, {}};
    if (now_timings < 2 || then_timings < 2) return result;
    const auto n = static_cast<double>(now_timings);
    const auto m = static_cast<double>(then_timings);
    const double a = now.deviation * now.deviation / n;
    const double b = then.deviation * then.deviation / m;
    // Welch and Satterthwaite; two sides without any scatter have an interval of no width.
    const double degrees =
        a + b > 0 ? (a + b) * (a + b) / (a * a / (n - 1) + b * b / (m - 1)) : n + m - 2;
    const double half = student_quantile(0.025, degrees) * std::sqrt(a + b);
    result.low = result.ratio * std::exp(-half);
    result.high = result.ratio * std::exp(half);
    return result;
}

std::optional<Verdict> judge_time(const RunGroup& group, const GateClass& gate,
                                  const BaselineGroup& baseline) {
    const std::vector<double> times = group.times_s();
    if (times.empty() || !(baseline.time_s.mean > 0)) return std::nullopt;
    const MetricSpread now = time_spread(times);
    const TimeRatio ratio = time_ratio(now, times.size(), baseline.time_s, baseline.seeds);
    Verdict verdict;
    verdict.rule = "time";
    verdict.metric = "time_s";
    verdict.value = now.mean;
    verdict.baseline = baseline.time_s.mean;
    verdict.text = number_text(ratio.ratio, 3) + " x";
    if (ratio.low) {
        verdict.text +=
            " (" + number_text(*ratio.low, 3) + " to " + number_text(*ratio.high, 3) + ")";
        verdict.value_low = *ratio.low * baseline.time_s.mean;
        verdict.value_high = *ratio.high * baseline.time_s.mean;
    }
    const std::string reason = why_not_gated(group, gate, baseline, times.size());
    if (!reason.empty()) {
        verdict.outcome = GateOutcome::not_gated;
        verdict.text += ", " + reason;
        return verdict;
    }
    const double allowed = 1 + *gate.time_tolerance;
    verdict.limit = allowed * baseline.time_s.mean;
    verdict.margin_db = 100 * (allowed - *ratio.low);
    verdict.outcome = *ratio.low > allowed ? GateOutcome::fail : GateOutcome::pass;
    verdict.text += ", fails where the whole interval is above " + number_text(allowed, 3);
    return verdict;
}

}  // namespace vecino
