// SPDX-License-Identifier: Apache-2.0
#include "eval/selection.h"

#include <algorithm>

#include "eval/axes.h"
#include "eval/matrix.h"
#include "eval/render_options.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

std::vector<std::string_view> method_names() {
    std::vector<std::string_view> names{"blocky_ceiling"};
    for (const Method& method : all_methods()) names.push_back(method.name);
    for (const Scheme& scheme : all_schemes()) names.push_back(scheme.name);
    return names;
}

/// As the value stands in a result's params.
Json canonical(const std::string& key, const JsonValue& value) {
    if (key == "method") {
        const auto names = method_names();
        if (std::ranges::find(names, value.string()) == names.end()) value.fail(join(names));
        return value.raw();
    }
    require_cell_value(key, value);
    for (const RenderOption& row : render_options()) {
        RenderSettings settings;
        if (row.name != key) continue;
        row.set(settings, value);
        return row.get(settings);
    }
    for (const SchemeOption& row : scheme_options()) {
        SchemeParameters parameters;
        if (row.name != key || key == "window") continue;
        row.set(parameters, value);
        return row.slug(parameters);
    }
    for (const MethodOption& row : method_options()) {
        MethodParameters parameters;
        if (row.name != key) continue;
        row.set(parameters, value);
        return row.get(parameters);
    }
    return value.raw();
}

bool holds(const std::vector<Json>& values, const Json& value) {
    return std::ranges::find(values, value) != values.end();
}

}  // namespace

Selection Selection::read(const JsonValue& json) {
    auto keys = cell_keys();
    std::erase(keys, "scheme");
    std::erase(keys, "image");
    json.require_keys(keys);
    Selection selection;
    for (const auto& [key, value] : json.members()) {
        for (const JsonValue& each : listed(key, value))
            selection.values_[key].push_back(canonical(key, each));
    }
    return selection;
}

Json selected_value(const Json& params, const std::string& key) {
    if (key == "scene") return stem(params.value("scene", ""));
    return params.value(key == "spp" ? "spp_asked" : key, Json());
}

bool Selection::matches(const Json& params) const {
    return std::ranges::all_of(values_, [&](const auto& entry) {
        return holds(entry.second, selected_value(params, entry.first));
    });
}

bool Selection::matches(const Json& params, const Selection& where) const {
    const auto fits = [&](const auto& entry) {
        const Json value = selected_value(params, entry.first);
        return names(entry.first) || value.is_null() || holds(entry.second, value);
    };
    return matches(params) && std::ranges::all_of(where.values_, fits);
}

std::vector<Json> Selection::at(const std::string& key) const {
    const auto found = values_.find(key);
    return found == values_.end() ? std::vector<Json>{} : found->second;
}

std::vector<std::string> Selection::mismatches(const Json& params) const {
    std::vector<std::string> keys;
    for (const auto& [key, values] : values_) {
        const Json value = selected_value(params, key);
        if (!value.is_null() && !holds(values, value)) keys.push_back(key);
    }
    return keys;
}

Selection Selection::without(const std::string& key) const {
    Selection rest = *this;
    rest.values_.erase(key);
    return rest;
}

std::string Selection::text() const {
    std::string text;
    for (const auto& [key, values] : values_) {
        text += (text.empty() ? "" : ", ") + key;
        for (const Json& value : values) {
            text += &value == values.data() ? " " : " or ";
            text += value.is_string() ? value.get<std::string>() : value.dump();
        }
    }
    return text;
}

void Selection::add_missing(const Selection& other) {
    values_.insert(other.values_.begin(), other.values_.end());
}

}  // namespace vecino
