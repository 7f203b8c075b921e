// SPDX-License-Identifier: Apache-2.0
//
// Holds a run against a baseline. Every comparison is a verdict that names the rule that decided.
//
// Quality, per group of cells and metric, in decibels of the metric's error:
//   mean     loss = d log10(mean error now / mean error then), d = 10 or 20, must not exceed (where
//   a
//            class judges either way: nor fall below the negative of)
//            tolerance + t s sqrt(1/n + 1/m), where s pools both sides' relative deviations over
//            their n and m seeds, and t is the quantile of Student's t with n + m - 2 degrees of
//            freedom that is exceeded as rarely as k_sigma sigma by a normal distribution
//   seeds    where the mean holds: of the seeds now, not more than half may each be worse by the
//            tolerance + t s sqrt(1 + 1/m) with the scatter then alone, as rare. Without it a run
//            that scatters would excuse its own mean; a lone outlier, which heavy tails bring,
//            fails nothing
// Facts that no number excuses: a cell that is missing, failed, stale or not finite; a group,
// metric or question without baseline; a group of the baseline that the run lacks. Time: ratio of
// geometric means over seeds, which a run takes in turn. Fails where a class gates it, the host is
// the same, both sides have enough seeds, and the 95 % confidence interval of the ratio lies beyond
// the tolerance.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/baseline.h"
#include "eval/gate_run.h"

namespace vecino {

enum class GateOutcome { pass, fail, not_gated };

/// Numbers are in the metric's unit. None where the rule has no such thing.
struct Verdict {
    GateOutcome outcome = GateOutcome::pass;
    std::string rule;  ///< "mean", "seeds", "time", "missing cell", "no baseline", ...
    std::string class_name;
    std::string group;
    std::string metric;
    std::optional<double> value, value_low, value_high;  ///< with its 95 % confidence interval
    std::optional<double> baseline;
    std::optional<double> limit;
    std::optional<double> margin_db;  ///< of time: in percent; below 0 it fails
    std::optional<double> noise_db;   ///< of a mean: how much of the limit noise explains
    std::string text;                 ///< what decided, in words
};

struct GateResult {
    std::string matrix;
    std::vector<Verdict> verdicts;  ///< worst first, those that are not gated last
    std::size_t groups = 0;
    std::size_t identical = 0;  ///< groups whose numbers are those of the baseline to the digit
    std::vector<std::string> unused;  ///< classes that no cell is of

    [[nodiscard]] std::size_t count(GateOutcome outcome) const;
    [[nodiscard]] bool has_non_finite() const;
    [[nodiscard]] bool passed() const {
        return count(GateOutcome::fail) == 0 && count(GateOutcome::pass) > 0;
    }
};

/// Throws Error(usage) if the baseline is of another matrix.
GateResult check_run(const GateRun& run, const Baseline& baseline);

/// Cells that are missing, failed, stale or not finite, as verdicts that fail.
std::vector<Verdict> judge_faults(const GateRun& run);

/// The quality rules alone, of one group without faults. A group of another question is no match.
std::vector<Verdict> judge_quality(const RunGroup& group, const GateClass& gate,
                                   const BaselineGroup& baseline);

/// How many decibels of loss noise explains, given both sides' relative deviations and seeds. 0
/// where neither side has two seeds: the tolerance alone decides there.
struct Side {
    double relative_deviation;
    std::size_t seeds;
};
double explained_by_noise_db(const MetricInfo& metric, double k_sigma, const Side& now,
                             const Side& then);

inline constexpr const char* kNonFiniteRule = "non-finite";

}  // namespace vecino
