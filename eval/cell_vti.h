// SPDX-License-Identifier: Apache-2.0
//
// Cells of a run as .vti files.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/report_data.h"

namespace vecino {

/// Rows of the cells whose names a pattern matches (see NamePattern), in the order of the run.
/// Throws Error(usage) where it matches none.
std::vector<const nlohmann::json*> selected_rows(const ReportData& data, const std::string& only);

/// Whether a cell's image and its reference are there.
bool has_images(const ReportData& data, const nlohmann::json& row);

/// Writes save_comparison_vti() of every cell that has its images to the path that is given for it.
/// Throws Error(file), Error(mismatch).
void write_cell_vtis(const ReportData& data, const std::vector<const nlohmann::json*>& rows,
                     const std::function<std::string(const std::string& cell)>& path_of);

}  // namespace vecino
