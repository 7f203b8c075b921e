// SPDX-License-Identifier: Apache-2.0
//
// Runs on disk against baselines, and the gate that guards this repository: the committed baselines
// of configs/thesis-quick.json and thesis-gate.json, held by this build and broken by one with a
// wrong weight.
#include <set>

#include "eval/gate_run.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/program.h"
#include "tests/tiny_run.h"

using namespace vecino;
using nlohmann::json;

namespace {

const std::string kProgram = "'" VECINO_PROGRAM "' ";
const std::string kDamaged = "'" VECINO_DAMAGED_PROGRAM "' ";

std::string config(const std::string& matrix) {
    return "'" VECINO_SOURCE_DIR "/configs/" + matrix + ".json' ";
}
std::string baseline(const std::string& matrix) {
    return "--baseline '" VECINO_SOURCE_DIR "/configs/baselines/" + matrix + ".json' ";
}

/// The only fault of a run after a change to the row of one cell.
template <class Change>
CellFault fault_after(const TinyMatrix& tiny, Change change) {
    auto rows = tiny.rows();
    change(rows);
    tiny.write_rows(rows);
    std::vector<CellFault> faults;
    for (const RunGroup& group : read_gate_run(tiny.directory).groups)
        faults.insert(faults.end(), group.faults.begin(), group.faults.end());
    REQUIRE(faults.size() == 1);
    return faults.front();
}

using Rows = std::map<std::string, json>;
const std::string kCell = "box.mean.f2.w3.s2";

}  // namespace

TEST_CASE("a run is read group by group, with what is wrong with its cells", "[gate]") {
    const TinyMatrix tiny;
    tiny.run();
    const GateRun sound = read_gate_run(tiny.directory);
    CHECK(sound.matrix == "tiny");
    REQUIRE(sound.groups.size() == 4);
    const RunGroup& mean = *sound.find("box.mean.f2.w3");
    CHECK(mean.faults.empty());
    CHECK(mean.errors(find_gate_metric("psnr_float_db").value()).value().size() == 2);
    CHECK_FALSE(mean.question.contains("seed"));
    CHECK(mean.question["reference"]["spp"] == 128);

    CHECK(fault_after(tiny, [](Rows& rows) { rows.erase(kCell); }).kind == CellFaultKind::missing);
    tiny.run();
    CHECK(fault_after(tiny, [](Rows& rows) {
              rows[kCell]["status"] = "failed";
              rows[kCell]["reason"] = "no luck";
          }).reason == "no luck");
    tiny.run({"", Rerun::failed});
    CHECK(fault_after(tiny, [](Rows& rows) {
              rows[kCell]["metrics"]["non_finite"]["count"] = 3;
          }).kind == CellFaultKind::non_finite);
    tiny.run({"", Rerun::all});
    CHECK(fault_after(tiny, [](Rows& rows) { rows[kCell]["build"] = "older"; }).kind ==
          CellFaultKind::stale);
    CHECK(fault_after(tiny, [](Rows& rows) {
              rows[kCell]["build"] = rows["box.path.s1"]["build"];
              rows[kCell]["params"]["spp"] = 9;
          }).reason == "other parameters");
}

TEST_CASE("a scene file that changed during a run makes it stale", "[gate]") {
    const TinyMatrix tiny;
    tiny.run();
    auto rows = tiny.rows();
    rows[kCell]["scene_hash"] = "another";
    tiny.write_rows(rows);
    for (const RunGroup& group : read_gate_run(tiny.directory).groups)
        CHECK_FALSE(group.faults.empty());
}

