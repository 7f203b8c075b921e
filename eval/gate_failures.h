// SPDX-License-Identifier: Apache-2.0
//
// The gate on failures: a method that passes where it was expected to fail is as much news as one
// that fails where it was expected to pass.
#pragma once

#include <vector>

#include "eval/gate.h"

namespace vecino {

/// One verdict per group on a failure's scene, and one per cell that is missing, failed or stale;
/// groups of which nothing was expected are not gated. Empty without failures in the matrix.
/// Throws as read_gate_run does.
std::vector<Verdict> judge_failures(const GateRun& run);

/// The verdicts alone, for a run without baseline.
GateResult check_failures(const GateRun& run);

/// Into a check against a baseline, which has told of missing cells.
void add_failures(GateResult& result, const GateRun& run);

}  // namespace vecino
