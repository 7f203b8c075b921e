// SPDX-License-Identifier: Apache-2.0
//
// Which results a claim compares: selections, variants, pairs and regions.
#include <algorithm>
#include <string>
#include <vector>

#include "tests/catch.h"
#include "tests/group_summaries.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

Json quality_test(const Json& of, const Json& than) {
    return {{"quantity", "quality"}, {"of", of}, {"is", "higher"}, {"than", than}};
}

/// "of/than" of each pair, without what all groups have in common.
Names pairs_of(const Json& of, const Json& than, const Groups& groups) {
    Names names;
    for (const PairResult& pair : judge(claim_json(quality_test(of, than)), groups).pairs)
        names.push_back(pair.of + "/" + pair.than);
    std::ranges::sort(names);
    return names;
}

Selection selection(const Json& json) {
    return Selection::read(JsonValue(json, "test.json"));
}

Names selected(const Groups& groups, const Json& of, const Json& where = Json::object()) {
    Names names;
    for (const GroupSummary* group : select(groups, selection(of), {"", "", selection(where), {}}))
        names.push_back(group->group);
    return names;
}

GroupSummary plain(const std::string& method, const Json& more = Json::object()) {
    return group_of(method, more, errors_db(0));
}

SeedStatisticsByRegion by_region(double whole, double edge, double interior) {
    SeedStatisticsByRegion statistics{statistics_of(errors_db(whole)), PerRegion<SeedStatistics>()};
    (*statistics.regions)[region_index(Region::edge)] = statistics_of(errors_db(edge));
    (*statistics.regions)[region_index(Region::interior)] = statistics_of(errors_db(interior));
    return statistics;
}

}  // namespace

TEST_CASE("a pair agrees in scene, method, reduction and window", "[reproduction]") {
    Groups groups;
    for (const char* scene : {"a.json", "b.json"})
        for (const char* method : {"mean", "distance2d"})
            for (const int reduction : {2, 3})
                for (const int window : {3, 5})
                    groups.push_back(plain(
                        method, {{"scene", scene}, {"reduction", reduction}, {"window", window}}));
    const ClaimResult result =
        judge(claim_json(quality_test({{"method", "mean"}}, {{"method", "distance2d"}})), groups);
    CHECK(result.pairs.size() == 8);
    for (const PairResult& pair : result.pairs) {
        CHECK(pair.of == pair.scene + ".mean" + pair.of.substr(pair.scene.size() + 5));
        CHECK(pair.than == pair.scene + ".distance2d" + pair.of.substr(pair.scene.size() + 5));
    }
    // Without a method, that of the other side.
    CHECK(judge(claim_json(quality_test({{"window", 5}}, {{"window", 3}})), groups).pairs.size() ==
          8);
}

TEST_CASE("a selection that names a parameter frees its pairs of it", "[reproduction]") {
    const Groups groups{plain("mean", {{"window", 3}}), plain("mean", {{"window", 5}}),
                        plain("mean", {{"window", 7}})};
    const std::string w3 = "box.mean.window3", w5 = "box.mean.window5", w7 = "box.mean.window7";
    CHECK(pairs_of({{"window", 3}}, {{"window", {5, 7}}}, groups) ==
          Names{w3 + "/" + w5, w3 + "/" + w7});
    CHECK(pairs_of({{"window", 7}}, {{"method", "mean"}}, groups) ==
          Names{w7 + "/" + w3, w7 + "/" + w5, w7 + "/" + w7});
    CHECK(pairs_of({{"method", "mean"}}, {{"method", "mean"}}, groups) ==
          Names{w3 + "/" + w3, w5 + "/" + w5, w7 + "/" + w7});
}

TEST_CASE("results of two scenes are never compared", "[reproduction]") {
    const Groups groups{plain("mean", {{"scene", "a.json"}}), plain("mean", {{"scene", "b.json"}})};
    CHECK(pairs_of({{"scene", "a"}}, {{"scene", "b"}}, groups).empty());
    CHECK(pairs_of({{"scene", "a"}}, {{"scene", {"a", "b"}}}, groups).size() == 1);
}

