// SPDX-License-Identifier: Apache-2.0
//
// Published numbers against ours, and the JSON of all verdicts.
#include <string>
#include <vector>

#include "tests/catch.h"
#include "tests/group_summaries.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;

Json share_item(double published, double within) {
    return {{"id", "share"},
            {"section", "1"},
            {"text", "largest share"},
            {"published", published},
            {"unit", "%"},
            {"quantity", "largest_time_share"},
            {"of", {{"method", "mean"}}},
            {"within", within}};
}

Json time_item(const std::string& unit, const Json& more = Json::object()) {
    Json item = {{"id", "time"},
                 {"section", "1"},
                 {"text", "time"},
                 {"published", 2},
                 {"unit", unit},
                 {"quantity", "time"},
                 {"of", {{"method", "path"}}}};
    item.update(more);
    return item;
}

ItemResult result_of(const Json& item, const Groups& groups, Json parts = Json::object()) {
    parts["items"] = Json::array({item});
    return evaluate(read_parts(parts), groups).items.at(0);
}

/// Path tracing of 10 s and a scheme of so many percent of it in each seed.
Groups shares(const std::vector<double>& percent) {
    std::vector<double> times;
    for (const double share : percent) times.push_back(0.1 * share);
    const std::vector<double> path(percent.size(), 10.0);
    return {timed_group("path", Json::object(), path), timed_group("mean", Json::object(), times)};
}

Groups steady_share(double percent) {
    return shares({percent, percent, percent, percent});
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a share is reproduced if its interval lies within the points", "[reproduction]") {
    struct Case {
        double percent;
        ClaimVerdict verdict;
    };
    const Case c = GENERATE(values<Case>({{20, ClaimVerdict::reproduced},
                                          {24.9, ClaimVerdict::reproduced},
                                          {25.1, ClaimVerdict::not_reproduced},
                                          {15.1, ClaimVerdict::reproduced},
                                          {14.9, ClaimVerdict::not_reproduced}}));
    CAPTURE(c.percent);
    const ItemResult result = result_of(share_item(20, 5), steady_share(c.percent));
    CHECK(result.verdict == c.verdict);
    REQUIRE(result.ours);
    CHECK(result.ours->mean == Approx(c.percent));
    CHECK(result.ratio == Approx(c.percent / 20));
    CHECK(result.slowest == "box.mean");
    CHECK(result.remark.empty());
}

TEST_CASE("a share whose interval crosses an end of the points is a trend", "[reproduction]") {
    // Over -1, 1, -1, 1 of the mean, the interval is 3.182 * sqrt(4 / 3) / 2 = 1.837 to each side.
    struct Case {
        double percent;
        ClaimVerdict verdict;
    };
    const Case c = GENERATE(values<Case>({{23.1, ClaimVerdict::reproduced},
                                          {23.2, ClaimVerdict::trend},
                                          {26.8, ClaimVerdict::trend},
                                          {26.9, ClaimVerdict::not_reproduced},
                                          {16.9, ClaimVerdict::reproduced},
                                          {16.8, ClaimVerdict::trend},
                                          {13.2, ClaimVerdict::trend},
                                          {13.1, ClaimVerdict::not_reproduced}}));
    CAPTURE(c.percent);
    const auto groups = shares({c.percent - 1, c.percent + 1, c.percent - 1, c.percent + 1});
    CHECK(result_of(share_item(20, 5), groups).verdict == c.verdict);
}

TEST_CASE("an interval wider than the points on both sides is a trend", "[reproduction]") {
    CHECK(result_of(share_item(20, 5), shares({10, 30, 10, 30})).verdict == ClaimVerdict::trend);
}

TEST_CASE("a share is that of the slowest in the time of the slowest path tracing",
          "[reproduction]") {
    const Groups groups{timed_group("path", {{"scene", "a.json"}}, {10, 10}),
                        timed_group("path", {{"scene", "b.json"}}, {20, 20}),
                        timed_group("mean", {{"scene", "a.json"}, {"window", 3}}, {4, 4}),
                        timed_group("mean", {{"scene", "a.json"}, {"window", 5}}, {5, 5}),
                        timed_group("mean", {{"scene", "b.json"}, {"window", 3}}, {3, 3}),
                        timed_group("distance2d", {{"scene", "b.json"}}, {19, 19})};
    const ItemResult all = result_of(share_item(25, 5), groups);
    CHECK(all.slowest == "a.mean.window5");
    CHECK(all.ours->mean == Approx(25));
    Json of_a = share_item(50, 5);
    of_a["of"]["scene"] = "a";
    CHECK(result_of(of_a, groups).ours->mean == Approx(50));
    Json of_b = share_item(15, 5);
    of_b["of"]["scene"] = "b";
    CHECK(result_of(of_b, groups).ours->mean == Approx(15));
}

