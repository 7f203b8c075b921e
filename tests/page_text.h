// SPDX-License-Identifier: Apache-2.0
//
// Looking into the text of a report's page.
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

namespace vecino {

inline bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

inline std::size_t count(const std::string& text, const std::string& part) {
    std::size_t found = 0;
    for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
    return found;
}

/// What stands between the first `begin` and the next `end`; throws if there is none.
inline std::string between(const std::string& text, const std::string& begin,
                           const std::string& end) {
    const std::size_t from = text.find(begin);
    if (from == std::string::npos) throw std::logic_error("the page lacks " + begin);
    const std::size_t to = text.find(end, from + begin.size());
    if (to == std::string::npos) throw std::logic_error("the page lacks " + end);
    return text.substr(from + begin.size(), to - from - begin.size());
}

inline nlohmann::json embedded_data(const std::string& page) {
    return nlohmann::json::parse(
        between(page, "<script type=\"application/json\" id=\"report-data\">", "</script>"));
}

}  // namespace vecino
