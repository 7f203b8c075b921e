// SPDX-License-Identifier: Apache-2.0
#include "eval/gate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "core/error.h"
#include "eval/commands.h"
#include "eval/distributions.h"
#include "eval/gate_time.h"
#include "eval/statistics.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

/// One metric of one group, on both sides.
struct Pair {
    const GateMetric& metric;
    double tolerance_db;
    double k_sigma;
    bool either_way;
    std::vector<double> errors;  ///< now, by seed
    MetricSpread now, then;
    Side now_side, then_side;

    [[nodiscard]] double decibels_per_relative() const {
        return decibels_per_decade(*metric.info) / std::numbers::ln10;
    }
};

/// In the metric's unit, as far from a mean in its bad direction as so many dB of its error.
double worse_by(const MetricInfo& metric, double mean, double loss_db) {
    const double factor = std::pow(10.0, loss_db / decibels_per_decade(metric));
    return value_of_error(metric, error_of_value(metric, mean) * factor);
}

void set_interval(Verdict& verdict, const Pair& pair) {
    const Estimate e = estimate(pair.errors);
    if (!e.low || !e.high) return;
    const auto value = [&](double error) {
        return value_of_error(*pair.metric.info,
                              std::max(error, std::numeric_limits<double>::min()));
    };
    verdict.value_low = std::min(value(*e.low), value(*e.high));
    // Where the errors' interval reaches 0, the metric's has no end in dB.
    if (*e.low > 0 || pair.metric.info->scale != ErrorScale::decibel)
        verdict.value_high = std::max(value(*e.low), value(*e.high));
}

Verdict judge_mean(const Pair& pair) {
    const MetricInfo& metric = *pair.metric.info;
    const double noise_db =
        explained_by_noise_db(metric, pair.k_sigma, pair.now_side, pair.then_side);
    const double loss_db =
        decibels_per_decade(metric) *
        std::log10(error_of_value(metric, pair.now.mean) / error_of_value(metric, pair.then.mean));
    const double allowed_db = pair.tolerance_db + noise_db;
    const bool judges_gain = pair.either_way && loss_db < 0;
    Verdict verdict;
    verdict.rule = "mean";
    verdict.noise_db = noise_db;
    verdict.value = pair.now.mean;
    set_interval(verdict, pair);
    verdict.baseline = pair.then.mean;
    verdict.limit = worse_by(metric, pair.then.mean, judges_gain ? -allowed_db : allowed_db);
    verdict.margin_db = allowed_db - (pair.either_way ? std::abs(loss_db) : loss_db);
    verdict.text = number_text(std::abs(loss_db), 3) +
                   (loss_db > 0 ? " dB worse, allowed " : " dB better, allowed ") +
                   (loss_db > 0   ? ""
                    : judges_gain ? "either way "
                                  : "worse by ") +
                   number_text(allowed_db, 3) + " = " + number_text(pair.tolerance_db, 3) +
                   " tolerance + " + number_text(noise_db, 3) + " noise";
    return verdict;
}

/// The seed that more than half of the seeds are at least as bad as.
double majority_error(std::vector<double> errors) {
    std::ranges::sort(errors);
    return errors[errors.size() - errors.size() / 2 - 1];
}

Verdict judge_seeds(const Pair& pair) {
    const MetricInfo& metric = *pair.metric.info;
    const auto seeds_then = static_cast<double>(pair.then_side.seeds);
    const double noise_db = pair.decibels_per_relative() * pair.then_side.relative_deviation *
                            student_quantile(normal_tail(pair.k_sigma), seeds_then - 1) *
                            std::sqrt(1 + 1 / seeds_then);
    const double error = majority_error(pair.errors);
    const double loss_db =
        decibels_per_decade(metric) * std::log10(error / error_of_value(metric, pair.then.mean));
    const double allowed_db = pair.tolerance_db + noise_db;
    Verdict verdict;
    verdict.rule = "seeds";
    verdict.value = value_of_error(metric, error);
    verdict.baseline = pair.then.mean;
    verdict.limit = worse_by(metric, pair.then.mean, allowed_db);
    verdict.margin_db = allowed_db - loss_db;
    verdict.text = "most seeds are " + number_text(std::abs(loss_db), 3) +
                   (loss_db > 0 ? " dB worse or more" : " dB better or less") +
                   ", allowed of a single one " + number_text(allowed_db, 3) + " = " +
                   number_text(pair.tolerance_db, 3) + " tolerance + " + number_text(noise_db, 3) +
                   " scatter then";
    return verdict;
}

