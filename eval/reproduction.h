// SPDX-License-Identifier: Apache-2.0
//
// Holds the results of a run against what a publication says: each number and each claim gets a
// verdict, decided by seeds and confidence intervals alone.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/reproduction_spec.h"
#include "eval/statistics.h"
#include "eval/summary.h"

namespace vecino {

enum class ClaimVerdict {
    reproduced,      ///< every comparison holds; a share is within its points, interval and all
    trend,           ///< most comparisons hold; a share's interval overlaps
    not_reproduced,  ///< half of the comparisons or fewer hold; a share lies outside
    not_testable,    ///< results or seeds are missing, or the times are another machine's
};

std::string verdict_text(ClaimVerdict verdict);

enum class PairOutcome {
    holds,    ///< the 95 % interval excludes equality (or the margin)
    fails,    ///< so does it on the other side
    open,     ///< the interval includes equality, or published_db lies on its other side
    missing,  ///< one of both has no value, or not the other's seeds, or too few: below 2 for
              ///< quality, 3 for noise
};

/// One pair of results of a claim.
struct PairResult {
    std::string scene, of, than;  ///< groups
    PairOutcome outcome = PairOutcome::missing;
    Estimate difference_db;  ///< of - than, quality or noise, over common seeds
    /// The same where the variant's own results are others than those that decide (tested_at).
    /// None: they are the same, lack a value, or are too few seeds for it.
    std::optional<double> published_db;
};

struct ClaimResult {
    std::string variant;
    RegionName region;  ///< instead of the whole image; tests that name regions keep theirs
    ClaimVerdict verdict = ClaimVerdict::not_testable;
    /// Pairs; scenes if any one is enough. A test without a pair is missing once.
    std::size_t holds = 0, fails = 0, open = 0, missing = 0;
    std::vector<PairResult> pairs;
};

struct ItemResult {
    ClaimVerdict verdict = ClaimVerdict::not_testable;
    std::optional<Estimate> ours;    ///< in the item's unit
    std::optional<Estimate> tested;  ///< a share where the first variant is tested, if elsewhere
    double ratio = 0;                ///< ours / published; 0 without ours
    std::string slowest;             ///< the group that the number is of
    std::string remark;              ///< why there is no verdict, or what else to know
};

struct ReproductionResult {
    std::vector<ItemResult> items;                 ///< as in the specification
    std::vector<std::vector<ClaimResult>> claims;  ///< per claim: each variant, whole and interior
};

ReproductionResult evaluate(const Reproduction& specification,
                            std::span<const GroupSummary> groups);

/// Groups of a variant that a selection picks, in their order. Ceilings only by name; other budgets
/// than same_spp only where the selection names budgets.
std::vector<const GroupSummary*> select(std::span<const GroupSummary> groups,
                                        const Selection& selection, const Variant& variant);

/// Of - than in dB, with the 95 % interval of the paired ratio of means over common seeds (delta
/// method). None without 2 common seeds or with a mean that is not above 0.
std::optional<Estimate> ratio_db(std::span<const double> of, std::span<const double> than);

/// Id, verdict, numbers and pairs of every item and claim.
nlohmann::json reproduction_json(const Reproduction& specification,
                                 const ReproductionResult& result);

}  // namespace vecino
