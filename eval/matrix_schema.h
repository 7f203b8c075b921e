// SPDX-License-Identifier: Apache-2.0
//
// The JSON Schema of matrix files, from the tables of schemes and of the options of renders and
// schemes. A new key is a row; tests hold the rows against what the reader allows.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace vecino {

nlohmann::json matrix_schema();

/// Of the part "reproduction". Refers to the rest of the matrix's schema.
nlohmann::json reproduction_schema();

/// The part of it that "gates" takes.
nlohmann::json gates_schema();

/// Keys of cells with one value or several, and of results, without references to a matrix's
/// schema.
nlohmann::json free_axes_schema();
nlohmann::json free_selection_schema();

}  // namespace vecino
