// SPDX-License-Identifier: Apache-2.0
//
// The budget "equal_time": measured once, kept, and the same for all seeds.
#include <algorithm>
#include <limits>
#include <map>
#include <string>

#include "eval/equal_time.h"
#include "tests/catch.h"
#include "tests/tiny_run.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;

const std::string kGroup = "box.nearest.f2.equal_time";
constexpr int kPretended_spp = 54321;  // far from what any machine would measure

struct EqualTimeRun : TinyMatrix {
    EqualTimeRun() {
        json["axes"]["scheme"] = "nearest";
        json["axes"]["budget"] = "equal_time";
        json["fixed"]["spp"] = 1000;
    }

    [[nodiscard]] Cell cell(int seed = 1) const {
        const auto cells = expand(load());
        return *std::ranges::find(cells, kGroup + ".s" + std::to_string(seed), &Cell::name);
    }
    [[nodiscard]] std::string stored() const { return temp.read("run/equal_time.json"); }
    [[nodiscard]] Json entry() const { return Json::parse(stored())[kGroup]; }
    [[nodiscard]] int spp_of(int seed) const {
        return rows().at(kGroup + ".s" + std::to_string(seed))["params"]["spp"];
    }
    /// As if an earlier run had measured another budget.
    void pretend() const {
        Json file = Json::parse(stored());
        file[kGroup]["spp"] = kPretended_spp;
        temp.write("run/equal_time.json", file.dump());
        auto changed = rows();
        for (auto& [name, row] : changed)
            if (row["group"] == kGroup) row["params"]["spp"] = kPretended_spp;
        write_rows(changed);
    }
    void kill_seed(int seed) const {
        auto left = rows();
        REQUIRE(left.erase(kGroup + ".s" + std::to_string(seed)) == 1);
        write_rows(left);
    }
};

}  // namespace

TEST_CASE("a measured budget is stored, and shared by all seeds of its group", "[equal_time]") {
    const EqualTimeRun run;
    CHECK(run.run().failed == 0);
    const int spp = run.entry()["spp"];
    CHECK(spp >= 1);  // how many, is up to the machine
    CHECK(run.spp_of(1) == spp);
    CHECK(run.spp_of(2) == spp);
    for (const auto& [name, row] : run.rows()) {
        if (row["group"] == kGroup) {
            CHECK(row["samples_ratio"].get<double>() == Approx(spp * 8 * 6 / (1000.0 * 16 * 12)));
            CHECK(row["counts"]["samples"] == spp * 8 * 6);
            CHECK(row["params"]["spp_asked"] == 1000);
        } else if (row["method"] == "path") {
            CHECK(row["samples_ratio"] == 1.0);
            CHECK(row["params"]["spp"] == 1000);
        }
    }
}

TEST_CASE("a run that goes on uses its measured budget again", "[equal_time]") {
    const EqualTimeRun run;
    run.run();
    run.pretend();
    const std::string before = run.stored();
    run.kill_seed(2);
    CHECK(run.run().done == 1);
    CHECK(run.stored() == before);
    CHECK(run.spp_of(1) == kPretended_spp);
    CHECK(run.spp_of(2) == kPretended_spp);

    // A row of another build is stale, and stays: a seed that is missing beside it gets its budget.
    Json file = Json::parse(run.stored());
    file[kGroup]["state"] = "another build";
    run.temp.write("run/equal_time.json", file.dump());
    auto rows = run.rows();
    for (auto& [name, row] : rows) row["build"] = "another build";
    run.write_rows(rows);
    run.kill_seed(2);
    CHECK(run.run().done == 1);
    CHECK(run.spp_of(1) == kPretended_spp);
    CHECK(run.spp_of(2) == kPretended_spp);
    CHECK(run.entry()["state"] == "another build");
}

TEST_CASE("a budget is measured anew when nothing that it decided is kept", "[equal_time]") {
    const EqualTimeRun run;
    run.run();
    const auto is_measured = [&] {
        const int spp = run.entry()["spp"];
        return spp != kPretended_spp && run.spp_of(1) == spp && run.spp_of(2) == spp;
    };
    run.pretend();
    run.temp.write("box.json", run.temp.read("box.json") + "\n");
    CHECK(run.run().stale > 0);
    CHECK(run.spp_of(1) == kPretended_spp);
    run.run({.only = "", .rerun = Rerun::stale});
    CHECK(is_measured());

    run.temp.write("run/equal_time.json", "{\"box.nearest");
    CHECK(run.run({.only = "", .rerun = Rerun::all}).failed == 0);
    CHECK(is_measured());
}

TEST_CASE("a file that holds no budgets holds none", "[equal_time]") {
    const std::string text =
        GENERATE(values<std::string>({"", "{\"box.nearest", "[1, 2]", "7", "null", "{}"}));
    const EqualTimeRun run;
    const std::string file = run.temp.write("equal_time.json", text);
    EqualTimeBudgets budgets(file);
    CHECK_FALSE(budgets.spp(run.cell()));
    budgets.put(run.cell(), "state", 7);
    CHECK(EqualTimeBudgets(file).spp(run.cell()) == 7);
}

