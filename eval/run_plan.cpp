// SPDX-License-Identifier: Apache-2.0
#include "eval/run_plan.h"

#include <algorithm>

#include "core/error.h"
#include "eval/name_pattern.h"

namespace vecino {
namespace {

bool runs(CellState state, Rerun rerun) {
    switch (rerun) {
        case Rerun::all:
            return true;
        case Rerun::failed:
            return state != CellState::finished && state != CellState::stale;
        case Rerun::stale:
            return state != CellState::finished && state != CellState::failed;
        case Rerun::nothing:
            break;
    }
    return state == CellState::missing;
}

}  // namespace

Rerun parse_rerun(const std::string& text) {
    if (text.empty()) return Rerun::nothing;
    if (text == "failed") return Rerun::failed;
    if (text == "stale") return Rerun::stale;
    if (text == "all") return Rerun::all;
    throw Error(ExitCode::usage,
                "command line: --rerun: found \"" + text + "\", allowed: failed, stale, all");
}

std::vector<PlannedCell> plan_run(const std::vector<Cell>& cells, const RunOptions& options,
                                  const StateOf& state_of) {
    const NamePattern pattern(options.only);
    std::vector<PlannedCell> plan;
    bool any = false;
    for (const Cell& cell : cells) {
        const bool chosen = pattern.matches(cell.name);
        const CellState state = state_of(cell);
        plan.push_back({&cell, state, chosen && runs(state, options.rerun)});
        any = any || chosen;
    }
    if (!any) pattern.fail_without_match();
    return plan;
}

}  // namespace vecino
