// SPDX-License-Identifier: Apache-2.0
//
// Tables of Markdown.
#pragma once

#include <string>
#include <vector>

namespace vecino::markdown {

using Cells = std::vector<std::string>;

/// As text of a table: nothing in it is markup, and it stays in its cell.
std::string plain(const std::string& text);

/// As code in a table: GitHub takes a bar for the end of the cell even there.
std::string code(const std::string& text);

/// Cells as they are.
std::string row(const Cells& cells);

/// The first two lines of a table.
std::string head(const Cells& names);

}  // namespace vecino::markdown
