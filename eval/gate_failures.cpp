// SPDX-License-Identifier: Apache-2.0
#include "eval/gate_failures.h"

#include <algorithm>
#include <cmath>

#include "core/json_read.h"
#include "eval/failure_results.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

constexpr const char* kRule = "expected";

std::string words(const std::vector<FailureVerdict>& verdicts) {
    std::string text;
    for (const FailureVerdict verdict : verdicts)
        text += (text.empty() ? "" : " or ") + verdict_name(verdict);
    return text;
}

Verdict verdict_of(const FailureResult& result, const FailureCase& failure) {
    Verdict verdict;
    verdict.outcome = result.is_unexpected()    ? GateOutcome::fail
                      : result.expected.empty() ? GateOutcome::not_gated
                                                : GateOutcome::pass;
    verdict.rule = kRule;
    verdict.class_name = failure.id;
    verdict.group = result.group;
    verdict.metric = std::string(failure.measure.signature->name);
    if (result.value && std::isfinite(*result.value)) verdict.value = result.value;
    const std::string limits = " (limits " + failure_number(failure.pass_below) + ", " +
                               failure_number(failure.fails_above) + ")";
    const bool is_refusal = result.verdict == FailureVerdict::refuses;
    const std::string found = verdict_name(result.verdict) + (is_refusal ? "" : limits);
    verdict.text = result.expected.empty() ? "nothing expected"
                                           : found + ", expected: " + words(result.expected);
    if (!result.reason.empty()) verdict.text += "; " + result.reason;
    return verdict;
}

std::vector<Json> rows_of(const GateRun& run) {
    std::vector<Json> rows;
    for (const RunGroup& group : run.groups) {
        rows.insert(rows.end(), group.rows.begin(), group.rows.end());
        rows.insert(rows.end(), group.refused.begin(), group.refused.end());
    }
    return rows;
}

/// Failures first, as they are in other checks.
void sort(GateResult& result) {
    std::ranges::stable_sort(result.verdicts, {}, [](const Verdict& verdict) {
        return verdict.outcome == GateOutcome::fail   ? 0
               : verdict.outcome == GateOutcome::pass ? 1
                                                      : 2;
    });
}

}  // namespace

std::vector<Verdict> judge_failures(const GateRun& run) {
    const std::string file = run.directory + "/run.json";
    const Json document = parse_json_file(file);
    const Json config = document.value("config", Json::object());
    const Failures failures = failure_results(run.directory, rows_of(run), JsonValue(config, file));
    std::vector<Verdict> verdicts;
    for (const FailureResult& result : failures.results) {
        // A group with faults is judged by them: its other seeds are not what was asked for.
        const RunGroup* const group = run.find(result.group);
        if (group != nullptr && !group->faults.empty()) continue;
        verdicts.push_back(verdict_of(result, failures.cases[result.failure]));
    }
    return verdicts;
}

GateResult check_failures(const GateRun& run) {
    GateResult result;
    result.matrix = run.matrix;
    result.groups = run.groups.size();
    result.verdicts = judge_faults(run);
    add_failures(result, run);
    return result;
}

void add_failures(GateResult& result, const GateRun& run) {
    auto verdicts = judge_failures(run);
    std::ranges::move(verdicts, std::back_inserter(result.verdicts));
    sort(result);
}

}  // namespace vecino
