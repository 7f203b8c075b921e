// SPDX-License-Identifier: Apache-2.0
#include "eval/reproduction_pairs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "eval/axes.h"

namespace vecino {
namespace {

constexpr const char* kSceneKey = "scene";

/// Mean squared errors, or variances, by seed.
std::vector<double> values_of(const GroupSummary& group, Quantity quantity,
                              const RegionName& region) {
    if (quantity == Quantity::signature) return group.signature_by_seed;
    const SeedStatistics* const statistics = group.statistics_of(region);
    if (statistics == nullptr) return {};
    return quantity == Quantity::noise ? statistics->noise_by_seed : statistics->mse;
}

PairOutcome interval_outcome(const Estimate& difference, const ClaimTest& test) {
    const double sign = test.relation == Relation::lower ? -1 : 1;
    double low = sign * *(sign > 0 ? difference.low : difference.high);
    double high = sign * *(sign > 0 ? difference.high : difference.low);
    const double margin = test.margin_db;
    if (test.relation == Relation::same) {
        if (low > margin || high < -margin) return PairOutcome::fails;
        return low > -margin && high < margin ? PairOutcome::holds : PairOutcome::open;
    }
    if (low > margin) return PairOutcome::holds;
    return high < margin ? PairOutcome::fails : PairOutcome::open;
}

/// What a pair is compared by, by seed: numerator and denominator of what is higher when `of` is.
struct PairValues {
    std::vector<double> above, below;
};

PairValues pair_values(const GroupSummary& of, const GroupSummary& than, const ClaimTest& test,
                       const Place& place) {
    if (of.seeds_done != than.seeds_done) return {};
    auto x = values_of(of, test.quantity, place.of);
    auto y = values_of(than, test.quantity, place.than);
    // A lower error is a higher quality.
    if (test.quantity == Quantity::quality) std::swap(x, y);
    return {std::move(x), std::move(y)};
}

std::optional<double> point_db(const PairValues& values) {
    if (values.above.empty() || values.above.size() != values.below.size()) return std::nullopt;
    const double above = estimate(values.above).mean;
    const double below = estimate(values.below).mean;
    if (!(above > 0) || !(below > 0)) return std::nullopt;
    return 10.0 * std::log10(above / below);
}

}  // namespace

bool agree(const GroupSummary& a, const GroupSummary& b, const ClaimTest& test) {
    return std::ranges::all_of(cell_keys(), [&](const std::string_view name) {
        const std::string key(name);
        const bool is_free = key != kSceneKey && (test.of.names(key) || test.than.names(key));
        if (is_free || key == "seed") return true;
        const auto x = selected_value(a.params, key);
        const auto y = selected_value(b.params, key);
        return x.is_null() || y.is_null() || x == y;
    });
}

nlohmann::json identity(const GroupSummary& group, const Selection& tested_at) {
    nlohmann::json json = nlohmann::json::array();
    for (const std::string_view name : cell_keys()) {
        const std::string key(name);
        const bool differs = key == "seed" || tested_at.names(key);
        json.push_back(differs ? nlohmann::json() : selected_value(group.params, key));
    }
    json.push_back(group.params.value("method", ""));
    return json;
}

PairResult compare_pair(const GroupSummary& of, const GroupSummary& than, const ClaimTest& test,
                        const Place& place) {
    PairResult pair{of.scene, of.group, than.group, PairOutcome::missing, {}, {}};
    const PairValues values = pair_values(of, than, test, place);
    const auto difference = ratio_db(values.above, values.below);
    if (!difference) return pair;
    pair.difference_db = *difference;
    pair.outcome = interval_outcome(*difference, test);
    return pair;
}

void hold_against_published(PairResult& pair, const GroupSummary* of, const GroupSummary* than,
                            const Comparing& comparing) {
    if (pair.outcome == PairOutcome::missing || of == nullptr || than == nullptr) return;
    pair.published_db = point_db(pair_values(*of, *than, comparing.test, comparing.place));
    if (!pair.published_db) return;
    const Estimate point{*pair.published_db, *pair.published_db, *pair.published_db};
    if (interval_outcome(point, comparing.test) != pair.outcome) pair.outcome = PairOutcome::open;
}

}  // namespace vecino
