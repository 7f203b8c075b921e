// SPDX-License-Identifier: Apache-2.0
//
// Runs a matrix: renders references and low-resolution frames once, rebuilds and compares every
// cell, and keeps each result as soon as it is there. A run that was stopped goes on; finished
// cells are not redone unless their parameters, their scene file or the program changed.
#pragma once

#include <string>
#include <vector>

#include "eval/matrix.h"
#include "eval/run_plan.h"

namespace vecino {

struct RunSummary {
    std::size_t cells = 0;
    std::size_t done = 0;    ///< by this run
    std::size_t kept = 0;    ///< from an earlier run
    std::size_t stale = 0;   ///< of these, by another build or on another state of their scene file
    std::size_t failed = 0;  ///< in this run or before
    std::size_t refused = 0;  ///< beside these, by methods of which a failure's file expects it
    std::size_t missing = 0;  ///< not done yet: interrupted, or not among those asked for
    bool was_interrupted = false;
};

RunSummary run_matrix(const Matrix& matrix, const std::string& directory,
                      const RunOptions& options = {});

/// What run_matrix would do, without touching the directory.
struct RunEstimate {
    std::vector<std::string> cells;
    double samples = 0;  ///< to trace, references included
    double time_s = 0;   ///< from a short measurement of each scene
};

RunEstimate estimate_run(const Matrix& matrix, const std::string& directory,
                         const RunOptions& options = {});

}  // namespace vecino
