// SPDX-License-Identifier: Apache-2.0
#include "eval/axes.h"

#include <algorithm>

#include "eval/budget.h"
#include "eval/render_options.h"
#include "filters/methods.h"
#include "filters/schemes.h"

namespace vecino {
namespace {

void require_one_of(std::span<const std::string_view> names, const JsonValue& value) {
    if (std::ranges::find(names, value.string()) == names.end()) value.fail(join(names));
}

void require_option(const std::string& key, const JsonValue& value) {
    RenderSettings settings;
    SchemeParameters parameters;
    for (const RenderOption& row : render_options()) {
        if (row.name == key) row.set(settings, value);
    }
    for (const SchemeOption& row : scheme_options()) {
        if (row.name == key) row.set(parameters, value);
    }
    MethodParameters method;
    for (const MethodOption& row : method_options()) {
        if (row.name == key) row.set(method, value);
    }
}

template <class Row>
std::vector<std::string_view> names_of(std::span<const Row> rows) {
    std::vector<std::string_view> names;
    for (const Row& row : rows) names.push_back(row.name);
    return names;
}

template <class Row>
bool has_row(std::span<const Row> rows, std::string_view name) {
    return std::ranges::find(rows, name, &Row::name) != rows.end();
}

}  // namespace

std::vector<std::string_view> cell_keys() {
    std::vector<std::string_view> keys{"scene", "scheme", "method", "image", "budget"};
    for (const RenderOption& row : render_options()) keys.push_back(row.name);
    for (const SchemeOption& row : scheme_options()) keys.push_back(row.name);
    for (const MethodOption& row : method_options()) {
        // Schemes and methods may share an option, which is then one key.
        if (std::ranges::find(keys, row.name) == keys.end()) keys.push_back(row.name);
    }
    return keys;
}

void require_cell_value(const std::string& key, const JsonValue& value) {
    if (key == "scene" || key == "image") {
        if (value.string().empty()) value.fail("a string that is not empty");
    } else if (key == "scheme") {
        require_one_of(names_of(all_schemes()), value);
    } else if (key == "method") {
        require_one_of(names_of(all_methods()), value);
    } else if (key == "budget") {
        (void)budget_of(value);
    } else {
        require_option(key, value);
    }
}

void require_one_kind(const JsonValue& json) {
    std::vector<std::string> kinds{"method", "scheme", "image"};
    std::erase_if(kinds, [&](const std::string& kind) { return !json.has(kind); });
    if (kinds.size() > 1)
        json.fail("both \"" + kinds[0] + "\" and \"" + kinds[1] + "\"",
                  "one of them: a cell has either");
}

std::vector<JsonValue> listed(const std::string& key, const JsonValue& value) {
    const bool is_pair = key == "size" || key == "camera_shift";
    const bool one_pair = is_pair && value.raw().is_array() && !value.raw().empty() &&
                          !value.raw().front().is_array();
    if (one_pair || !value.raw().is_array()) return {value};
    auto values = value.elements();
    if (values.empty()) value.fail("at least one value");
    return values;
}

Axes read_axes(const JsonValue& json) {
    json.require_keys(cell_keys());
    Axes axes;
    for (const auto& [key, value] : json.members()) {
        for (const JsonValue& each : listed(key, value)) require_cell_value(key, each);
        axes.insert_or_assign(key, listed(key, value));
    }
    require_one_kind(json);
    return axes;
}

bool is_scheme_key(const std::string& key) {
    if (key == "scheme" || key == "budget" || key == "reduction") return true;
    return has_row(scheme_options(), key) && !has_row(method_options(), key);
}

bool is_method_key(const std::string& key) {
    return has_row(method_options(), key) && !has_row(scheme_options(), key);
}

}  // namespace vecino
