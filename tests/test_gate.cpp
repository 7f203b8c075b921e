// SPDX-License-Identifier: Apache-2.0
//
// Every rule of the gate: a pair that must fail and one that must pass.
#include <cmath>
#include <numbers>

#include "eval/gate_report.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/gate_groups.h"

using namespace vecino;

namespace {

const std::vector<double> kThen = {30.0, 30.1, 29.9, 30.05, 29.95};

std::vector<double> shifted(std::vector<double> values, double by) {
    for (double& value : values) value += by;
    return values;
}

}  // namespace

TEST_CASE("a mean may be worse by the tolerance and by what noise explains, and no more",
          "[gate]") {
    const GateClass gate = class_judging("psnr_float_db", 0.1);
    const Verdict same = judged(group_of(kThen), group_of(kThen), gate);
    CHECK(same.outcome == GateOutcome::pass);
    const double allowed_db = same.margin_db.value();  // the loss is 0
    // 5 and 5 seeds with a deviation of 0.0791 dB; t of 8 degrees at three sigma is 4.277.
    const double noise_db = 4.277 * 0.0791 * std::sqrt(2.0 / 5);
    CHECK(allowed_db == Approx(0.1 + noise_db).epsilon(0.005));

    const Verdict below =
        judged(group_of(shifted(kThen, -allowed_db + 0.001)), group_of(kThen), gate);
    const Verdict above =
        judged(group_of(shifted(kThen, -allowed_db - 0.001)), group_of(kThen), gate);
    CHECK(below.outcome == GateOutcome::pass);
    CHECK(above.outcome == GateOutcome::fail);
    CHECK(above.margin_db.value() == Approx(-0.001).margin(1e-4));
    CHECK(above.limit.value() == Approx(above.baseline.value() - allowed_db).epsilon(1e-5));
    CHECK(above.value.value() < above.limit.value());
    CHECK(judged(group_of(shifted(kThen, 5)), group_of(kThen), gate).outcome == GateOutcome::pass);
}

TEST_CASE("decibels mean the same for every metric", "[gate]") {
    const std::string metric = GENERATE("psnr_float_db", "edge.psnr_float_db", "relmse",
                                        "p99_error", "worst_tile_psnr_db", "edge.p99_error");
    CAPTURE(metric);
    const GateClass gate = class_judging(metric, 0.2, 0);  // k_sigma of 0: no noise
    CHECK(judged(group_of({29.81}), group_of({30.0}), gate).outcome == GateOutcome::pass);
    const Verdict worse = judged(group_of({29.79}), group_of({30.0}), gate);
    CHECK(worse.outcome == GateOutcome::fail);
    CHECK(worse.margin_db.value() == Approx(-0.01).margin(1e-4));
}

TEST_CASE("ssim counts as the error 1 - ssim", "[gate]") {
    const GateClass gate = class_judging("ssim", 0.2, 0);
    // 1 - ssim goes with the amplitude here: 0.41 dB of psnr are 0.205 dB.
    CHECK(judged(group_of({29.61}), group_of({30.0}), gate).outcome == GateOutcome::pass);
    CHECK(judged(group_of({29.59}), group_of({30.0}), gate).outcome == GateOutcome::fail);
}

