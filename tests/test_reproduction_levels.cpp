// SPDX-License-Identifier: Apache-2.0
//
// Variants that are published at one number of samples, with one seed, and tested at another, with
// several.
#include <string>
#include <vector>

#include "core/error.h"
#include "tests/catch.h"
#include "tests/group_summaries.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;

const Json kFew = {{"spp", 10}, {"spp_asked", 10}};
const Json kMany = {{"spp", 100}, {"spp_asked", 100}};

Json variants() {
    return {{"variants",
             {{{"id", "printed"},
               {"label", "as printed"},
               {"where", {{"spp", 100}}},
               {"tested_at", {{"spp", 10}}}}}}};
}

Json better(const char* relation = "higher", double margin_db = 0) {
    return claim_json({{"quantity", "quality"},
                       {"of", {{"method", "mean"}}},
                       {"is", relation},
                       {"than", {{"method", "path"}}},
                       {"margin_db", margin_db}});
}

ClaimResult judged(const Json& claim, const Groups& groups) {
    return judge_all(claim, groups, variants()).at(0);
}

/// The mean is 3 dB better where it is tested, and by as much as given where it was published.
Groups groups_with(const std::vector<double>& published_mean) {
    return {group_of("path", kMany, {1e-3}), group_of("mean", kMany, published_mean),
            group_of("path", kFew, errors_db(0)), group_of("mean", kFew, errors_db(-3))};
}

ItemResult share(const std::vector<double>& published_s, const std::vector<double>& tested_s) {
    Json parts = variants();
    parts["items"] = {{{"id", "i"},
                       {"section", "1"},
                       {"text", "a share"},
                       {"published", 25},
                       {"unit", "%"},
                       {"quantity", "largest_time_share"},
                       {"of", {{"method", "mean"}}},
                       {"within", 5}}};
    const Groups groups{timed_group("path", kMany, {100}), timed_group("mean", kMany, published_s),
                        timed_group("path", kFew, {10, 10, 10, 10}),
                        timed_group("mean", kFew, tested_s)};
    return evaluate(read_parts(parts), groups).items.at(0);
}

}  // namespace

TEST_CASE("seeds of fewer samples decide a claim, with the published ones beside",
          "[reproduction]") {
    const ClaimResult result = judged(better(), groups_with({5e-4}));
    CHECK(result.verdict == ClaimVerdict::reproduced);
    REQUIRE(result.pairs.size() == 1);
    const PairResult& pair = result.pairs[0];
    CHECK(pair.of.find("10") != std::string::npos);
    CHECK(pair.difference_db.mean == Approx(3.0));
    CHECK(pair.difference_db.low);
    CHECK(pair.published_db.value() == Approx(3.0103).epsilon(1e-4));
}

TEST_CASE("published samples that say the opposite leave a comparison open", "[reproduction]") {
    const ClaimResult higher = judged(better(), groups_with({2e-3}));
    CHECK(higher.open == 1);
    CHECK(higher.holds + higher.fails + higher.missing == 0);
    CHECK(higher.verdict == ClaimVerdict::not_reproduced);
    const ClaimResult lower = judged(better("lower"), groups_with({2e-3}));
    CHECK(lower.open == 1);
    CHECK(lower.fails == 0);
    // Less than the margin, on the published side alone.
    CHECK(judged(better("higher", 2), groups_with({5e-4})).holds == 1);
    CHECK(judged(better("higher", 2), groups_with({9e-4})).open == 1);
    CHECK(judged(better("same", 4), groups_with({5e-4})).holds == 1);
    CHECK(judged(better("same", 4), groups_with({1e-4})).open == 1);
}

TEST_CASE("one published seed alone decides nothing", "[reproduction]") {
    Groups groups = groups_with({5e-4});
    groups.resize(2);
    const ClaimResult result = judged(better(), groups);
    CHECK(result.verdict == ClaimVerdict::not_testable);
    CHECK(result.missing == 1);
}

TEST_CASE("without published results the seeds decide alone", "[reproduction]") {
    Groups groups = groups_with({5e-4});
    groups.erase(groups.begin() + 1);
    const ClaimResult result = judged(better(), groups);
    CHECK(result.verdict == ClaimVerdict::reproduced);
    CHECK_FALSE(result.pairs.at(0).published_db);
}

TEST_CASE("one seed has no noise to be held against", "[reproduction]") {
    Groups groups = groups_with({5e-4});
    for (GroupSummary& group : groups)
        if (group.seeds == 1) group.statistics->whole.noise_by_seed.clear();
    const Json claim = claim_json({{"quantity", "noise"},
                                   {"of", {{"method", "mean"}}},
                                   {"is", "lower"},
                                   {"than", {{"method", "path"}}}});
    const ClaimResult result = judged(claim, groups);
    CHECK(result.verdict == ClaimVerdict::reproduced);
    CHECK_FALSE(result.pairs.at(0).published_db);
}

TEST_CASE("a share needs the interval of its seeds and the published samples within its points",
          "[reproduction]") {
    const ItemResult good = share({26}, {2.4, 2.5, 2.6, 2.5});
    CHECK(good.verdict == ClaimVerdict::reproduced);
    CHECK(good.ours.value().mean == Approx(26));
    CHECK_FALSE(good.ours->low);
    CHECK(good.tested.value().mean == Approx(25));
    CHECK(good.tested->low);
    CHECK(share({40}, {2.4, 2.5, 2.6, 2.5}).verdict == ClaimVerdict::trend);
    CHECK(share({26}, {6.4, 6.5, 6.6, 6.5}).verdict == ClaimVerdict::trend);
    CHECK(share({40}, {6.4, 6.5, 6.6, 6.5}).verdict == ClaimVerdict::not_reproduced);
    const ItemResult single = share({26}, {2.5});
    CHECK(single.verdict == ClaimVerdict::not_testable);
    CHECK_FALSE(single.remark.empty());
}

TEST_CASE("what a variant is tested at is read as a selection", "[reproduction_spec]") {
    const Variant variant = read_parts(variants()).variants.at(0);
    CHECK(variant.tested_at.text() == "spp 10");
    CHECK(variant.tested().where.text() == "spp 10");
    CHECK(variant.where.text() == "spp 100");
    Json wrong = variants();
    wrong["variants"][0]["tested_at"] = {{"spp", "many"}};
    CHECK_THROWS_AS(read_parts(wrong), Error);
}