TEST_CASE("accept and check as a script sees them", "[gate][cli]") {
    TinyMatrix tiny;
    tiny.json["axes"]["seed"] = {1, 2, 3, 4, 5, 6};
    tiny.run();
    const TempDir& dir = tiny.temp;
    const std::string check = kProgram + "check run --baseline b.json ";
    const std::string accept = "CI= " + kProgram + "accept run --baseline b.json ";
    CHECK(run_line(dir, check).code == 2);
    CHECK(run_line(dir, "CI=1 " + kProgram + "accept run --baseline b.json").code == 64);
    CHECK(run_line(dir, accept).code == 0);
    CHECK(run_line(dir, accept).out.find("nothing changed") != std::string::npos);
    const Outcome passed = run_line(dir, check + "--junit j.xml --markdown m.md --ctest");
    CHECK(passed.code == 0);
    CHECK(passed.out.find("<CTestMeasurement type=\"numeric/double\" name=\"box.path ") !=
          std::string::npos);
    CHECK(dir.names().contains("j.xml"));
    CHECK(dir.names().contains("m.md"));

    auto rows = tiny.rows();
    for (auto& [name, row] : rows)
        if (row["group"] == "box.mean.f2.w3") row["metrics"]["psnr_float_db"] = 3.0;
    tiny.write_rows(rows);
    const Outcome failed = run_line(dir, check + "--ctest");
    CHECK(failed.code == 2);
    CHECK(failed.out.find("FAIL: 1 of ") == 0);
    for (const char* image : {"TestImage", "ValidImage"})
        CHECK(failed.out.find("name=\"" + std::string(image) + "\">" + tiny.directory) !=
              std::string::npos);
    CHECK(failed.err.find("vecino accept run --baseline b.json") != std::string::npos);
    const json verdicts = json::parse(run_line(dir, check + "--json").out)["verdicts"];
    CHECK(verdicts[0]["group"] == "box.mean.f2.w3");

    // Nothing is overwritten unless somebody said so.
    const std::string before = dir.read("b.json");
    CHECK(run_line(dir, accept).code == 64);
    CHECK(dir.read("b.json") == before);
    CHECK(run_line(dir, accept + "--yes").code == 0);
    CHECK(dir.read("b.json") != before);
    CHECK(run_line(dir, check).code == 0);

    rows[kCell]["metrics"]["non_finite"]["count"] = 1;
    tiny.write_rows(rows);
    CHECK(run_line(dir, check).code == 5);
    CHECK(run_line(dir, accept + "--yes").code == 2);
    rows.erase(kCell);
    tiny.write_rows(rows);
    CHECK(run_line(dir, check).code == 2);
    CHECK(run_line(dir, kProgram + "check nowhere --baseline b.json").code == 4);
    CHECK(run_line(dir, check + "--json --ctest").code == 64);
}

TEST_CASE("the committed baselines of the thesis's schemes hold", "[gate]") {
    const std::string matrix = GENERATE(values<std::string>({"thesis-gate", "thesis-quick"}));
    CAPTURE(matrix);
    const TempDir dir;
    // Times are not gated: one repeat of each will do.
    dir.write("once.json", json{{"name", matrix},
                                {"extends", VECINO_SOURCE_DIR "/configs/" + matrix + ".json"},
                                {"measure", {{"repeat", 1}}}}
                               .dump());
    REQUIRE(run_line(dir, kProgram + "run once.json -o out").code == 0);
    const Outcome check = run_line(dir, kProgram + "check out " + baseline(matrix));
    INFO(check.out);
    CHECK(check.code == 0);
}

TEST_CASE("one wrong weight of a scheme is caught by the committed baseline", "[gate]") {
    const TempDir dir;
    REQUIRE(run_line(dir, kDamaged + "run " + config("thesis-gate") + "-o out").code == 0);
    const Outcome check =
        run_line(dir, kProgram + "check out " + baseline("thesis-gate") + "--json");
    CHECK(check.code == 2);
    std::set<std::string> methods, classes;
    const json verdicts = json::parse(check.out)["verdicts"];
    for (const json& verdict : verdicts) {
        if (verdict["outcome"] != "fail") continue;
        CHECK((verdict["rule"] == "mean" || verdict["rule"] == "seeds"));
        classes.insert(verdict["class"].get<std::string>());
        const std::string group = verdict["group"];
        const std::size_t dot = group.find('.') + 1;
        methods.insert(group.substr(dot, group.find('.', dot) - dot));
    }
    // Every scheme that weighs neighbours, and nothing else.
    CHECK(classes == std::set<std::string>{"thesis schemes"});
    CHECK(methods ==
          std::set<std::string>{"mean", "distance2d", "distance3d", "distance3d_normal"});
}
