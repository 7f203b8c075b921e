// SPDX-License-Identifier: Apache-2.0
//
// A method that does not allow a cell's settings: the cell is refused, the run goes on, and where a
// failure's file expects it nothing is wrong with the run.
#include "eval/failure_results.h"
#include "eval/gate_run.h"
#include "tests/catch.h"
#include "tests/program.h"
#include "tests/tiny_run.h"

using namespace vecino;
using Catch::Matchers::Contains;

namespace {

const std::string kRefused = "box.surface_records.s1";

/// surface_records beside schemes, with light found by chance.
struct Refusing : TinyMatrix {
    Refusing() {
        json["fixed"]["light_sampling"] = "none";
        json["include"] = {{{"method", {"surface_records", "interleaved"}}}};
    }

    /// What a failure of the scene says of surface_records.
    void expect(const std::string& verdict) {
        temp.write("box.failure.json",
                   nlohmann::json{{"id", "T1"},
                                  {"title", "Light by chance"},
                                  {"mechanism", "none"},
                                  {"needs", nlohmann::json::object()},
                                  {"reference", "path traced"},
                                  {"measure", {{"signature", "rms_error"}, {"contrast", 1}}},
                                  {"pass_below", 1000},
                                  {"fails_above", 1000},
                                  {"limits_from", "whatever"},
                                  {"expect",
                                   {{{"methods", "surface_records"}, {"verdict", verdict}},
                                    {{"methods", "*"}, {"verdict", "pass"}}}}}
                       .dump());
        json["failures"] = {"box.failure.json"};
    }
    [[nodiscard]] Outcome run_program(const std::string& options = "") const {
        (void)load();
        return run_in(temp, "run tiny.json -o run " + options);
    }
};

}  // namespace

TEST_CASE("a method that refuses its settings fails its own cells, and the run goes on",
          "[refusal][matrix]") {
    const Refusing matrix;
    const Outcome outcome = matrix.run_program();
    CHECK(outcome.code == 2);
    CHECK_THAT(outcome.err, Contains("refused: " + kRefused + ": light_sampling: found none"));
    CHECK_THAT(outcome.out, Contains("2 failed, 0 missing"));
    const auto rows = matrix.rows();
    CHECK(rows.size() == 11);
    for (const auto& [name, row] : rows) {
        CAPTURE(name);
        const bool is_refused = row["method"] == "surface_records";
        CHECK(row["status"] == (is_refused ? "refused" : "ok"));
        CHECK(row.contains("metrics") != is_refused);
    }
    CHECK_THAT(rows.at(kRefused)["reason"].get<std::string>(), Contains("allowed: nee"));
    CHECK_THAT(matrix.temp.read("run/report.html"), Contains(kRefused));

    // It is a result like others: kept, and done again where that is asked for.
    CHECK_THAT(matrix.run_program().out, Contains("0 done now, 11 from an earlier run, 2 failed"));
    CHECK_THAT(matrix.run_program("--rerun failed").out, Contains("2 done now, 9 from an earlier"));
}

TEST_CASE("a refused cell is a fault for a gate unless it is expected", "[refusal][gate]") {
    Refusing matrix;
    const bool is_expected = GENERATE(false, true);
    matrix.expect(is_expected ? "refuses" : "pass");
    const Outcome outcome = matrix.run_program();
    CHECK(outcome.code == (is_expected ? 0 : 2));
    CHECK((outcome.out.find("2 that their methods refuse, as expected") != std::string::npos) ==
          is_expected);
    const GateRun run = read_gate_run(matrix.directory);
    const RunGroup& group = *run.find("box.surface_records");
    CHECK(group.is_refused() == is_expected);
    CHECK(group.faults.size() == (is_expected ? 0 : 2));
    const Outcome check = run_in(matrix.temp, "check run");
    CHECK(check.code == (is_expected ? 0 : 2));
    const auto results = nlohmann::json::parse(matrix.temp.read("run/failures.json"));
    const auto result = std::ranges::find_if(
        results, [](const auto& each) { return each["method"] == "surface_records"; });
    REQUIRE(result != results.end());
    CHECK((*result)["verdict"] == "refuses");
    CHECK((*result)["value"].is_null());
    CHECK((*result)["unexpected"] == !is_expected);
    REQUIRE(run_in(matrix.temp, "report run -o r.md").code == 0);
    const std::string table = matrix.temp.read("r.md");
    CHECK_THAT(table, Contains(is_expected ? "⊘ cannot |" : "⊘ cannot **!** |"));
    CHECK_THAT(table, Contains("1 cannot be run."));
    CHECK_THAT(table, Contains(is_expected ? "none failed; 2 refused, as expected" : "2 failed"));
}

TEST_CASE("a method that is expected to refuse and does not is told", "[refusal][gate]") {
    Refusing matrix;
    matrix.json["fixed"]["light_sampling"] = "nee";
    matrix.expect("refuses");
    CHECK(matrix.run_program().code == 0);
    const Outcome check = run_in(matrix.temp, "check run");
    CHECK(check.code == 2);
    CHECK_THAT(check.out, Contains("expected: refuses"));
}

TEST_CASE("baselines take in no refused cells, and lose those that come to be", "[refusal][gate]") {
    Refusing matrix;
    matrix.json["fixed"]["light_sampling"] = "nee";
    matrix.expect("pass");
    CHECK(matrix.run_program().code == 0);
    const std::string accept = "CI= '" VECINO_PROGRAM "' accept run --baseline b.json";
    CHECK(run_line(matrix.temp, accept).code == 0);
    CHECK_THAT(matrix.temp.read("b.json"), Contains("surface_records"));

    matrix.json["fixed"]["light_sampling"] = "none";
    matrix.expect("refuses");
    CHECK(matrix.run_program().code == 0);
    const Outcome check = run_in(matrix.temp, "check run --baseline b.json");
    CHECK_THAT(check.out, Contains("and the baseline has numbers"));
    CHECK(run_line(matrix.temp, accept + " --yes").code == 0);
    CHECK(matrix.temp.read("b.json").find("surface_records") == std::string::npos);
    CHECK(run_in(matrix.temp, "check run --baseline b.json").code == 0);
}