TEST_CASE("scatter does not excuse a run of which most seeds are bad", "[gate]") {
    const GateClass gate = class_judging("psnr_float_db", 0.1);
    const std::vector<double> then = {30.0, 30.1, 29.9, 30.05, 29.95, 30.02, 29.98, 30.0};
    const auto judge = [&](const std::vector<double>& now) {
        return judge_quality(group_of(now), gate, baseline_of(group_of(then), gate));
    };
    // The mean alone would pass it: it is worse, but how much nobody knows.
    const std::vector<Verdict> wild = judge({29.0, 26.0, 32.0, 28.9});
    CHECK(verdict_of(wild, "mean").outcome == GateOutcome::pass);
    const Verdict most = verdict_of(wild, "seeds");
    CHECK(most.outcome == GateOutcome::fail);
    CHECK(most.value.value() == Approx(29.0));  // 28.9 and 26 are worse still
    CHECK(most.value.value() < most.limit.value());
    // t of 7 degrees at three sigma is 4.53.
    const double noise_db = 4.53 * 0.0627 * std::sqrt(1 + 1.0 / 8);
    CHECK(most.margin_db.value() == Approx(0.1 + noise_db - 1.0).margin(0.02));

    // An outlier is no majority, nor is a half; and a mean that fails needs no second verdict.
    CHECK(verdict_of(judge({30.0, 30.1, 29.9, 26.0}), "seeds").outcome == GateOutcome::pass);
    CHECK(verdict_of(judge({30.0, 30.1, 28.0, 28.0}), "seeds").outcome == GateOutcome::pass);
    CHECK(judge({29.0, 29.1, 28.9, 29.05}).size() == 1);
}

TEST_CASE("noise explains more the fewer seeds there are, and nothing without any", "[gate]") {
    const MetricInfo& psnr = *find_gate_metric("psnr_float_db")->info;
    const double deviation = 0.1;
    double before = 1e9;
    for (const std::size_t seeds : {2u, 3u, 4u, 8u, 32u}) {
        const double db = explained_by_noise_db(psnr, 3, {deviation, seeds}, {deviation, seeds});
        CHECK(db < before);
        before = db;
    }
    const double normal = 10 / std::numbers::ln10 * deviation * std::sqrt(2.0 / 100000) * 3;
    CHECK(explained_by_noise_db(psnr, 3, {deviation, 100000}, {deviation, 100000}) ==
          Approx(normal).epsilon(0.001));
    CHECK(explained_by_noise_db(psnr, 3, {0, 1}, {0, 1}) == 0);
    // One seed now is judged by the scatter then.
    CHECK(explained_by_noise_db(psnr, 3, {0, 1}, {deviation, 9}) > 0);
}

TEST_CASE("identical images pass against identical ones and fail nothing", "[gate]") {
    RunGroup perfect = group_of({30.0, 30.0});
    for (auto& row : perfect.rows) row["metrics"]["psnr_float_db"] = nullptr;
    const GateClass gate = class_judging("psnr_float_db", 0.1);
    CHECK(judged(perfect, perfect, gate).outcome == GateOutcome::pass);
    CHECK(judged(perfect, group_of({30.0, 30.0}), gate).outcome == GateOutcome::pass);
    CHECK(judged(group_of({30.0, 30.0}), perfect, gate).outcome == GateOutcome::fail);
}

TEST_CASE("a metric that one side lacks fails, one that both lack is not gated", "[gate]") {
    const GateClass gate = class_judging("edge.psnr_float_db", 0.1);
    const RunGroup whole = group_of(kThen);
    RunGroup without = whole;
    for (auto& row : without.rows) row["metrics"].erase("regions");
    CHECK(judged(without, whole, gate, "not measured").outcome == GateOutcome::fail);
    CHECK(judged(whole, without, gate, "no baseline").outcome == GateOutcome::fail);
    CHECK(judged(without, without, gate, "not measured").outcome == GateOutcome::not_gated);
    RunGroup one_lacks = whole;
    one_lacks.rows.back()["metrics"].erase("regions");
    CHECK(judged(one_lacks, whole, gate, "not measured").outcome == GateOutcome::fail);
}

TEST_CASE("an unchanged run passes, and its numbers are counted as identical", "[gate]") {
    const GateRun run = run_of({group_of(kThen, "a"), group_of(kThen, "b")});
    const GateResult result = check_run(run, baseline_of(run));
    CHECK(result.passed());
    CHECK(result.identical == 2);
    CHECK(result.count(GateOutcome::pass) == 2 * 4 * 2);  // four metrics, mean and seeds
}

