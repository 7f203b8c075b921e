// SPDX-License-Identifier: Apache-2.0
//
// Verdicts on claims, from results whose differences are known.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tests/catch.h"
#include "tests/group_summaries.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;

Json better_than_path(const std::string& relation = "higher", double margin_db = 0) {
    return {{"quantity", "quality"},
            {"of", {{"method", "mean"}}},
            {"is", relation},
            {"than", {{"method", "path"}}},
            {"margin_db", margin_db}};
}

/// A scene where mean is better than path tracing by so much.
void add_scene(Groups& groups, const std::string& name, const std::vector<double>& mean_errors) {
    groups.push_back(group_of("path", {{"scene", name + ".json"}}, errors_db(0)));
    groups.push_back(group_of("mean", {{"scene", name + ".json"}}, mean_errors));
}

Groups one_scene(const std::vector<double>& mean_errors) {
    Groups groups;
    add_scene(groups, "box", mean_errors);
    return groups;
}

PairOutcome only_outcome(const Json& test, const Groups& groups) {
    const ClaimResult result = judge(claim_json(test), groups);
    REQUIRE(result.pairs.size() == 1);
    return result.pairs[0].outcome;
}

/// Whole numbers of the generator alone, so that every library draws the same.
class Gauss {
  public:
    double operator()() {
        const double radius = std::sqrt(-2 * std::log(unit()));
        return radius * std::cos(2 * std::acos(-1.0) * unit());
    }

  private:
    double unit() { return (static_cast<double>(engine_()) + 0.5) * 0x1p-32; }
    std::mt19937 engine_{5};
};

}  // namespace

TEST_CASE("a claim is reproduced if every pair holds, a trend if most do, and not at half",
          "[reproduction]") {
    struct Case {
        std::size_t holds, unsure, fails;
        ClaimVerdict verdict;
    };
    const Case c = GENERATE(values<Case>({{4, 0, 0, ClaimVerdict::reproduced},
                                          {3, 1, 0, ClaimVerdict::trend},
                                          {3, 0, 1, ClaimVerdict::trend},
                                          {2, 1, 0, ClaimVerdict::trend},
                                          {2, 2, 0, ClaimVerdict::not_reproduced},
                                          {2, 0, 2, ClaimVerdict::not_reproduced},
                                          {2, 1, 1, ClaimVerdict::not_reproduced},
                                          {1, 0, 2, ClaimVerdict::not_reproduced},
                                          {0, 4, 0, ClaimVerdict::not_reproduced},
                                          {0, 0, 4, ClaimVerdict::not_reproduced}}));
    Groups groups;
    for (std::size_t i = 0; i < c.holds; ++i)
        add_scene(groups, "a" + std::to_string(i), errors_db(-2));
    for (std::size_t i = 0; i < c.unsure; ++i)
        add_scene(groups, "b" + std::to_string(i), unsure_errors_db(-2));
    for (std::size_t i = 0; i < c.fails; ++i)
        add_scene(groups, "c" + std::to_string(i), errors_db(2));
    const ClaimResult result = judge(claim_json(better_than_path()), groups);
    CHECK(result.verdict == c.verdict);
    CHECK(result.holds == c.holds);
    CHECK(result.open == c.unsure);
    CHECK(result.fails == c.fails);
    CHECK(result.missing == 0);
    CHECK(result.pairs.size() == c.holds + c.unsure + c.fails);
}

