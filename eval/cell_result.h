// SPDX-License-Identifier: Apache-2.0
//
// The result of one cell: its image rebuilt, timed, held against the reference and kept.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "core/error.h"
#include "eval/guide_store.h"
#include "eval/matrix.h"
#include "eval/reference_store.h"
#include "eval/run_directory.h"
#include "eval/stability.h"

namespace vecino {

// A stage that takes longer than this averages its own noise, and is timed once.
constexpr double kRepeatBelow_s = 0.5;

/// What the cells of a frame share.
struct CellInput {
    const Matrix* matrix = nullptr;
    const MethodRender* traced = nullptr;  ///< times are medians; null where no frame is read
    const StoredReference* reference = nullptr;
    GuideStore* guides = nullptr;               ///< null where no frame is read
    const Scene* scene = nullptr;               ///< null where no frame is read
    std::span<const ShiftedView> shifted = {};  ///< as the matrix asks for under "stability"
};

/// Of a cell that fails: status "failed" and a "reason".
nlohmann::json failed_result(const std::string& reason);

/// Of a cell whose image an error prevents: status "refused" where its method does not allow the
/// cell's settings, else "failed", and a "reason".
nlohmann::json error_result(const Cell& cell, const Error& error);

/// Whether an error is the cell's alone. Not so where there is no room to write, from where the run
/// goes on once there is some, or where it is interrupted.
bool is_of_cell(const Error& error);

/// Makes the cell's image, saves it in the run directory and returns "status", "metrics", "time_s"
/// and "counts" of its row, or that of a cell that fails. Throws WriteError where there is no room
/// for the image, Error(interrupted).
nlohmann::json cell_result(const Cell& cell, const CellInput& input, const RunDirectory& directory);

}  // namespace vecino