TEST_CASE("a pair agrees in what renders have too", "[reproduction]") {
    const auto [key, one, other] = GENERATE(table<std::string, Json, Json>(
        {{"spp_asked", 100, 400}, {"size", Json{8, 8}, Json{16, 16}}, {"max_depth", 1, 2}}));
    const Groups groups{plain("path", {{key, one}}), plain("path", {{key, other}}),
                        plain("mean", {{key, one}}), plain("mean", {{key, other}})};
    CHECK(pairs_of({{"method", "mean"}}, {{"method", "path"}}, groups).size() == 2);
    const std::string named = key == "spp_asked" ? "spp" : key;
    CHECK(pairs_of({{"method", "mean"}, {named, Json::array({one})}}, {{"method", "path"}}, groups)
              .size() == 2);
}

TEST_CASE("the first seed of a group is no parameter of it", "[reproduction]") {
    const Groups groups{plain("path", {{"seed", 1}}), plain("mean", {{"seed", 2}})};
    CHECK(pairs_of({{"method", "mean"}}, {{"method", "path"}}, groups).size() == 1);
}

TEST_CASE("path tracing is compared with every reduction and window", "[reproduction]") {
    Groups groups{plain("path")};
    for (const int reduction : {2, 3})
        for (const int window : {3, 5})
            groups.push_back(plain("mean", {{"reduction", reduction}, {"window", window}}));
    CHECK(pairs_of({{"method", "mean"}}, {{"method", "path"}}, groups).size() == 4);
    CHECK(pairs_of({{"method", "path"}}, {{"method", "mean"}, {"window", 5}}, groups).size() == 2);
}

TEST_CASE("other budgets are selected by name alone", "[reproduction]") {
    const Groups groups{plain("path"), plain("mean"), plain("mean", {{"budget", "equal_samples"}}),
                        plain("mean", {{"budget", "equal_time"}})};
    CHECK(selected(groups, {{"method", "mean"}}) == Names{"box.mean"});
    CHECK(selected(groups, Json::object()) == Names{"box.path", "box.mean"});
    CHECK(selected(groups, {{"budget", "equal_time"}}) == Names{"box.mean.budget\"equal_time\""});
    CHECK(selected(groups, {{"budget", {"equal_samples", "equal_time"}}}).size() == 2);
    CHECK(selected(groups, {{"budget", "same_spp"}}) == Names{"box.path", "box.mean"});
}

TEST_CASE("a ceiling is selected by its name alone", "[reproduction]") {
    // A ceiling is made from the reference: it has neither spp nor a budget.
    GroupSummary ceiling = plain("mean");
    ceiling.method = "blocky_ceiling";
    ceiling.group = "box.blocky_ceiling";
    ceiling.params = {{"scene", "box.json"}, {"method", "blocky_ceiling"}, {"reduction", 2}};
    const Groups groups{plain("path"), plain("mean"), ceiling};
    CHECK(selected(groups, {{"reduction", 2}}) == Names{"box.mean"});
    CHECK(selected(groups, Json::object()) == Names{"box.path", "box.mean"});
    CHECK(selected(groups, {{"method", "blocky_ceiling"}}, {{"spp", 100}}) ==
          Names{"box.blocky_ceiling"});
}

TEST_CASE("variants choose by what they name, and an option that is not read fits every one",
          "[reproduction]") {
    const Groups groups{plain("path"),
                        plain("mean"),
                        plain("distance2d", {{"weighting", "proportional"}}),
                        plain("distance2d", {{"weighting", "inverse"}}),
                        plain("mean", {{"light_sampling", "nee"}, {"spp_asked", 10}}),
                        plain("mean", {{"light_sampling", "nee"}, {"spp_asked", 20}})};
    const Json by_chance = {{"light_sampling", "none"}, {"weighting", "proportional"}};
    const Json prose = {{"light_sampling", "none"}, {"weighting", "inverse"}};
    const Json nee = {{"light_sampling", "nee"}, {"spp", 20}};
    const Json all = Json::object();
    CHECK(selected(groups, all, by_chance) == Names{"box.path", "box.mean", groups[2].group});
    CHECK(selected(groups, all, prose) == Names{"box.path", "box.mean", groups[3].group});
    CHECK(selected(groups, all, nee) == Names{groups[5].group});
    // What a selection names goes before its variant.
    CHECK(selected(groups, {{"weighting", "inverse"}}, by_chance) == Names{groups[3].group});
    CHECK(selected(groups, {{"spp", 10}}, nee) == Names{groups[4].group});
}