TEST_CASE("a difference has to lie beyond the margin, in the direction of the relation",
          "[reproduction]") {
    struct Case {
        const char* relation;
        double margin, difference_db;
        PairOutcome outcome;
    };
    const Case c = GENERATE(values<Case>({{"higher", 0, 0.01, PairOutcome::holds},
                                          {"higher", 0, -0.01, PairOutcome::fails},
                                          {"higher", 1, 1.01, PairOutcome::holds},
                                          {"higher", 1, 0.99, PairOutcome::fails},
                                          {"higher", 1, -1.01, PairOutcome::fails},
                                          {"lower", 0, -0.01, PairOutcome::holds},
                                          {"lower", 0, 0.01, PairOutcome::fails},
                                          {"lower", 1, -1.01, PairOutcome::holds},
                                          {"lower", 1, -0.99, PairOutcome::fails},
                                          {"lower", 1, 1.01, PairOutcome::fails},
                                          {"same", 1, 0.99, PairOutcome::holds},
                                          {"same", 1, -0.99, PairOutcome::holds},
                                          {"same", 1, 1.01, PairOutcome::fails},
                                          {"same", 1, -1.01, PairOutcome::fails}}));
    CAPTURE(c.relation, c.margin, c.difference_db);
    // A lower error is a higher quality.
    const Groups groups = one_scene(errors_db(-c.difference_db));
    const Json test = better_than_path(c.relation, c.margin);
    const ClaimResult result = judge(claim_json(test), groups);
    REQUIRE(result.pairs.size() == 1);
    CHECK(result.pairs[0].outcome == c.outcome);
    CHECK(result.pairs[0].difference_db.mean == Approx(c.difference_db));
    // Noise is the variance itself.
    Json noise = test;
    noise["quantity"] = "noise";
    CHECK(only_outcome(noise, one_scene(errors_db(c.difference_db))) == c.outcome);
}

TEST_CASE("an interval that reaches over the margin leaves a pair open", "[reproduction]") {
    // The interval is 3.19 dB to each side of the difference.
    struct Case {
        const char* relation;
        double margin, difference_db;
        PairOutcome outcome;
    };
    const Case c = GENERATE(values<Case>({{"higher", 0, 3.1, PairOutcome::open},
                                          {"higher", 0, 3.3, PairOutcome::holds},
                                          {"higher", 0, -3.1, PairOutcome::open},
                                          {"higher", 0, -3.3, PairOutcome::fails},
                                          {"higher", 2, 5.1, PairOutcome::open},
                                          {"higher", 2, 5.3, PairOutcome::holds},
                                          {"lower", 2, -5.1, PairOutcome::open},
                                          {"lower", 2, -5.3, PairOutcome::holds},
                                          {"lower", 2, 1.1, PairOutcome::open},
                                          {"lower", 2, 1.3, PairOutcome::fails},
                                          {"same", 4, 0.7, PairOutcome::holds},
                                          {"same", 4, -0.7, PairOutcome::holds},
                                          {"same", 4, 0.9, PairOutcome::open},
                                          {"same", 4, -0.9, PairOutcome::open},
                                          {"same", 4, 7.1, PairOutcome::open},
                                          {"same", 4, 7.3, PairOutcome::fails},
                                          {"same", 4, -7.3, PairOutcome::fails}}));
    CAPTURE(c.relation, c.margin, c.difference_db);
    const Groups groups = one_scene(unsure_errors_db(-c.difference_db));
    CHECK(only_outcome(better_than_path(c.relation, c.margin), groups) == c.outcome);
}

TEST_CASE("results that are equal are neither higher nor lower", "[reproduction]") {
    const std::string relation = GENERATE(values<std::string>({"higher", "lower"}));
    CHECK(only_outcome(better_than_path(relation), one_scene(errors_db(0))) == PairOutcome::open);
}