TEST_CASE("a share is one of path tracing that was rendered alike", "[reproduction]") {
    const Json nee = {{"light_sampling", "nee"}};
    const Groups groups{timed_group("path", Json::object(), {10, 10}),
                        timed_group("mean", Json::object(), {5, 5}),
                        timed_group("path", nee, {40, 40}), timed_group("mean", nee, {4, 4})};
    const Json chance = {{"id", "c"}, {"label", "c"}, {"where", {{"light_sampling", "none"}}}};
    const Json parts = {{"variants", Json::array({chance})}};
    CHECK(result_of(share_item(50, 5), groups, parts).ours->mean == Approx(50));
    Json item = share_item(10, 5);
    item["of"]["light_sampling"] = "nee";
    CHECK(result_of(item, groups, parts).ours->mean == Approx(10));
}

TEST_CASE("a share has no verdict without seeds to tell by, or without path tracing",
          "[reproduction]") {
    const ItemResult one = result_of(share_item(20, 5), shares({20}));
    CHECK(one.verdict == ClaimVerdict::not_testable);
    CHECK(one.ours->mean == Approx(20));
    CHECK(one.remark == "one seed has no interval");

    Groups groups = steady_share(20);
    groups[0].seeds_done.pop_back();
    groups[0].times_s.pop_back();
    const ItemResult other_seeds = result_of(share_item(20, 5), groups);
    CHECK(other_seeds.verdict == ClaimVerdict::not_testable);
    CHECK(other_seeds.remark == "no path tracing of the same seeds");
    CHECK_FALSE(other_seeds.ours);

    groups.erase(groups.begin());
    CHECK(result_of(share_item(20, 5), groups).remark == "no path tracing of the same seeds");
    const ItemResult none = result_of(share_item(20, 5), {});
    CHECK(none.remark == "no result");
    CHECK(none.slowest.empty());
    CHECK(none.verdict == ClaimVerdict::not_testable);
}

TEST_CASE("a group without a finished cell is no result", "[reproduction]") {
    Groups groups = steady_share(20);
    groups[1] = group_of("mean", Json::object(), {});
    groups[1].time_s = 0;
    CHECK(result_of(share_item(20, 5), groups).remark == "no result");
}

TEST_CASE("times are those of another machine, and shown at the published parameters alone",
          "[reproduction]") {
    const Json at = {{"times_at", {{"spp", 100}, {"light_sampling", "none"}}}};
    const Groups groups{timed_group("path", Json::object(), {60, 180})};
    const ItemResult minutes = result_of(time_item("min"), groups, at);
    CHECK(minutes.verdict == ClaimVerdict::not_testable);
    CHECK(minutes.ours->mean == Approx(2));
    CHECK(minutes.ratio == Approx(1));
    CHECK(minutes.remark == "times of another machine");
    CHECK(result_of(time_item("h"), groups, at).ours->mean == Approx(2.0 / 60));

    const Json elsewhere = {{"times_at", {{"spp", 10000}}}};
    const ItemResult other = result_of(time_item("min"), groups, elsewhere);
    CHECK_FALSE(other.ours);
    CHECK(other.ratio == 0);
    CHECK(other.verdict == ClaimVerdict::not_testable);
    CHECK(other.remark == "not run at the published size and samples");
}