TEST_CASE("a budget is known for the question that it answers alone", "[equal_time]") {
    const EqualTimeRun run;
    const std::string file = run.temp.path("equal_time.json");
    EqualTimeBudgets budgets(file);
    CHECK_FALSE(budgets.spp(run.cell()));
    budgets.put(run.cell(), "state", 7);
    const EqualTimeBudgets again(file);
    CHECK(again.spp(run.cell()) == 7);
    CHECK(again.spp(run.cell(), "state") == 7);
    CHECK_FALSE(again.spp(run.cell(), "another state"));
    CHECK(again.spp(run.cell(2)) == 7);  // whatever the seed
    Cell given = run.cell();
    given.settings.spp = 7;
    CHECK(again.spp(given) == 7);  // whatever was there before it was measured

    Cell other = run.cell();
    SECTION("another number of samples to match") {
        other.spp_asked = 500;
    }
    SECTION("another size") {
        other.settings.size = {32, 24};
    }
    SECTION("another depth") {
        other.settings.max_depth = 1;
    }
    SECTION("another light sampling") {
        other.settings.light_sampling = LightSampling::none;
    }
    SECTION("another scene") {
        other.scene += "x";
    }
    SECTION("another group") {
        other.group += "x";
    }
    CHECK_FALSE(again.spp(other));
}

TEST_CASE("an entry that is no budget is not one", "[equal_time]") {
    const EqualTimeRun run;
    const std::string file = run.temp.path("equal_time.json");
    EqualTimeBudgets(file).put(run.cell(), "state", 7);
    const Json sound = Json::parse(run.temp.read("equal_time.json"));
    Json broken = sound;
    SECTION("no object") {
        broken[kGroup] = 7;
    }
    SECTION("no spp") {
        broken[kGroup].erase("spp");
    }
    SECTION("a text") {
        broken[kGroup]["spp"] = "7";
    }
    SECTION("a fraction") {
        broken[kGroup]["spp"] = 7.5;
    }
    SECTION("nothing to trace") {
        broken[kGroup]["spp"] = 0;
    }
    SECTION("less than nothing") {
        broken[kGroup]["spp"] = -7;
    }
    SECTION("more than can be traced") {
        broken[kGroup]["spp"] = 4294967303;
    }
    SECTION("no question") {
        broken[kGroup].erase("question");
    }
    SECTION("no state") {
        broken[kGroup].erase("state");
    }
    SECTION("a state that is no text") {
        broken[kGroup]["state"] = 3;
    }
    REQUIRE(broken != sound);
    run.temp.write("equal_time.json", broken.dump());
    CHECK_FALSE(EqualTimeBudgets(file).spp(run.cell(), "state"));
    run.temp.write("equal_time.json", sound.dump());
    CHECK(EqualTimeBudgets(file).spp(run.cell(), "state") == 7);
}

TEST_CASE("groups that differ in their weights alone share a measured budget and its frame",
          "[equal_time]") {
    EqualTimeRun run;
    run.json["axes"]["scheme"] = "distance2d";
    run.json["axes"]["weighting"] = {"proportional", "inverse"};
    CHECK(run.run().failed == 0);
    const Json budgets = Json::parse(run.stored());
    REQUIRE(budgets.size() == 2);
    const Json first = budgets.front();
    for (const Json& entry : budgets) CHECK(entry["spp"] == first["spp"]);
    std::map<int, double> trace_s;  // by seed: one frame, and so one time
    for (const auto& [name, row] : run.rows()) {
        if (row["method"] != "distance2d") continue;
        const double time = row["time_s"]["trace"];
        CHECK(trace_s.try_emplace(row["seed"], time).first->second == time);
    }
    CHECK(trace_s.size() == 2);
}

TEST_CASE("an estimate counts a budget that is not measured yet beside equal samples",
          "[equal_time]") {
    EqualTimeRun run;
    const double measured = estimate_run(run.load(), run.directory).samples;
    run.json["axes"]["budget"] = {"equal_samples", "equal_time"};
    const double both = estimate_run(run.load(), run.directory).samples;
    CHECK(both - measured == 2.0 * 16 * 12 * 1000);  // two seeds, as many samples as path tracing
}

TEST_CASE("samples for an equal time follow from rates", "[equal_time]") {
    // 10 s of path tracing; a sample of all low-resolution pixels takes 2 ms.
    CHECK(equal_time_spp({.path_s = 10, .low_s_per_spp = 0.002, .reconstruct_s = 0}) == 5000);
    CHECK(equal_time_spp({.path_s = 10, .low_s_per_spp = 0.002, .reconstruct_s = 1}) == 4500);
    CHECK(equal_time_spp({.path_s = 10, .low_s_per_spp = 0.002, .reconstruct_s = 10}) == 1);
    CHECK(equal_time_spp({.path_s = 10, .low_s_per_spp = 0.002, .reconstruct_s = 11}) == 1);
    CHECK(equal_time_spp({.path_s = 1, .low_s_per_spp = 1e-12, .reconstruct_s = 0}) ==
          std::numeric_limits<int>::max());
}

TEST_CASE("rates are measured on full packets, or on just what was asked for", "[equal_time]") {
    const double packet_s = GENERATE(1e-7, 1e-4, 0.002, 0.1, 0.2, 5.0);  // of 16 samples a pixel
    const auto seconds = [&](int spp) { return (spp + 15) / 16 * packet_s; };
    CAPTURE(packet_s);
    const int many = calibration_spp(10000, seconds);
    CHECK(many % 64 == 0);
    // The rate found is that of many samples, whatever the size of the image.
    CHECK(seconds(many) / many == Approx(seconds(10000) / 10000));
    CHECK((many == 64 || seconds(many) <= 0.31));
    for (const int few : {1, 4, 17, 63}) CHECK(calibration_spp(few, seconds) == few);
}
