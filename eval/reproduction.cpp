// SPDX-License-Identifier: Apache-2.0
#include "eval/reproduction.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "eval/axes.h"

namespace vecino {
namespace {

constexpr const char* kSceneKey = "scene";

/// Results of a pair are of one scene, and agree in all else that both have, unless a selection of
/// theirs names it. A group's seed is that of its first cell and says nothing.
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

/// What a selection says about renders alone: path tracing reads nothing else.
Selection render_part(Selection selection) {
    for (const std::string_view name : cell_keys()) {
        const std::string key(name);
        if (key == "method" || is_scheme_key(key)) selection = selection.without(key);
    }
    return selection;
}

/// Mean squared errors, or variances, by seed.
std::vector<double> values_of(const GroupSummary& group, Quantity quantity,
                              const RegionName& region) {
    const SeedStatistics* const statistics = group.statistics_of(region);
    if (statistics == nullptr) return {};
    return quantity == Quantity::noise ? statistics->noise_by_seed : statistics->mse;
}

Outcome outcome_of(const Estimate& difference, const ClaimTest& test) {
    const double sign = test.relation == Relation::lower ? -1 : 1;
    double low = sign * *(sign > 0 ? difference.low : difference.high);
    double high = sign * *(sign > 0 ? difference.high : difference.low);
    const double margin = test.margin_db;
    if (test.relation == Relation::same) {
        if (low > margin || high < -margin) return Outcome::fails;
        return low > -margin && high < margin ? Outcome::holds : Outcome::open;
    }
    if (low > margin) return Outcome::holds;
    return high < margin ? Outcome::fails : Outcome::open;
}

struct Place {
    RegionName of, than;
};

PairResult compare_pair(const GroupSummary& of, const GroupSummary& than, const ClaimTest& test,
                        const Place& place) {
    PairResult pair{of.scene, of.group, than.group, Outcome::missing, {}};
    if (of.seeds_done != than.seeds_done) return pair;
    const auto x = values_of(of, test.quantity, place.of);
    const auto y = values_of(than, test.quantity, place.than);
    // A lower error is a higher quality.
    const auto difference = test.quantity == Quantity::quality ? ratio_db(y, x) : ratio_db(x, y);
    if (!difference) return pair;
    pair.difference_db = *difference;
    pair.outcome = outcome_of(*difference, test);
    return pair;
}

class Evaluation {
  public:
    Evaluation(const Reproduction& specification, std::span<const GroupSummary> groups)
        : specification_(specification), groups_(groups) {}

    ClaimResult claim(const Claim& claim, const Variant& variant, const RegionName& region) const {
        ClaimResult result;
        result.variant = variant.id;
        result.region = region;
        for (const ClaimTest& test : claim.tests) run_test(test, variant, claim.any, result);
        if (claim.any) {
            count_scenes(result);
        } else {
            for (const PairResult& pair : result.pairs) count(result, pair.outcome);
        }
        result.verdict = verdict(result);
        return result;
    }

    ItemResult item(const Item& item) const {
        const auto found = select(groups_, item.of, specification_.variants.front());
        const GroupSummary* const slowest = slowest_of(found);
        ItemResult result;
        if (slowest == nullptr) {
            result.remark = "no result";
            return result;
        }
        result.slowest = slowest->group;
        if (item.quantity == ItemQuantity::largest_time_share) {
            share(item, *slowest, result);
        } else {
            time(item, *slowest, result);
        }
        if (result.ours) result.ratio = result.ours->mean / item.published;
        return result;
    }

  private:
    void run_test(const ClaimTest& test, const Variant& variant, bool is_any,
                  ClaimResult& result) const {
        const bool own_regions = !test.of_region.empty();
        const Place place{own_regions ? test.of_region : result.region,
                          own_regions ? test.than_region : result.region};
        const std::size_t before = result.pairs.size();
        for (const GroupSummary* of : select(groups_, test.of, variant)) {
            for (const GroupSummary* than : select(groups_, test.than, variant)) {
                if (!agree(*of, *than, test)) continue;
                result.pairs.push_back(compare_pair(*of, *than, test, place));
            }
        }
        // What the other tests say is not the whole claim, unless any of them is enough.
        if (!is_any && result.pairs.size() == before) ++result.missing;
    }

