// SPDX-License-Identifier: Apache-2.0
#include "eval/reproduction.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "eval/axes.h"
#include "eval/reproduction_pairs.h"

namespace vecino {
namespace {

/// What a selection says about renders alone: path tracing reads nothing else.
Selection render_part(Selection selection) {
    for (const std::string_view name : cell_keys()) {
        const std::string key(name);
        if (key == "method" || is_scheme_key(key)) selection = selection.without(key);
    }
    return selection;
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
            share(item, result);
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
        const Variant tested = variant.tested();
        for (const GroupSummary* of : select(groups_, test.of, tested)) {
            for (const GroupSummary* than : select(groups_, test.than, tested)) {
                if (!agree(*of, *than, test)) continue;
                PairResult pair = compare_pair(*of, *than, test, place);
                if (!variant.tested_at.empty()) {
                    hold_against_published(pair, published(*of, test.of, variant),
                                           published(*than, test.than, variant), {test, place});
                }
                result.pairs.push_back(std::move(pair));
            }
        }
        // What the other tests say is not the whole claim, unless any of them is enough.
        if (!is_any && result.pairs.size() == before) ++result.missing;
    }

    /// The variant's own group for one that it is tested at; null where there is none.
    const GroupSummary* published(const GroupSummary& tested, const Selection& selection,
                                  const Variant& variant) const {
        const nlohmann::json wanted = identity(tested, variant.tested_at);
        for (const GroupSummary* group : select(groups_, selection, variant)) {
            if (identity(*group, variant.tested_at) == wanted) return group;
        }
        return nullptr;
    }

    static void count(ClaimResult& result, PairOutcome outcome) {
        switch (outcome) {
            case PairOutcome::holds:
                ++result.holds;
                break;
            case PairOutcome::fails:
                ++result.fails;
                break;
            case PairOutcome::open:
                ++result.open;
                break;
            case PairOutcome::missing:
                ++result.missing;
        }
    }

    /// One count per scene: the best that any of its pairs reaches.
    static void count_scenes(ClaimResult& result) {
        std::set<std::string> scenes;
        for (const PairResult& pair : result.pairs) scenes.insert(pair.scene);
        for (const std::string& scene : scenes) {
            const auto has = [&](PairOutcome outcome) {
                return std::ranges::any_of(result.pairs, [&](const PairResult& pair) {
                    return pair.scene == scene && pair.outcome == outcome;
                });
            };
            for (const PairOutcome outcome : {PairOutcome::holds, PairOutcome::missing,
                                              PairOutcome::open, PairOutcome::fails}) {
                if (!has(outcome)) continue;
                count(result, outcome);
                break;
            }
        }
    }

    static ClaimVerdict verdict(const ClaimResult& result) {
        const std::size_t tested = result.holds + result.fails + result.open;
        if (tested == 0 || result.missing > 0) return ClaimVerdict::not_testable;
        if (result.holds == tested) return ClaimVerdict::reproduced;
        return 2 * result.holds > tested ? ClaimVerdict::trend : ClaimVerdict::not_reproduced;
    }

    static const GroupSummary* slowest_of(const std::vector<const GroupSummary*>& groups) {
        const auto found = std::ranges::max_element(groups, {}, &GroupSummary::time_s);
        return found == groups.end() || (*found)->seeds == 0 ? nullptr : *found;
    }

    /// The slowest path tracing of the same scenes, rendered alike.
    const GroupSummary* slowest_path(const Item& item, const Variant& variant) const {
        auto paths = select(groups_, render_part(item.of), variant);
        std::erase_if(paths, [](const GroupSummary* group) { return group->method != "path"; });
        return slowest_of(paths);
    }

    /// In per cent, over seeds; none where one of both is missing or not of the other's seeds.
    std::optional<Estimate> share_of(const Item& item, const Variant& variant) const {
        const GroupSummary* const slowest = slowest_of(select(groups_, item.of, variant));
        const GroupSummary* const path = slowest_path(item, variant);
        if (slowest == nullptr || path == nullptr || path->seeds_done != slowest->seeds_done)
            return std::nullopt;
        std::vector<double> shares;
        for (std::size_t i = 0; i < path->times_s.size(); ++i)
            shares.push_back(100 * slowest->times_s[i] / path->times_s[i]);
        return estimate(shares);
    }

    void share(const Item& item, ItemResult& result) const {
        const Variant& variant = specification_.variants.front();
        result.ours = share_of(item, variant);
        if (!variant.tested_at.empty()) result.tested = share_of(item, variant.tested());
        const auto& decisive = variant.tested_at.empty() ? result.ours : result.tested;
        if (!result.ours || !decisive) {
            result.remark = "no path tracing of the same seeds";
            return;
        }
        if (!decisive->low) {
            result.remark = "one seed has no interval";
            return;
        }
        // What the published parameters gave, in however few seeds, has to agree.
        const auto is_within = [&](double share) {
            return std::abs(share - item.published) <= item.within;
        };
        const bool inside = is_within(*decisive->low) && is_within(*decisive->high);
        const bool outside = *decisive->low > item.published + item.within ||
                             *decisive->high < item.published - item.within;
        const bool published_inside = is_within(result.ours->mean);
        result.verdict = inside && published_inside     ? ClaimVerdict::reproduced
                         : outside && !published_inside ? ClaimVerdict::not_reproduced
                                                        : ClaimVerdict::trend;
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
        const GroupSummary* const measured = noise_measured(item, slowest);
        std::string text;
        for (const Variant& variant : specification_.variants) {
            for (const GroupSummary* other : select(groups_, item.of, variant.tested())) {
                const SeedStatistics* const its = other->statistics_of("");
                if (measured == nullptr || other == measured || other->scene != slowest.scene)
                    continue;
                if (its == nullptr || !its->noise) continue;
                const double noise = *measured->statistics_of("")->noise *
                                     measured->params["spp"].get<double>() / item.spp;
                char line[160];
                std::snprintf(line, sizeof line, "equal noise takes %.3g min by %s",
                              other->time_s * *its->noise / noise / 60.0, variant.label.c_str());
                if (text.empty()) text = line;
            }
        }
        return text.empty() ? "no other path tracing to compare with" : text;
    }

    /// The same path tracing where the first variant is tested: one seed alone shows no noise.
    const GroupSummary* noise_measured(const Item& item, const GroupSummary& slowest) const {
        const Variant& variant = specification_.variants.front();
        const nlohmann::json wanted = identity(slowest, variant.tested_at);
        for (const GroupSummary* group : select(groups_, item.of, variant.tested())) {
            const SeedStatistics* const own = group->statistics_of("");
            if (own != nullptr && own->noise && identity(*group, variant.tested_at) == wanted)
                return group;
        }
        return nullptr;
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

std::string verdict_text(ClaimVerdict verdict) {
    switch (verdict) {
        case ClaimVerdict::reproduced:
            return "reproduced";
        case ClaimVerdict::trend:
            return "trend";
        case ClaimVerdict::not_reproduced:
            return "not reproduced";
        case ClaimVerdict::not_testable:
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
