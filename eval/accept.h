// SPDX-License-Identifier: Apache-2.0
//
// A new baseline from a run, beside the old one.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/baseline.h"
#include "eval/gate_run.h"

namespace vecino {

struct AcceptPlan {
    Baseline baseline;              ///< what to write
    std::string table;              ///< old against new, changed lines marked
    std::size_t changed = 0;        ///< groups that differ, are new or gone
    std::vector<CellFault> faults;  ///< why it must not be written; empty: it may
};

/// `only` is a regular expression that a group's name must hold somewhere; of other groups the old
/// numbers stay. Throws Error(usage) if it is none or matches no group, or if the old baseline is
/// of another matrix.
AcceptPlan plan_accept(const GateRun& run, const std::optional<Baseline>& old,
                       const std::string& only);

}  // namespace vecino
