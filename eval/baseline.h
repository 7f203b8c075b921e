// SPDX-License-Identifier: Apache-2.0
//
// A baseline: what a run measured, per group of cells and metric, as numbers. A JSON file with one
// line per group, so that a change reads as a diff:
//   "cornell.path": {"seeds": 8, "p99_error": [0.171, 0.0042], "psnr_float_db": [30.95, 0.14]}
// are mean and standard deviation over seeds, in the metric's unit.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "eval/gate_metrics.h"
#include "eval/gate_run.h"

namespace vecino {

struct BaselineGroup {
    std::size_t seeds = 0;
    std::map<std::string, MetricSpread> metrics;  ///< by the name of a gate metric
    MetricSpread time_s;  ///< total; geometric mean over seeds, standard deviation of its logarithm
    std::string host;     ///< where that was measured
    nlohmann::json question;

    friend bool operator==(const BaselineGroup& a, const BaselineGroup& b);
};

struct Baseline {
    std::string matrix;
    std::map<std::string, BaselineGroup> groups;
};

/// Throws Error(file) if it cannot be read, Error(usage) naming what is not as it has to be.
Baseline read_baseline(const std::string& path);

/// Replaces the file whole or not at all. Throws Error(file).
void write_baseline(const std::string& path, const Baseline& baseline);

/// Precondition: all > 0.
MetricSpread time_spread(const std::vector<double>& times_s);

/// What the classes of the run judge, of a group without faults; rounded as the file holds it.
BaselineGroup baseline_of(const RunGroup& group, const GateClass& gate);

}  // namespace vecino
