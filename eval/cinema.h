// SPDX-License-Identifier: Apache-2.0
//
// A run as a Cinema database, Spec D (Dietrich): a folder NAME.cdb with data.csv, a row per cell,
// that Cinema's viewers and ParaView explore.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/report_data.h"

namespace vecino {

/// The text of data.csv: first the parameters that differ among the rows, then what was measured,
/// then columns FILE, FILE_... with paths relative to the database, which hold the cell's name. All
/// values of a column have one type; what was not measured, or is no parameter of the cell's
/// method, is empty; metrics of a cell that failed are NaN. Names of columns are letters, digits
/// and _ alone, which viewers use as identifiers. Columns without a value are left out. A file
/// stands in its column if it is in the database.
std::string cinema_csv(const std::vector<const nlohmann::json*>& rows, const std::string& database);

/// Makes or completes the database: pictures of the image, its reference and both error maps, with
/// with_vti a .vti file of every cell, and data.csv at last. Pictures are hard links where the disk
/// allows it. Throws Error(file).
void write_cinema(const ReportData& data, const std::vector<const nlohmann::json*>& rows,
                  const std::string& database, bool with_vti);

}  // namespace vecino
