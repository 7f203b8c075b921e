// SPDX-License-Identifier: Apache-2.0

/// @file
/// A row of an option table: one name for matrices and one flag for the command line. Help, keys,
/// errors and schemas follow from the tables.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/json_read.h"

namespace vecino {

/// An option that sets a value in Parameters.
template <class Parameters>
struct OptionRow {
    std::string_view name;     ///< key in a matrix
    std::string_view flag;     ///< on the command line
    std::string_view allowed;  ///< for help
    std::string_view summary;  ///< for help: one line
    /// Reads a JSON value into the parameters; throws Error(usage).
    void (*set)(Parameters&, const JsonValue&);
    nlohmann::json (*get)(const Parameters&);  ///< as it stands in results
    std::string (*slug)(const Parameters&);    ///< as it stands in a cell's name
    nlohmann::json (*schema)();                ///< the JSON Schema of what `set` reads
};

}  // namespace vecino
