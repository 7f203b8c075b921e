// SPDX-License-Identifier: Apache-2.0
//
// Baselines: what is accepted, what is refused, and that a file gives back what was written.
#include "eval/accept.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/gate_groups.h"
#include "tests/temp_dir.h"

using namespace vecino;

namespace {

const std::vector<double> kThen = {30.0, 30.1, 29.9, 30.05};
const std::vector<double> kNow = {29.0, 29.1, 28.9, 29.05};

std::size_t lines_starting_with(const std::string& text, char mark) {
    std::size_t count = 0;
    for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1)
        count += text[at] == mark ? 1 : 0;
    return count;
}

}  // namespace

TEST_CASE("a baseline that was written reads back the same, one line per group", "[gate]") {
    const TempDir dir;
    const Baseline baseline =
        baseline_of(run_of({group_of(kThen, "a"), group_of(kNow, "b \"quoted\"")}));
    const std::string path = dir.path("b.json");
    write_baseline(path, baseline);
    const Baseline back = read_baseline(path);
    CHECK(back.matrix == baseline.matrix);
    REQUIRE(back.groups.size() == 2);
    for (const auto& [name, group] : baseline.groups) {
        CHECK(back.groups.at(name) == group);
        CHECK(back.groups.at(name).host == group.host);
        CHECK(back.groups.at(name).time_s.mean == group.time_s.mean);
    }
    const std::string text = dir.read("b.json");
    const auto line =
        text.substr(text.find("  \"a\": "), text.find(",\n  \"b") - text.find("  \"a\": "));
    CHECK(line ==
          "  \"a\": {\"seeds\": 4, \"edge.psnr_float_db\": [30.0118689, 0.0857044724], "
          "\"p99_error\": "
          "[0.0947353392, 0.00093306187], \"psnr_float_db\": [30.0118689, 0.0857044724], "
          "\"worst_tile_psnr_db\": [26.0118689, 0.0857044724], \"time_s\": [1, 0]}");
}

TEST_CASE("a faulty baseline is named with its place", "[gate]") {
    const TempDir dir;
    const auto error_in = [&](const std::string& text) {
        const std::string path = dir.write("b.json", text);
        const Error error = error_of([&] { read_baseline(path); });
        CHECK(error.code() == ExitCode::usage);
        return std::string(error.what());
    };
    const auto file = [](const std::string& group) {
        return R"({"format": 1, "matrix": "m", "groups": {"a": )" + group +
               R"(}, "questions": {"a": {"host": "h", "asked": {}}}})";
    };
    CHECK(read_baseline(dir.write("b.json", file(R"({"seeds": 4})"))).groups.size() == 1);
    CHECK(error_in("{").find("b.json") != std::string::npos);
    CHECK(error_in(R"({"format": 2})").find("/format: found 2") != std::string::npos);
    CHECK(error_in(file(R"({"seeds": 0})")).find("/groups/a/seeds") != std::string::npos);
    CHECK(error_in(file(R"({"seeds": 4, "psnr": [1, 2]})")).find("psnr") != std::string::npos);
    CHECK(error_in(file(R"({"seeds": 4, "relmse": [1]})")).find("/groups/a/relmse") !=
          std::string::npos);
    CHECK(error_in(file(R"({"seeds": 4, "relmse": [1, -1]})")).find("/groups/a/relmse/1") !=
          std::string::npos);
}

TEST_CASE("accepting shows old against new and marks what changed", "[gate]") {
    const GateRun old_run = run_of({group_of(kThen, "same"), group_of(kThen, "worse"),
                                    group_of(kThen, "better"), group_of(kThen, "gone")});
    const GateRun run =
        run_of({group_of(kThen, "same"), group_of(kNow, "worse"),
                group_of({31.0, 31.1, 30.9, 31.05}, "better"), group_of(kThen, "fresh")});
    const std::optional<Baseline> old = baseline_of(old_run);
    const AcceptPlan plan = plan_accept(run, old, "");
    CHECK(plan.changed == 4);
    CHECK(plan.faults.empty());
    CHECK(lines_starting_with(plan.table, '!') == 4);
    CHECK(lines_starting_with(plan.table, '~') == 4);
    CHECK(lines_starting_with(plan.table, '+') == 4);
    CHECK(lines_starting_with(plan.table, '-') == 1);
    CHECK(plan.baseline.groups == baseline_of(run).groups);
    CHECK(plan_accept(run, baseline_of(run), "").changed == 0);
    CHECK(plan_accept(run, std::nullopt, "").baseline.groups == baseline_of(run).groups);
}

TEST_CASE("a part is accepted alone", "[gate]") {
    const std::optional<Baseline> old =
        baseline_of(run_of({group_of(kThen, "a"), group_of(kThen, "b"), group_of(kThen, "c")}));
    GateRun run = run_of({group_of(kNow, "a"), group_of(kNow, "b")});
    run.groups[1].faults.push_back({"b.s1", CellFaultKind::missing, "no result"});
    const AcceptPlan plan = plan_accept(run, old, "^a$");
    CHECK(plan.faults.empty());
    CHECK(plan.changed == 1);
    CHECK(plan.baseline.groups.at("b") == old->groups.at("b"));
    CHECK(plan.baseline.groups.contains("c"));
    CHECK_FALSE(plan.baseline.groups.at("a") == old->groups.at("a"));
    CHECK(plan_accept(run, old, "b").faults.size() == 1);
    for (const char* only : {"nothing", "("})
        CHECK(error_of([&] { plan_accept(run, old, only); }).code() == ExitCode::usage);
}