    static void count(ClaimResult& result, Outcome outcome) {
        switch (outcome) {
            case Outcome::holds:
                ++result.holds;
                break;
            case Outcome::fails:
                ++result.fails;
                break;
            case Outcome::open:
                ++result.open;
                break;
            case Outcome::missing:
                ++result.missing;
        }
    }

    /// One count per scene: the best that any of its pairs reaches.
    static void count_scenes(ClaimResult& result) {
        std::set<std::string> scenes;
        for (const PairResult& pair : result.pairs) scenes.insert(pair.scene);
        for (const std::string& scene : scenes) {
            const auto has = [&](Outcome outcome) {
                return std::ranges::any_of(result.pairs, [&](const PairResult& pair) {
                    return pair.scene == scene && pair.outcome == outcome;
                });
            };
            for (const Outcome outcome :
                 {Outcome::holds, Outcome::missing, Outcome::open, Outcome::fails}) {
                if (!has(outcome)) continue;
                count(result, outcome);
                break;
            }
        }
    }

    static Verdict verdict(const ClaimResult& result) {
        const std::size_t tested = result.holds + result.fails + result.open;
        if (tested == 0 || result.missing > 0) return Verdict::not_testable;
        if (result.holds == tested) return Verdict::reproduced;
        return 2 * result.holds > tested ? Verdict::trend : Verdict::not_reproduced;
    }

    static const GroupSummary* slowest_of(const std::vector<const GroupSummary*>& groups) {
        const auto found = std::ranges::max_element(groups, {}, &GroupSummary::time_s);
        return found == groups.end() || (*found)->seeds == 0 ? nullptr : *found;
    }

    /// The slowest path tracing of the same scenes, rendered alike.
    const GroupSummary* slowest_path(const Item& item) const {
        auto paths = select(groups_, render_part(item.of), specification_.variants.front());
        std::erase_if(paths, [](const GroupSummary* group) { return group->method != "path"; });
        return slowest_of(paths);
    }

    void share(const Item& item, const GroupSummary& slowest, ItemResult& result) const {
        const GroupSummary* const path = slowest_path(item);
        if (path == nullptr || path->seeds_done != slowest.seeds_done) {
            result.remark = "no path tracing of the same seeds";
            return;
        }
        std::vector<double> shares;
        for (std::size_t i = 0; i < path->times_s.size(); ++i)
            shares.push_back(100 * slowest.times_s[i] / path->times_s[i]);
        result.ours = estimate(shares);
        if (!result.ours->low) {
            result.remark = "one seed has no interval";
            return;
        }
        const double off_low = *result.ours->low - item.published;
        const double off_high = *result.ours->high - item.published;
        const bool inside = off_low >= -item.within && off_high <= item.within;
        const bool outside = off_low > item.within || off_high < -item.within;
        result.verdict = inside    ? Verdict::reproduced
                         : outside ? Verdict::not_reproduced
                                   : Verdict::trend;
    }

    void time(const Item& item, const GroupSummary& slowest, ItemResult& result) const {
        result.remark = "times of another machine";
        if (!specification_.times_at.matches(slowest.params)) {
            result.remark = "not run at the published size and samples";
            return;
        }
        const double unit_s = item.unit == "h" ? 3600.0 : 60.0;
        double factor = 1.0 / unit_s;
        if (item.quantity == ItemQuantity::extrapolated_time) {
            factor *= item.spp / slowest.params["spp"].get<double>();
            result.remark = "extrapolated from the measured rate; " + equal_error(item, slowest);
        }
        std::vector<double> times = slowest.times_s;
        for (double& value : times) value *= factor;
        result.ours = estimate(times);
    }