TEST_CASE("a cell that is missing, failed, stale or not finite fails", "[gate]") {
    const auto [kind, rule] =
        GENERATE(table<CellFaultKind, std::string>({{CellFaultKind::missing, "missing cell"},
                                                    {CellFaultKind::failed, "failed cell"},
                                                    {CellFaultKind::stale, "stale cell"},
                                                    {CellFaultKind::non_finite, "non-finite"}}));
    GateRun run = run_of({group_of(kThen)});
    const Baseline baseline = baseline_of(run);
    run.groups.front().faults.push_back({"box.mean.s3", kind, "why"});
    const GateResult result = check_run(run, baseline);
    CHECK(failure_of(result).rule == rule);
    CHECK(failure_of(result).text == "box.mean.s3: why");
    CHECK(result.has_non_finite() == (kind == CellFaultKind::non_finite));
}

TEST_CASE("a group without baseline fails, and so does a baseline without group", "[gate]") {
    const GateRun both = run_of({group_of(kThen, "a"), group_of(kThen, "b")});
    const GateRun one = run_of({group_of(kThen, "a")});
    const Verdict fresh = failure_of(check_run(both, baseline_of(one)));
    CHECK(fresh.rule == "no baseline");
    CHECK(fresh.group == "b");
    CHECK(fresh.text.find("vecino accept") != std::string::npos);
    const Verdict gone = failure_of(check_run(one, baseline_of(both)));
    CHECK(gone.rule == "missing cell");
    CHECK(gone.group == "b");
}

TEST_CASE("another question is not answered by the same numbers", "[gate]") {
    GateRun run = run_of({group_of(kThen)});
    const Baseline baseline = baseline_of(run);
    run.groups.front().question["spp"] = 32;
    const Verdict verdict = failure_of(check_run(run, baseline));
    CHECK(verdict.rule == "another question");
    CHECK(verdict.text == "spp: 16 then, 32 now: vecino accept");
}

TEST_CASE("samples that a budget measured are not gated where they differ", "[gate]") {
    GateRun run = run_of({group_of(kThen)});
    run.groups.front().question["budget"] = "equal_time";
    const Baseline baseline = baseline_of(run);
    CHECK(check_run(run, baseline).count(GateOutcome::pass) > 0);
    run.groups.front().question["spp"] = 17;
    const GateResult result = check_run(run, baseline);
    CHECK(result.count(GateOutcome::fail) == 0);
    CHECK(result.count(GateOutcome::pass) == 0);
    CHECK_FALSE(result.passed());  // nothing was judged
    CHECK(gate_headline(result).starts_with("FAIL: nothing to judge"));
    CHECK(verdict_of(result.verdicts, "measured budget").outcome == GateOutcome::not_gated);
}

TEST_CASE("the worst stands first: facts, then failures by margin, then passes", "[gate]") {
    GateRun run = run_of({group_of(kThen, "fine"), group_of(kThen, "bad"), group_of(kThen, "worse"),
                          group_of(kThen, "broken")});
    const Baseline baseline = baseline_of(run);
    run.groups[1] = group_of(shifted(kThen, -2), "bad");
    run.groups[2] = group_of(shifted(kThen, -4), "worse");
    run.groups[3].faults.push_back({"broken.s1", CellFaultKind::missing, "no result"});
    const GateResult result = check_run(run, baseline);
    CHECK(result.verdicts[0].group == "broken");
    CHECK(result.verdicts[1].group == "worse");
    const auto by_margin = [](const Verdict& a, const Verdict& b) {
        return a.margin_db.value() < b.margin_db.value();
    };
    CHECK(std::is_sorted(result.verdicts.begin() + 1, result.verdicts.begin() + 9, by_margin));
    CHECK(result.count(GateOutcome::fail) == 9);
    CHECK(result.verdicts[9].outcome == GateOutcome::pass);
}

TEST_CASE("a baseline of another matrix is refused", "[gate]") {
    const GateRun run = run_of({group_of(kThen)});
    Baseline baseline = baseline_of(run);
    baseline.matrix = "other";
    const Error error = error_of([&] { check_run(run, baseline); });
    CHECK(error.code() == ExitCode::usage);
    CHECK(std::string(error.what()) ==
          "baseline: found one of the matrix \"other\", allowed: of \"matrix\"");
}
