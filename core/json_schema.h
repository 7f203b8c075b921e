// SPDX-License-Identifier: Apache-2.0
//
// Kinds of JSON values, and tables of an object's keys, that are read and described (as JSON
// Schema, for editors) from the same facts: what a file may hold is said once. A schema cannot say
// all that reading checks: that a triangle has an area, or that a material of this name exists.
#pragma once

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/json_read.h"
#include "core/named_values.h"

namespace vecino {

struct IntegerKind {
    int least;
    int most;  ///< the largest int: no bound
    [[nodiscard]] int read(const JsonValue& json) const { return json.integer(least, most); }
    [[nodiscard]] nlohmann::json schema() const;
};

struct RealKind {
    NumberRange range{};
    [[nodiscard]] float read(const JsonValue& json) const { return json.real(range); }
    [[nodiscard]] nlohmann::json schema() const;
};

struct Vec3Kind {
    NumberRange range{};
    [[nodiscard]] glm::vec3 read(const JsonValue& json) const { return json.vec3(range); }
    [[nodiscard]] nlohmann::json schema() const;
};

struct BooleanKind {
    [[nodiscard]] bool read(const JsonValue& json) const { return json.boolean(); }
    [[nodiscard]] nlohmann::json schema() const { return {{"type", "boolean"}}; }
};

struct TextKind {
    [[nodiscard]] std::string read(const JsonValue& json) const { return json.string(); }
    [[nodiscard]] nlohmann::json schema() const { return {{"type", "string"}}; }
};

/// One of the names of a table.
template <class Value, std::size_t N>
struct ChoiceKind {
    const Named<Value> (&names)[N];
    [[nodiscard]] Value read(const JsonValue& json) const { return value_of(names, json); }
    [[nodiscard]] nlohmann::json schema() const { return {{"enum", names_of(names)}}; }
};
template <class Value, std::size_t N>
ChoiceKind(const Named<Value> (&)[N]) -> ChoiceKind<Value, N>;  // which Clang 14 asks for

/// Bounds on the number of elements; at most 0: any number of them.
struct ElementCount {
    int least;
    int most;
};
nlohmann::json array_schema(const nlohmann::json& element, ElementCount count);

template <class Member>
struct MemberOf;
template <class OwnerType, class ValueType>
struct MemberOf<ValueType OwnerType::*> {
    using Owner = OwnerType;
    using Value = ValueType;
};

/// For the cells of a table: reads a value of a kind into a member.
template <const auto& kKind, auto kMember>
void read_into(typename MemberOf<decltype(kMember)>::Owner& owner, const JsonValue& json) {
    owner.*kMember = static_cast<typename MemberOf<decltype(kMember)>::Value>(kKind.read(json));
}

template <const auto& kKind>
nlohmann::json schema_of() {
    return kKind.schema();
}

enum class Presence { required, optional };

/// A key of a JSON object that is read into an Owner: one row each.
template <class Owner>
struct JsonKey {
    std::string_view name;
    Presence presence;
    std::string_view summary;  ///< shown by editors; may be empty
    void (*read)(Owner&, const JsonValue&);
    nlohmann::json (*schema)();
};

/// A key that is described here and read elsewhere.
struct DescribedKey {
    std::string_view name;
    Presence presence;
    std::string_view summary;
    nlohmann::json (*schema)();
};

/// The row of a key whose value is read into a member.
template <const auto& kKind, auto kMember>
constexpr auto member_key(std::string_view name, Presence presence, std::string_view summary) {
    using Owner = typename MemberOf<decltype(kMember)>::Owner;
    return JsonKey<Owner>{name, presence, summary, read_into<kKind, kMember>, schema_of<kKind>};
}

/// Reads the keys in the order of the table. Throws as JsonValue does, for an unknown key too.
template <class Owner, std::size_t N>
void read_object(const JsonValue& json, const JsonKey<Owner> (&keys)[N], Owner& owner) {
    std::vector<std::string_view> names;
    std::ranges::transform(keys, std::back_inserter(names), &JsonKey<Owner>::name);
    json.require_keys(names);
    for (const JsonKey<Owner>& key : keys) {
        const bool given = key.presence == Presence::required || json.has(key.name);
        if (given) key.read(owner, json.at(key.name));
    }
}

/// Rows with name, presence, summary and schema.
template <class Row, std::size_t N>
nlohmann::json object_schema(const Row (&rows)[N]) {
    nlohmann::json schema{{"type", "object"}, {"additionalProperties", false}};
    for (const Row& row : rows) {
        nlohmann::json& property = schema["properties"][std::string(row.name)] = row.schema();
        if (!row.summary.empty()) property["description"] = row.summary;
        if (row.presence == Presence::required) schema["required"].push_back(row.name);
    }
    return schema;
}

/// A whole document's schema, of the draft that editors know best.
nlohmann::json document_schema(const std::string& title, nlohmann::json schema);

}  // namespace vecino
