// SPDX-License-Identifier: Apache-2.0
//
// Groups of a run and their baselines, made from numbers, for what gates say about them.
#pragma once

#include <string>
#include <vector>

#include "eval/gate.h"

namespace vecino {

/// A class that judges one metric.
inline GateClass class_judging(const std::string& metric, double tolerance_db, double k_sigma = 3) {
    GateClass gate;
    gate.name = "class";
    gate.tolerance_db = {{find_gate_metric(metric).value(), tolerance_db}};
    gate.k_sigma = k_sigma;
    return gate;
}

/// A group whose seeds have these values of psnr_float_db, and other metrics that follow from them.
inline RunGroup group_of(const std::vector<double>& psnr_float_db,
                         const std::string& name = "box.mean") {
    RunGroup group;
    group.name = name;
    group.params = {{"scene", "box.json"}, {"method", "mean"}, {"spp", 16}};
    group.question = {{"method", "mean"}, {"spp", 16}, {"budget", "same_spp"}};
    for (const double db : psnr_float_db) {
        const double amplitude = std::pow(10.0, -0.05 * db);
        nlohmann::json metrics{{"psnr_float_db", db},
                               {"p99_error", 3 * amplitude},
                               {"worst_tile_psnr_db", db - 4},
                               {"ssim", 1 - amplitude},
                               {"relmse", amplitude * amplitude}};
        metrics["regions"]["edge"] = metrics;
        metrics["regions"]["edge"]["pixels"] = 9;
        const std::string seed = std::to_string(group.rows.size() + 1);
        group.rows.push_back({{"cell", name + ".s" + seed},
                              {"status", "ok"},
                              {"metrics", metrics},
                              {"time_s", {{"total", 1.0}}},
                              {"host", "a CPU"},
                              {"threads", 2}});
    }
    return group;
}

/// The verdict of one rule on one metric.
inline Verdict verdict_of(const std::vector<Verdict>& verdicts, const std::string& rule) {
    for (const Verdict& verdict : verdicts)
        if (verdict.rule == rule) return verdict;
    throw std::logic_error("no verdict by the rule " + rule);
}

inline Verdict judged(const RunGroup& now, const RunGroup& then, const GateClass& gate,
                      const std::string& rule = "mean") {
    return verdict_of(judge_quality(now, gate, baseline_of(then, gate)), rule);
}

/// A run of these groups, all of the default class.
inline GateRun run_of(std::vector<RunGroup> groups) {
    GateRun run;
    run.directory = "run";
    run.matrix = "matrix";
    run.classes = {default_gate_class()};
    run.groups = std::move(groups);
    return run;
}

inline Baseline baseline_of(const GateRun& run) {
    Baseline baseline;
    baseline.matrix = run.matrix;
    for (const RunGroup& group : run.groups)
        baseline.groups[group.name] = baseline_of(group, class_of(run.classes, group.params));
    return baseline;
}

/// The only failure.
inline Verdict failure_of(const GateResult& result) {
    if (result.count(GateOutcome::fail) != 1) throw std::logic_error("not one failure");
    return result.verdicts.front();
}

}  // namespace vecino