TEST_CASE("one pair without a value makes a claim untestable", "[reproduction]") {
    Groups groups = one_scene(errors_db(-2));
    add_scene(groups, "hall", errors_db(-2));
    REQUIRE(judge(claim_json(better_than_path()), groups).verdict == ClaimVerdict::reproduced);
    GroupSummary& mean = groups.back();
    SECTION("its group has failed cells, and no statistics") {
        mean.statistics.reset();
    }
    SECTION("it lacks a seed") {
        mean = group_of("mean", {{"scene", "hall.json"}}, {1e-3, 2e-3, 3e-3});
    }
    SECTION("it has other seeds") {
        mean.seeds_done = {1, 2, 3, 5};
    }
    SECTION("there is one seed") {
        mean = group_of("mean", {{"scene", "hall.json"}}, {1e-4});
        groups[2] = group_of("path", {{"scene", "hall.json"}}, {1e-3});
    }
    SECTION("it has no error, whose ratio means nothing") {
        mean.statistics->whole = statistics_of({0, 0, 0, 0});
    }
    const ClaimResult result = judge(claim_json(better_than_path()), groups);
    CHECK(result.verdict == ClaimVerdict::not_testable);
    CHECK(result.holds == 1);
    CHECK(result.missing == 1);
    CHECK(result.pairs[1].outcome == PairOutcome::missing);
}

TEST_CASE("noise of fewer than 3 seeds is missing, their quality is not", "[reproduction]") {
    Groups groups{group_of("path", Json::object(), {1e-3, 2e-3}),
                  group_of("mean", Json::object(), {1e-4, 2e-4})};
    for (GroupSummary& group : groups) group.statistics->whole.noise_by_seed.clear();
    CHECK(only_outcome(better_than_path(), groups) == PairOutcome::holds);
    Json noise = better_than_path("lower");
    noise["quantity"] = "noise";
    CHECK(only_outcome(noise, groups) == PairOutcome::missing);
}

TEST_CASE("a claim without results is not testable", "[reproduction]") {
    CHECK(judge(claim_json(better_than_path()), {}).verdict == ClaimVerdict::not_testable);
    CHECK(judge(claim_json(better_than_path(), true), {}).verdict == ClaimVerdict::not_testable);
}

TEST_CASE("every test of a claim needs results, unless any one is enough", "[reproduction]") {
    Json other = better_than_path();
    other["of"] = {{"method", "distance2d"}};
    const Json tests = {better_than_path(), other};
    const Groups groups = one_scene(errors_db(-2));
    const ClaimResult all = judge(claim_json(tests), groups);
    CHECK(all.verdict == ClaimVerdict::not_testable);
    CHECK(all.holds == 1);
    CHECK(all.missing == 1);
    CHECK(judge(claim_json(tests, true), groups).verdict == ClaimVerdict::reproduced);
}

TEST_CASE("where any pair is enough, scenes are counted by the best of theirs", "[reproduction]") {
    const auto scheme = [](const std::string& scene, int window, const std::vector<double>& mse) {
        return group_of("mean", {{"scene", scene}, {"window", window}}, mse);
    };
    const auto path = [](const std::string& scene) {
        return group_of("path", {{"scene", scene}}, errors_db(0));
    };
    Groups groups{path("a.json"), scheme("a.json", 3, errors_db(5)),
                  scheme("a.json", 5, errors_db(-1)), path("b.json"),
                  scheme("b.json", 3, errors_db(-1))};
    groups.push_back(scheme("a.json", 7, {}));
    groups.back().statistics.reset();
    const Json claim = claim_json(better_than_path(), true);
    const ClaimResult both = judge(claim, groups);
    CHECK(both.verdict == ClaimVerdict::reproduced);
    CHECK(both.holds == 2);
    CHECK(both.missing == 0);
    CHECK(both.pairs.size() == 4);

    groups[4] = scheme("b.json", 3, errors_db(1));
    const ClaimResult half = judge(claim, groups);
    CHECK(half.verdict == ClaimVerdict::not_reproduced);
    CHECK(half.holds == 1);
    CHECK(half.fails == 1);

    groups[4] = scheme("b.json", 3, unsure_errors_db(0));
    CHECK(judge(claim, groups).open == 1);

    // What was not measured may have held.
    groups.push_back(scheme("b.json", 5, {}));
    groups.back().statistics.reset();
    CHECK(judge(claim, groups).verdict == ClaimVerdict::not_testable);
}

