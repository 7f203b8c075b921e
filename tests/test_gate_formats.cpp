// SPDX-License-Identifier: Apache-2.0
//
// What check prints and writes. test_junit.py reads the XML with a parser.
#include "eval/gate_report.h"
#include "tests/catch.h"
#include "tests/gate_groups.h"

using namespace vecino;

namespace {

const std::vector<double> kThen = {30.0, 30.1, 29.9, 30.05};
const std::string kAwkward = "box.<mean> & \"7\" | `x` \x01\n'*_[1](2)";

GateResult failing() {
    GateRun run = run_of({group_of(kThen, "fine"), group_of(kThen, kAwkward)});
    const Baseline baseline = baseline_of(run);
    run.groups[1] = group_of({25.0, 25.1, 24.9, 25.05}, kAwkward);
    return check_run(run, baseline);
}

GateResult large(std::size_t groups, double loss_db) {
    GateRun run = run_of({});
    for (std::size_t i = 0; i < groups; ++i)
        run.groups.push_back(group_of(kThen, "box.group." + std::to_string(i)));
    const Baseline baseline = baseline_of(run);
    for (RunGroup& group : run.groups)
        for (auto& row : group.rows) {
            const double db = row["metrics"]["psnr_float_db"];
            row["metrics"]["psnr_float_db"] = db - loss_db;
        }
    return check_run(run, baseline);
}

std::size_t count_of(const std::string& text, const std::string& what) {
    std::size_t count = 0;
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
        ++count;
    return count;
}

}  // namespace

TEST_CASE("the text names every failure with value, baseline, limit, margin and rule", "[gate]") {
    const GateResult result = failing();
    const std::string text = gate_text(result);
    CHECK(text.find("FAIL: 4 of 12 comparisons in 2 groups of matrix failed, worst first\n") == 0);
    CHECK(text.find("25.012") != std::string::npos);
    CHECK(text.find("30.012") != std::string::npos);
    CHECK(text.find("default: 5.0") != std::string::npos);
    CHECK(text.find("1 of 2 groups have the baseline's very numbers") != std::string::npos);
    CHECK(text.find("time, over the baseline's: 1.00 to 1.00 x") != std::string::npos);
    CHECK(text.find("not gated: 2 x time: not gated: its class has no time_tolerance_percent") !=
          std::string::npos);
    CHECK(gate_text(large(3, 0)).find("PASS: none of 24 comparisons") == 0);
}

TEST_CASE("JSON holds every verdict", "[gate]") {
    const nlohmann::json json = gate_json(failing());
    CHECK(json["passed"] == false);
    CHECK(json["failed"] == 4);
    CHECK(json["comparisons"] == 12);
    CHECK(json["verdicts"].size() == 14);
    const nlohmann::json& worst = json["verdicts"][0];
    CHECK(worst["outcome"] == "fail");
    CHECK(worst["rule"] == "mean");
    CHECK(worst["group"] == kAwkward);
    CHECK(worst["value"].get<double>() < worst["limit"].get<double>());
    CHECK(worst["margin_db"].get<double>() < 0);
}

TEST_CASE("JUnit XML counts its cases and escapes what is in them", "[gate]") {
    const std::string xml = gate_junit(failing());
    CHECK(xml.find("tests=\"14\" failures=\"4\" errors=\"0\" skipped=\"2\"") != std::string::npos);
    CHECK(count_of(xml, "<testcase ") == 14);
    CHECK(count_of(xml, "<failure ") == 4);
    CHECK(count_of(xml, "<skipped ") == 2);
    CHECK(xml.find("<mean>") == std::string::npos);
    CHECK(xml.find('\x01') == std::string::npos);
}

TEST_CASE("Markdown fits a comment, whatever the run", "[gate]") {
    const std::size_t groups = GENERATE(1, 40, 3000);
    const double loss_db = GENERATE(0.0, 3.0);
    const std::string text = gate_markdown(large(groups, loss_db));
    CHECK(text.size() < 60000);
    CHECK(text.find(loss_db > 0 ? "### vecino check: FAIL" : "### vecino check: PASS") == 0);
    CHECK(count_of(text, "<details>") == 1);
    CHECK(count_of(text, "</details>") == 1);
    if (groups == 3000) CHECK(text.find(" more\n") != std::string::npos);
}

TEST_CASE("Markdown cells cannot leave their table", "[gate]") {
    const std::string text = gate_markdown(failing());
    CHECK(text.find("<mean>") == std::string::npos);
    CHECK(text.find("&lt;mean&gt;") != std::string::npos);
    CHECK(text.find("\\|") != std::string::npos);
    std::size_t at = 0;
    while ((at = text.find("\n| ", at)) != std::string::npos) {
        const std::string line = text.substr(at + 1, text.find('\n', at + 1) - at - 1);
        CHECK(count_of(line, "|") - count_of(line, "\\|") == 9);  // eight columns
        ++at;
    }
}

TEST_CASE("CTest's tags are those that VTK prints", "[gate]") {
    CHECK(ctest_number("a & b", 30.5) ==
          "<CTestMeasurement type=\"numeric/double\" name=\"a &amp; b\">30.5</CTestMeasurement>\n");
    CHECK(ctest_image("TestImage", "/x/y.png") ==
          "<CTestMeasurementFile type=\"image/png\" "
          "name=\"TestImage\">/x/y.png</CTestMeasurementFile>\n");
}

TEST_CASE("a gate that noise makes dull says so", "[gate]") {
    const GateRun sharp = run_of({group_of(kThen)});
    CHECK(gate_text(check_run(sharp, baseline_of(sharp))).find("more seeds") == std::string::npos);
    const GateRun dull = run_of({group_of({30.0, 31.0})});
    CHECK(gate_text(check_run(dull, baseline_of(dull)))
              .find("warning: in 4 comparisons noise explains more than 1 dB") !=
          std::string::npos);
}
