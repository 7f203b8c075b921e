// SPDX-License-Identifier: Apache-2.0
//
// Comma-separated values, as RFC 4180 has them but with lines that end in \n.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace vecino {

/// In quotes where it has to be.
std::string csv_field(const std::string& text);

std::string csv_line(const std::vector<std::string>& fields);

/// A line per object below a line of names. Nested objects become dotted names; arrays stay one
/// value, as JSON; null is an empty field. The column `first` stands first, the others in
/// alphabetical order.
std::string csv_text(const std::vector<nlohmann::json>& rows, const std::string& first);

}  // namespace vecino