TEST_CASE("a ratio in decibels has the interval that was worked out by hand", "[reproduction]") {
    const std::vector<double> of{1, 2, 3, 4};
    const std::vector<double> than{2, 1, 4, 3};
    // By seed 4.342945 * (of - than) / 2.5 = -1.737178, 1.737178, -1.737178, 1.737178: the standard
    // error of their mean is 1.737178 * sqrt(4 / 3) / 2 = 1.002960.
    const auto equal = ratio_db(of, than);
    REQUIRE(equal);
    CHECK(equal->mean == Approx(0).margin(1e-12));
    CHECK(*equal->low == Approx(-3.182 * 1.002960).epsilon(1e-5));
    CHECK(*equal->high == Approx(3.182 * 1.002960).epsilon(1e-5));
    // 4.342945 * (2/3 - 1, 4/3 - 1) = -1.447648, 1.447648, which is its standard error too.
    const auto three = ratio_db(std::vector<double>{2, 4}, std::vector<double>{1, 1});
    REQUIRE(three);
    CHECK(three->mean == Approx(4.771213));
    CHECK(*three->low == Approx(4.771213 - 12.706 * 1.447648).epsilon(1e-5));
    CHECK(*three->high == Approx(4.771213 + 12.706 * 1.447648).epsilon(1e-5));
}

TEST_CASE("a ratio in decibels changes its sign with its order, and not with a unit",
          "[reproduction]") {
    const std::vector<double> of{1.0, 2.5, 3.0, 4.5};
    const std::vector<double> than{0.5, 1.0, 0.75, 1.5};
    const Estimate there = ratio_db(of, than).value();
    const Estimate back = ratio_db(than, of).value();
    CHECK(there.mean > 0);
    CHECK(back.mean == Approx(-there.mean));
    CHECK(*back.low == Approx(-*there.high));
    CHECK(*back.high == Approx(-*there.low));
    std::vector<double> small_of, small_than;
    for (const double value : of) small_of.push_back(1e-9 * value);
    for (const double value : than) small_than.push_back(1e-9 * value);
    const Estimate scaled = ratio_db(small_of, small_than).value();
    CHECK(scaled.mean == Approx(there.mean));
    CHECK(*scaled.low == Approx(*there.low));
    CHECK(*scaled.high == Approx(*there.high));
}

TEST_CASE("there is no ratio without two common seeds, or of nothing", "[reproduction]") {
    const std::vector<double> two{1, 2};
    CHECK(ratio_db(two, two));
    CHECK_FALSE(ratio_db(std::vector<double>{1}, std::vector<double>{1}));
    CHECK_FALSE(ratio_db(std::vector<double>{}, std::vector<double>{}));
    CHECK_FALSE(ratio_db(two, std::vector<double>{1, 2, 3}));
    CHECK_FALSE(ratio_db(two, std::vector<double>{0, 0}));
    CHECK_FALSE(ratio_db(std::vector<double>{-1, 0.5}, two));
    CHECK_FALSE(ratio_db(two, std::vector<double>{1, std::nan("")}));
}

TEST_CASE("the interval of a ratio of 4 seeds holds the true one as often as it says",
          "[reproduction]") {
    const double shared = GENERATE(0.0, 0.3);  // what seeds have in common cancels
    Gauss gauss;
    constexpr int kTrials = 2000;
    int covered = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
        std::vector<double> of, than;
        for (int seed = 0; seed < 4; ++seed) {
            const double common = shared * gauss();
            of.push_back(2.0 * (1 + common / 3 + 0.1 * gauss()));
            than.push_back(1.0 * (1 + common / 3 + 0.1 * gauss()));
        }
        const Estimate ratio = ratio_db(of, than).value();
        const double truth = 10 * std::log10(2.0);
        covered += *ratio.low <= truth && truth <= *ratio.high ? 1 : 0;
    }
    CHECK(covered >= 0.92 * kTrials);
    CHECK(covered <= 0.98 * kTrials);
}