TEST_CASE("spp is what was asked for, not what a budget made of it", "[reproduction]") {
    const Groups groups{plain("mean", {{"spp", 400}, {"budget", "equal_samples"}})};
    CHECK(selected(groups, {{"spp", 100}, {"budget", "equal_samples"}}).size() == 1);
    CHECK(selected(groups, {{"spp", 400}, {"budget", "equal_samples"}}).empty());
}

TEST_CASE("a named parameter that a result lacks does not fit", "[reproduction]") {
    const Groups groups{plain("path"), plain("nearest"), plain("mean")};
    CHECK(selected(groups, {{"window", 3}}) == Names{"box.mean"});
    CHECK(selected(groups, {{"reduction", 2}}) == Names{"box.nearest", "box.mean"});
}

TEST_CASE("every variant gets a result of its own", "[reproduction]") {
    const Json variants = {
        {{"id", "chance"}, {"label", "by chance"}, {"where", {{"light_sampling", "none"}}}},
        {{"id", "nee"}, {"label", "by nee"}, {"where", {{"light_sampling", "nee"}}}}};
    const Json nee = {{"light_sampling", "nee"}};
    const Groups groups{plain("path"), group_of("mean", Json::object(), errors_db(-1)),
                        plain("path", nee), group_of("mean", nee, errors_db(1))};
    const auto results =
        judge_all(claim_json(quality_test({{"method", "mean"}}, {{"method", "path"}})), groups,
                  {{"variants", variants}});
    REQUIRE(results.size() == 4);
    CHECK(results[0].variant == "chance");
    CHECK(results[0].region.empty());
    CHECK(results[0].verdict == ClaimVerdict::reproduced);
    CHECK(results[1].variant == "chance");
    CHECK(results[1].region == "interior");
    CHECK(results[2].variant == "nee");
    CHECK(results[2].verdict == ClaimVerdict::not_reproduced);
    CHECK(results[2].fails == 1);
}

TEST_CASE("regions are those of each side of a test", "[reproduction]") {
    GroupSummary mean = plain("mean");
    mean.statistics = by_region(0, 6, -4);
    GroupSummary path = plain("path");
    path.statistics = by_region(0, 1, -1);
    Json test = quality_test({{"method", "mean"}}, {{"method", "path"}});
    const auto difference = [&] {
        return judge(claim_json(test), {mean, path}).pairs.at(0).difference_db.mean;
    };
    CHECK(difference() == Approx(0).margin(1e-12));
    test["regions"] = {"edge", "edge"};
    CHECK(difference() == Approx(1 - 6));
    test["regions"] = {"edge", "interior"};
    CHECK(difference() == Approx(-1 - 6));
    test["regions"] = {"interior", "edge"};
    CHECK(difference() == Approx(1 + 4));
    test["regions"] = {"emitter", "emitter"};  // has no pixels here
    CHECK(judge(claim_json(test), {mean, path}).verdict == ClaimVerdict::not_testable);
}

TEST_CASE("the interior is told apart where a test is of the whole image, and only there",
          "[reproduction]") {
    GroupSummary mean = plain("mean");
    mean.statistics = by_region(2, 6, -4);
    GroupSummary path = plain("path");
    path.statistics = by_region(0, 1, -1);
    Json whole = quality_test({{"method", "mean"}}, {{"method", "path"}});
    Json edge = whole;
    edge["regions"] = {"edge", "edge"};
    const Groups groups{mean, path};
    CHECK(judge_all(claim_json(edge), groups).size() == 1);
    const auto both = judge_all(claim_json({whole, edge}), groups);
    REQUIRE(both.size() == 2);
    CHECK(both[0].region.empty());
    CHECK(both[0].pairs.at(0).difference_db.mean == Approx(-2));
    CHECK(both[0].pairs.at(1).difference_db.mean == Approx(-5));
    CHECK(both[1].region == "interior");
    CHECK(both[1].pairs.at(0).difference_db.mean == Approx(3));
    CHECK(both[1].pairs.at(1).difference_db.mean == Approx(-5));  // keeps its own region
}
