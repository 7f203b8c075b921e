// SPDX-License-Identifier: Apache-2.0
#include "eval/run_plan.h"

#include <algorithm>
#include <regex>

#include "core/error.h"

namespace vecino {
namespace {

std::regex compile(const std::string& only) {
    try {
        return std::regex(only);
    } catch (const std::regex_error&) {
        throw Error(ExitCode::usage, "command line: --only: found \"" + only +
                                         "\", allowed: an ECMAScript regular expression");
    }
}

bool runs(CellState state, Rerun rerun) {
    switch (rerun) {
        case Rerun::all:
            return true;
        case Rerun::failed:
            return state == CellState::missing || state == CellState::failed;
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
    const std::regex pattern = compile(options.only);
    std::vector<PlannedCell> plan;
    bool any = false;
    for (const Cell& cell : cells) {
        const bool chosen = std::regex_search(cell.name, pattern);
        const CellState state = state_of(cell);
        plan.push_back({&cell, state, chosen && runs(state, options.rerun)});
        any = any || chosen;
    }
    if (!any) {
        throw Error(ExitCode::usage,
                    "command line: --only: found \"" + options.only +
                        "\", allowed: an expression that matches a cell (see vecino list cells)");
    }
    return plan;
}

}  // namespace vecino
