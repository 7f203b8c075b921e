// SPDX-License-Identifier: Apache-2.0
//
// Strict reading of JSON: every error is one line naming file, JSON pointer, what was found and
// what is allowed. An unknown or doubled key is an error, so that a misspelt parameter cannot
// silently keep its default.
#pragma once

#include <glm/vec3.hpp>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace vecino {

/// Inclusive bounds of a number.
struct NumberRange {
    double least = -3.0e38;
    double most = 3.0e38;
};

/// A value inside a JSON document, with the place it stands at. Holds references: the document must
/// outlive it.
class JsonValue {
  public:
    JsonValue(const nlohmann::json& value, std::string file, std::string pointer = "")
        : value_(&value), file_(std::move(file)), pointer_(std::move(pointer)) {}

    [[nodiscard]] const nlohmann::json& raw() const { return *value_; }
    [[nodiscard]] const std::string& file() const { return file_; }
    [[nodiscard]] const std::string& pointer() const { return pointer_; }

    /// Throws unless this is an object whose keys are all among the allowed ones.
    void require_keys(std::span<const std::string_view> allowed) const;
    void require_keys(std::initializer_list<std::string_view> allowed) const {
        require_keys(std::span(allowed.begin(), allowed.size()));
    }

    [[nodiscard]] bool has(std::string_view key) const;
    [[nodiscard]] JsonValue at(std::string_view key) const;  ///< throws if the key is missing
    [[nodiscard]] std::vector<JsonValue> elements() const;   ///< throws unless this is an array
    [[nodiscard]] std::vector<std::pair<std::string, JsonValue>> members() const;

    [[nodiscard]] double number(NumberRange range = {}) const;
    [[nodiscard]] float real(NumberRange range = {}) const;
    [[nodiscard]] int integer(int least, int most) const;
    [[nodiscard]] bool boolean() const;
    [[nodiscard]] std::string string() const;
    [[nodiscard]] glm::vec3 vec3(NumberRange range = {}) const;

    /// Throws Error(usage): "FILE: POINTER: found FOUND, allowed: ALLOWED".
    [[noreturn]] void fail(const std::string& allowed) const;
    [[noreturn]] void fail(const std::string& found, const std::string& allowed) const;

  private:
    const nlohmann::json* value_;
    std::string file_;
    std::string pointer_;
};

/// Parses a file. Throws Error(file) if it cannot be read, Error(usage) if it is no JSON or doubles
/// a key.
nlohmann::json parse_json_file(const std::string& path);

/// Parses text; name stands for the file in errors.
nlohmann::json parse_json_text(const std::string& text, const std::string& name);

/// "a, b, c"
std::string join(std::span<const std::string_view> names);

}  // namespace vecino
