// SPDX-License-Identifier: Apache-2.0
//
// Runs a matrix: renders references and low-resolution frames once, rebuilds and compares every
// cell, and keeps each result as soon as it is there. A run that was stopped goes on; finished
// cells are not redone unless their parameters, their scene file or the program changed.
#pragma once

#include <string>

#include "eval/matrix.h"

namespace vecino {

struct RunSummary {
    std::size_t cells = 0;
    std::size_t reused = 0;  ///< finished in an earlier run
    std::size_t failed = 0;
    bool was_interrupted = false;
};

RunSummary run_matrix(const Matrix& matrix, const std::string& directory);

}  // namespace vecino