Verdict fact(GateOutcome outcome, const std::string& rule, const std::string& text) {
    Verdict verdict;
    verdict.outcome = outcome;
    verdict.rule = rule;
    verdict.text = text;
    return verdict;
}

Side side_of(const MetricInfo& metric, const MetricSpread& spread, std::size_t seeds) {
    return {relative_deviation(metric, spread), seeds};
}

GateOutcome outcome_of(const Verdict& verdict) {
    return *verdict.margin_db >= 0 ? GateOutcome::pass : GateOutcome::fail;
}

std::vector<Verdict> judge_pair(const Pair& pair) {
    std::vector<Verdict> verdicts{judge_mean(pair)};
    verdicts.front().outcome = outcome_of(verdicts.front());
    const bool holds = verdicts.front().outcome == GateOutcome::pass;
    if (!holds || pair.now_side.seeds < 2 || pair.then_side.seeds < 2) return verdicts;
    verdicts.push_back(judge_seeds(pair));
    verdicts.back().outcome = outcome_of(verdicts.back());
    return verdicts;
}

std::vector<Verdict> judge_metric(const RunGroup& group, const GateClass& gate,
                                  const BaselineGroup& baseline, std::size_t index) {
    const auto& [metric, tolerance_db] = gate.tolerance_db[index];
    const auto then = baseline.metrics.find(metric.name);
    const auto errors = group.errors(metric);
    const bool has_baseline = then != baseline.metrics.end();
    if (!errors && !has_baseline)
        return {fact(GateOutcome::not_gated, "not measured", "neither side has a value")};
    if (!errors) return {fact(GateOutcome::fail, "not measured", "the baseline has a value")};
    if (!has_baseline)
        return {fact(GateOutcome::fail, "no baseline",
                     "the baseline lacks this metric: vecino accept")};
    const MetricSpread now = spread_over_seeds(*metric.info, *errors);
    return judge_pair({metric, tolerance_db, gate.k_sigma, gate.either_way, *errors, now,
                       then->second, side_of(*metric.info, now, errors->size()),
                       side_of(*metric.info, then->second, baseline.seeds)});
}

const char* rule_of(CellFaultKind kind) {
    switch (kind) {
        case CellFaultKind::missing:
            return "missing cell";
        case CellFaultKind::failed:
            return "failed cell";
        case CellFaultKind::non_finite:
            return kNonFiniteRule;
        case CellFaultKind::stale:
            break;
    }
    return "stale cell";
}

std::vector<Verdict> faults_of(const RunGroup& group) {
    std::vector<Verdict> verdicts;
    for (const CellFault& fault : group.faults)
        verdicts.push_back(
            fact(GateOutcome::fail, rule_of(fault.kind), fault.cell + ": " + fault.reason));
    return verdicts;
}

/// "spp: 16 then, 32 now; ..."
std::string differences(const Json& then, const Json& now) {
    std::set<std::string> keys;
    for (const Json* side : {&then, &now})
        for (const auto& [key, value] : side->items()) keys.insert(key);
    std::string text;
    for (const std::string& key : keys) {
        const Json a = then.value(key, Json());
        const Json b = now.value(key, Json());
        if (a == b) continue;
        text += (text.empty() ? "" : "; ") + key + ": ";
        text += a.is_object() && b.is_object() ? differences(a, b)
                                               : a.dump() + " then, " + b.dump() + " now";
    }
    return text;
}

class Check {
  public:
    Check(const GateRun& run, const Baseline& baseline) : run_(run), baseline_(baseline) {
        if (run.matrix == baseline.matrix) return;
        throw Error(ExitCode::usage, "baseline: found one of the matrix \"" + baseline.matrix +
                                         "\", allowed: of \"" + run.matrix + "\"");
    }

    GateResult run() {
        result_.matrix = run_.matrix;
        result_.groups = run_.groups.size();
        for (const RunGroup& group : run_.groups) judge(group);
        for (const auto& [name, group] : baseline_.groups) {
            if (run_.find(name) != nullptr) continue;
            add({fact(GateOutcome::fail, "missing cell",
                      "the baseline has it, the matrix does not")},
                name, "");
        }
        find_unused();
        const auto badness = [](const Verdict& v) {
            const double margin = v.margin_db.value_or(-std::numeric_limits<double>::infinity());
            return std::pair(v.outcome == GateOutcome::fail   ? 0
                             : v.outcome == GateOutcome::pass ? 1
                                                              : 2,
                             v.rule == "time" ? std::numeric_limits<double>::infinity() : margin);
        };
        std::ranges::stable_sort(result_.verdicts, {}, badness);
        return std::move(result_);
    }

