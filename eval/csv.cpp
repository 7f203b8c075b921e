// SPDX-License-Identifier: Apache-2.0
#include "eval/csv.h"

#include <map>
#include <set>

namespace vecino {
namespace {

using Fields = std::map<std::string, std::string>;

void flatten(const nlohmann::json& value, const std::string& name, Fields& out) {
    if (value.is_object()) {
        for (const auto& [key, member] : value.items()) {
            flatten(member, name.empty() ? key : name + "." + key, out);
        }
    } else if (value.is_string()) {
        out[name] = value.get<std::string>();
    } else if (!value.is_null()) {
        out[name] = value.dump();
    }
}

}  // namespace

std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
    return quoted + '"';
}

std::string csv_line(const std::vector<std::string>& fields) {
    std::string line;
    for (std::size_t i = 0; i < fields.size(); ++i)
        line += (i == 0 ? "" : ",") + csv_field(fields[i]);
    return line + "\n";
}

std::string csv_text(const std::vector<nlohmann::json>& rows, const std::string& first) {
    std::vector<Fields> flat;
    std::set<std::string> names;
    for (const nlohmann::json& row : rows) {
        flatten(row, "", flat.emplace_back());
        for (const auto& [name, value] : flat.back()) names.insert(name);
    }
    names.erase(first);
    std::string text = csv_field(first);
    for (const std::string& name : names) text += "," + csv_field(name);
    text += "\n";
    for (Fields& row : flat) {
        text += csv_field(row[first]);
        for (const std::string& name : names) text += "," + csv_field(row[name]);
        text += "\n";
    }
    return text;
}

}  // namespace vecino
