// SPDX-License-Identifier: Apache-2.0
//
// One pair of results of a claim: whether two belong together, and what their seeds decide.
#pragma once

#include "eval/reproduction.h"

namespace vecino {

/// Where each of a pair is measured; empty: the whole image.
struct Place {
    RegionName of, than;
};

struct Comparing {
    const ClaimTest& test;
    const Place& place;
};

/// Results of a pair are of one scene, and agree in all else that both have, unless a selection of
/// theirs names it. A group's seed is that of its first cell and says nothing.
bool agree(const GroupSummary& a, const GroupSummary& b, const ClaimTest& test);

/// What a group is, apart from what tells a variant's own results from those it is tested at.
nlohmann::json identity(const GroupSummary& group, const Selection& tested_at);

/// Decided by the interval over common seeds; missing without one.
PairResult compare_pair(const GroupSummary& of, const GroupSummary& than, const ClaimTest& test,
                        const Place& place);

/// Adds what the published parameters gave, in however few seeds, and leaves the pair open where
/// that says otherwise than the interval. Either group may be null: then nothing is known.
void hold_against_published(PairResult& pair, const GroupSummary* of, const GroupSummary* than,
                            const Comparing& comparing);

}  // namespace vecino