  private:
    void add(std::vector<Verdict> verdicts, const std::string& group,
             const std::string& class_name) {
        for (Verdict& verdict : verdicts) {
            verdict.group = group;
            verdict.class_name = class_name;
            result_.verdicts.push_back(std::move(verdict));
        }
    }

    void judge(const RunGroup& group) {
        const GateClass& gate = class_of(run_.classes, group.params);
        used_.insert(gate.name);
        if (!group.faults.empty()) return add(faults_of(group), group.name, gate.name);
        if (group.is_refused()) return add({judge_refusal(group)}, group.name, gate.name);
        add(judge_sound(group, gate), group.name, gate.name);
    }

    Verdict judge_refusal(const RunGroup& group) const {
        const std::string reason = group.refused.front().value("reason", "");
        if (!baseline_.groups.contains(group.name))
            return fact(GateOutcome::not_gated, "refused", "as expected: " + reason);
        return fact(GateOutcome::fail, "refused", reason + ", and the baseline has numbers");
    }

    std::vector<Verdict> judge_sound(const RunGroup& group, const GateClass& gate) {
        const auto found = baseline_.groups.find(group.name);
        if (found == baseline_.groups.end())
            return {fact(GateOutcome::fail, "no baseline", "new: vecino accept takes it in")};
        const BaselineGroup& then = found->second;
        const std::string changed = differences(then.question, group.question);
        if (!same_question(then.question, group.question))
            return {fact(GateOutcome::fail, "another question", changed + ": vecino accept")};
        if (baseline_of(group, gate) == then) ++result_.identical;
        std::vector<Verdict> verdicts;
        if (changed.empty()) {
            verdicts = judge_quality(group, gate, then);
        } else {
            verdicts.push_back(fact(GateOutcome::not_gated, "measured budget",
                                    "samples were measured, " + changed));
        }
        if (auto time = judge_time(group, gate, then)) verdicts.push_back(std::move(*time));
        return verdicts;
    }

    void find_unused() {
        for (const GateClass& gate : run_.classes) {
            const bool is_default = &gate == &run_.classes.back();
            if (!is_default && !used_.contains(gate.name)) result_.unused.push_back(gate.name);
        }
    }

    const GateRun& run_;
    const Baseline& baseline_;
    GateResult result_;
    std::set<std::string> used_;
};

}  // namespace

std::vector<Verdict> judge_faults(const GateRun& run) {
    std::vector<Verdict> verdicts;
    for (const RunGroup& group : run.groups) {
        for (Verdict& verdict : faults_of(group)) {
            verdict.group = group.name;
            verdict.class_name = class_of(run.classes, group.params).name;
            verdicts.push_back(std::move(verdict));
        }
    }
    return verdicts;
}

double explained_by_noise_db(const MetricInfo& metric, double k_sigma, const Side& now,
                             const Side& then) {
    const auto freedom = [](const Side& side) { return static_cast<double>(side.seeds) - 1; };
    const double degrees = freedom(now) + freedom(then);
    if (degrees < 1) return 0;
    const auto squares = [&](const Side& side) {
        return freedom(side) * side.relative_deviation * side.relative_deviation;
    };
    const double variance = (squares(now) + squares(then)) / degrees;
    const double error_of_mean = std::sqrt(
        variance * (1 / static_cast<double>(now.seeds) + 1 / static_cast<double>(then.seeds)));
    return decibels_per_decade(metric) / std::numbers::ln10 * error_of_mean *
           student_quantile(normal_tail(k_sigma), degrees);
}

std::vector<Verdict> judge_quality(const RunGroup& group, const GateClass& gate,
                                   const BaselineGroup& baseline) {
    std::vector<Verdict> verdicts;
    for (std::size_t i = 0; i < gate.tolerance_db.size(); ++i) {
        for (Verdict& verdict : judge_metric(group, gate, baseline, i)) {
            verdict.metric = gate.tolerance_db[i].first.name;
            verdicts.push_back(std::move(verdict));
        }
    }
    return verdicts;
}

std::size_t GateResult::count(GateOutcome outcome) const {
    return static_cast<std::size_t>(std::ranges::count(verdicts, outcome, &Verdict::outcome));
}

bool GateResult::has_non_finite() const {
    return std::ranges::find(verdicts, kNonFiniteRule, &Verdict::rule) != verdicts.end();
}

GateResult check_run(const GateRun& run, const Baseline& baseline) {
    return Check(run, baseline).run();
}

}  // namespace vecino
