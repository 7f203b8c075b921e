// SPDX-License-Identifier: Apache-2.0
#include "eval/gate_time.h"

#include <cmath>

#include "eval/frame_jobs.h"
#include "tests/catch.h"
#include "tests/gate_groups.h"
#include "tests/tiny_run.h"

using namespace vecino;

namespace {

RunGroup timed(const std::vector<double>& times_s) {
    RunGroup group = group_of(std::vector<double>(times_s.size(), 30.0));
    for (std::size_t i = 0; i < times_s.size(); ++i) group.rows[i]["time_s"]["total"] = times_s[i];
    return group;
}

GateClass gating_time(double tolerance) {
    GateClass gate = class_judging("psnr_float_db", 0.1);
    gate.time_tolerance = tolerance;
    return gate;
}

Verdict judged_time(const RunGroup& now, const RunGroup& then, const GateClass& gate) {
    return judge_time(now, gate, baseline_of(then, gate)).value();
}

const std::vector<double> kThen = {1.00, 1.02, 0.98, 1.01};

}  // namespace

TEST_CASE("time fails where the interval of the ratio lies beyond the tolerance", "[gate]") {
    const GateClass gate = gating_time(0.1);
    CHECK(judged_time(timed(kThen), timed(kThen), gate).outcome == GateOutcome::pass);
    const Verdict slow = judged_time(timed({1.30, 1.33, 1.28, 1.31}), timed(kThen), gate);
    CHECK(slow.outcome == GateOutcome::fail);
    CHECK(slow.margin_db.value() < 0);
    CHECK(slow.limit.value() == Approx(1.1 * slow.baseline.value()));
    // As slow on average, but nobody knows.
    CHECK(judged_time(timed({0.9, 1.9, 1.0, 1.7}), timed(kThen), gate).outcome ==
          GateOutcome::pass);
    CHECK(judged_time(timed({1.05, 1.07, 1.03, 1.06}), timed(kThen), gate).outcome ==
          GateOutcome::pass);
}

TEST_CASE("time is compared but not gated where that would not be fair", "[gate]") {
    const RunGroup slow = timed({2.0, 2.0, 2.0, 2.0});
    const GateClass gate = gating_time(0.1);
    const auto not_gated = [](const Verdict& verdict, const std::string& why) {
        CHECK(verdict.outcome == GateOutcome::not_gated);
        CHECK(verdict.text.find(why) != std::string::npos);
        CHECK(verdict.value.value() == Approx(2.0));
    };
    not_gated(judged_time(slow, timed(kThen), class_judging("psnr_float_db", 0.1)),
              "no time_tolerance_percent");
    RunGroup other_cpu = timed(kThen);
    for (auto& row : other_cpu.rows) row["host"] = "another CPU";
    not_gated(judged_time(slow, other_cpu, gate), "other host");
    RunGroup other_threads = timed(kThen);
    for (auto& row : other_threads.rows) row["threads"] = 8;
    not_gated(judged_time(slow, other_threads, gate), "other host");
    not_gated(judged_time(timed({2.0, 2.0}), timed({1.0, 1.0}), gate), "fewer than 3 seeds");
}

TEST_CASE("the interval of a ratio is Welch's", "[gate]") {
    // Equal sides: 2 n - 2 degrees of freedom, t of 6 at 95 % is 2.447.
    const TimeRatio ratio = time_ratio({2.0, 0.1}, 4, {1.0, 0.1}, 4);
    CHECK(ratio.ratio == 2.0);
    const double half = 2.446912 * 0.1 * std::sqrt(0.5);
    CHECK(ratio.low.value() == Approx(2 * std::exp(-half)).epsilon(1e-5));
    CHECK(ratio.high.value() == Approx(2 * std::exp(half)).epsilon(1e-5));
    CHECK_FALSE(time_ratio({2.0, 0.1}, 1, {1.0, 0.1}, 4).low);
}

TEST_CASE("a run takes seeds in turn, so that a slow minute meets all groups alike", "[gate]") {
    TinyMatrix tiny;
    tiny.json["axes"]["reduction"] = {2, 3};
    tiny.json["axes"]["seed"] = {1, 2, 3};
    const std::vector<Cell> cells = expand(tiny.load());
    std::vector<std::uint32_t> seeds;
    std::size_t done = 0;
    for (const FrameJob& job :
         frame_jobs(plan_run(cells, {}, [](const Cell&) { return CellState::missing; }))) {
        if (job.traces) seeds.push_back(job.settings.seed);
        done += job.cells.size();
    }
    CHECK(done == cells.size());
    CHECK(seeds == std::vector<std::uint32_t>{1, 1, 1, 2, 2, 2, 3, 3, 3});
}
