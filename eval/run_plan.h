// SPDX-License-Identifier: Apache-2.0
//
// Which cells of a matrix a run has to do, given the rows that its directory holds.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/matrix.h"

namespace vecino {

enum class CellState {
    missing,   ///< no row, or one of other parameters
    finished,  ///< done by this program on this scene file
    stale,     ///< done, but by another build of the program or on another state of the scene file
    failed,    ///< tried, with a reason
    failed_before,  ///< the same, but by another build or on another state of the scene file
};

enum class Rerun { nothing, failed, stale, all };

struct RunOptions {
    std::string
        only;  ///< regular expression that a cell's name must hold somewhere; empty: every cell
    Rerun rerun = Rerun::nothing;  ///< what is done again beside what is missing
    int simd_width = 0;            ///< samples traced side by side: 4, 8, 16 or 1; 0: the widest
};

struct PlannedCell {
    const Cell* cell = nullptr;
    CellState state = CellState::missing;
    bool run = false;
};

/// Tells the state of a cell. The runner knows what a row must match.
using StateOf = std::function<CellState(const Cell&)>;

/// One entry per cell, in order. Throws Error(usage) if `only` is no regular expression or matches
/// no cell.
std::vector<PlannedCell> plan_run(const std::vector<Cell>& cells, const RunOptions& options,
                                  const StateOf& state_of);

/// Throws Error(usage) unless the text is failed, stale or all; empty is nothing.
Rerun parse_rerun(const std::string& text);

}  // namespace vecino