TEST_CASE("a time of more samples is extrapolated, beside one of equal noise", "[reproduction]") {
    const Json chance = {
        {"id", "chance"}, {"label", "chance"}, {"where", {{"light_sampling", "none"}}}};
    const Json nee = {{"id", "nee"}, {"label", "nee"}, {"where", {{"light_sampling", "nee"}}}};
    const Json parts = {{"variants", {chance, nee}}};
    const Json item = time_item("h", {{"quantity", "extrapolated_time"}, {"spp", 4000}});
    Groups groups{timed_group("path", Json::object(), {36, 36})};
    groups[0].statistics->whole.noise = 0.01;
    const ItemResult alone = result_of(item, groups, parts);
    CHECK(alone.ours->mean == Approx(0.4));  // 36 s for 100 spp
    CHECK(alone.verdict == ClaimVerdict::not_testable);
    CHECK(alone.remark ==
          "extrapolated from the measured rate; no other path tracing to compare with");

    // 4000 spp by chance have a noise of 0.01 / 40; by nee 12 s have 0.001, and 48 s as much.
    groups.push_back(timed_group("path", {{"light_sampling", "nee"}}, {12, 12}));
    groups[1].statistics->whole.noise = 0.001;
    const ItemResult beside = result_of(item, groups, parts);
    CHECK(beside.ours->mean == Approx(0.4));
    CHECK(has(beside.remark, "equal noise takes 0.8 min by nee"));

    groups[1].statistics->whole.noise.reset();
    CHECK(has(result_of(item, groups, parts).remark, "no other path tracing"));
}

TEST_CASE("the JSON of a reproduction holds every verdict with its numbers", "[reproduction]") {
    const Json test = {{"quantity", "quality"},
                       {"of", {{"method", "mean"}}},
                       {"is", "higher"},
                       {"than", {{"method", "path"}}}};
    const Json parts = {{"items", {share_item(20, 5), time_item("min")}},
                        {"claims", Json::array({claim_json(test)})}};
    Groups groups = steady_share(21);
    groups[0].statistics->whole = statistics_of(errors_db(0));
    groups[1].statistics->whole = statistics_of(errors_db(-3));
    const Reproduction specification = read_parts(parts);
    const Json json = reproduction_json(specification, evaluate(specification, groups));

    REQUIRE(json["items"].size() == 2);
    const Json& share = json["items"][0];
    CHECK(share["id"] == "share");
    CHECK(share["published"] == 20);
    CHECK(share["unit"] == "%");
    CHECK(share["ours"]["mean"].get<double>() == Approx(21));
    CHECK(share["ours"]["low"].get<double>() == Approx(21));
    CHECK(share["ratio"].get<double>() == Approx(1.05));
    CHECK(share["verdict"] == "reproduced");
    CHECK(share["slowest"] == "box.mean");
    CHECK(share["remark"] == "");
    CHECK(json["items"][1]["id"] == "time");
    CHECK(json["items"][1]["remark"] == "times of another machine");

    REQUIRE(json["claims"].size() == 1);
    CHECK(json["claims"][0]["id"] == "c");
    const Json& results = json["claims"][0]["results"];
    REQUIRE(results.size() == 2);
    CHECK(results[0]["variant"] == "printed");
    CHECK(results[0]["region"] == "whole");
    CHECK(results[0]["verdict"] == "reproduced");
    CHECK(results[0]["holds"] == 1);
    CHECK(results[0]["fails"] == 0);
    CHECK(results[0]["open"] == 0);
    CHECK(results[0]["missing"] == 0);
    REQUIRE(results[0]["pairs"].size() == 1);
    const Json& pair = results[0]["pairs"][0];
    CHECK(pair["scene"] == "box");
    CHECK(pair["of"] == "box.mean");
    CHECK(pair["than"] == "box.path");
    CHECK(pair["outcome"] == "holds");
    CHECK(pair["difference_db"]["mean"].get<double>() == Approx(3));
    // No regions were measured.
    CHECK(results[1]["region"] == "interior");
    CHECK(results[1]["verdict"] == "not testable");
    CHECK(results[1]["missing"] == 1);
    CHECK(results[1]["pairs"][0]["outcome"] == "missing");
    CHECK_FALSE(results[1]["pairs"][0].contains("difference_db"));
}

TEST_CASE("an item without a number of ours is null in JSON", "[reproduction]") {
    const Reproduction specification = read_parts({{"items", Json::array({share_item(20, 5)})}});
    const Json item = reproduction_json(specification, evaluate(specification, {}))["items"][0];
    CHECK(item["ours"].is_null());
    CHECK(item["ratio"].is_null());
    CHECK(item["verdict"] == "not testable");
}
