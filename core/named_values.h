// SPDX-License-Identifier: Apache-2.0
//
// Enumerations by name, from one table each: reading, writing, help and errors follow from the
// table, and an unknown name is an error that lists the known ones.
#pragma once

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "core/json_read.h"

namespace vecino {

template <class Value>
struct Named {
    std::string_view name;
    Value value;
};

template <class Value, std::size_t N>
std::vector<std::string_view> names_of(const Named<Value> (&table)[N]) {
    std::vector<std::string_view> names;
    std::ranges::transform(table, std::back_inserter(names), &Named<Value>::name);
    return names;
}

template <class Value, std::size_t N>
Value value_of(const Named<Value> (&table)[N], const JsonValue& json) {
    const auto* const row = std::ranges::find(table, json.string(), &Named<Value>::name);
    if (row != std::end(table)) return row->value;
    json.fail(join(names_of(table)));
}

template <class Value, std::size_t N>
std::string name_of(const Named<Value> (&table)[N], Value value) {
    return std::string(std::ranges::find(table, value, &Named<Value>::value)->name);
}

}  // namespace vecino
