// SPDX-License-Identifier: Apache-2.0
#include "eval/markdown_text.h"

#include <string_view>

namespace vecino::markdown {

std::string plain(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '\n' || c == '\r') {
            result += ' ';
        } else {
            if (std::string_view("\\`*_[]<>|#").find(c) != std::string_view::npos) result += '\\';
            result += c;
        }
    }
    return result;
}

std::string code(const std::string& text) {
    std::string result;
    for (const char c : text) {
        if (c == '|') result += '\\';
        result += c == '\n' || c == '\r' ? ' ' : c;
    }
    const bool has_tick = text.find('`') != std::string::npos;
    return has_tick ? "`` " + result + " ``" : "`" + result + "`";
}

std::string row(const Cells& cells) {
    std::string line = "|";
    for (const std::string& cell : cells) line += " " + cell + " |";
    return line + "\n";
}

std::string head(const Cells& names) {
    std::string text = row(names) + "|";
    for (std::size_t i = 0; i < names.size(); ++i) text += "---|";
    return text + "\n";
}

}  // namespace vecino::markdown