    /// The time in which other variants' path tracing has the error of the extrapolated one: noise
    /// falls as 1 / spp.
    std::string equal_error(const Item& item, const GroupSummary& slowest) const {
        const SeedStatistics* const own = slowest.statistics_of("");
        std::string text;
        for (const Variant& variant : specification_.variants) {
            for (const GroupSummary* other : select(groups_, item.of, variant)) {
                const SeedStatistics* const its = other->statistics_of("");
                if (other->group == slowest.group || other->scene != slowest.scene) continue;
                if (own == nullptr || its == nullptr || !own->noise || !its->noise) continue;
                const double noise = *own->noise * slowest.params["spp"].get<double>() / item.spp;
                char line[160];
                std::snprintf(line, sizeof line, "equal noise takes %.3g min by %s",
                              other->time_s * *its->noise / noise / 60.0, variant.label.c_str());
                if (text.empty()) text = line;
            }
        }
        return text.empty() ? "no other path tracing to compare with" : text;
    }

    const Reproduction& specification_;
    std::span<const GroupSummary> groups_;
};

/// Whether a claim says something of the whole image, which the interior may tell otherwise.
bool has_whole_image_test(const Claim& claim) {
    return std::ranges::any_of(claim.tests,
                               [](const ClaimTest& test) { return test.of_region.empty(); });
}

}  // namespace

std::string verdict_text(Verdict verdict) {
    switch (verdict) {
        case Verdict::reproduced:
            return "reproduced";
        case Verdict::trend:
            return "trend";
        case Verdict::not_reproduced:
            return "not reproduced";
        case Verdict::not_testable:
            break;
    }
    return "not testable";
}

std::vector<const GroupSummary*> select(std::span<const GroupSummary> groups,
                                        const Selection& selection, const Variant& variant) {
    std::vector<const GroupSummary*> selected;
    for (const GroupSummary& group : groups) {
        const bool is_ceiling = group.method == "blocky_ceiling" && !selection.names("method");
        const bool other_budget =
            group.params.value("budget", "same_spp") != "same_spp" && !selection.names("budget");
        if (is_ceiling || other_budget) continue;
        if (selection.matches(group.params, variant.where)) selected.push_back(&group);
    }
    return selected;
}

std::optional<Estimate> ratio_db(std::span<const double> of, std::span<const double> than) {
    const std::size_t n = of.size();
    if (n < 2 || than.size() != n) return std::nullopt;
    double mean_of = 0;
    double mean_than = 0;
    for (std::size_t i = 0; i < n; ++i) {
        mean_of += of[i] / static_cast<double>(n);
        mean_than += than[i] / static_cast<double>(n);
    }
    if (!(mean_of > 0) || !(mean_than > 0)) return std::nullopt;
    constexpr double kDb = 10.0 / 2.302585092994046;
    std::vector<double> deviations_db;  // of log(mean_of / mean_than), to first order, by seed
    for (std::size_t i = 0; i < n; ++i)
        deviations_db.push_back(kDb * (of[i] / mean_of - than[i] / mean_than));
    Estimate result = estimate(deviations_db);
    const double difference = kDb * std::log(mean_of / mean_than);
    result.mean = difference;
    *result.low += difference;
    *result.high += difference;
    return result;
}

ReproductionResult evaluate(const Reproduction& specification,
                            std::span<const GroupSummary> groups) {
    const Evaluation evaluation(specification, groups);
    ReproductionResult result;
    for (const Item& item : specification.items) result.items.push_back(evaluation.item(item));
    for (const Claim& claim : specification.claims) {
        std::vector<ClaimResult>& row = result.claims.emplace_back();
        for (const Variant& variant : specification.variants) {
            row.push_back(evaluation.claim(claim, variant, ""));
            if (has_whole_image_test(claim))
                row.push_back(evaluation.claim(claim, variant, "interior"));
        }
    }
    return result;
}

}  // namespace vecino
