// SPDX-License-Identifier: Apache-2.0

/// @file
/// Strict reading of JSON: every error is one line naming file, JSON pointer, what was found and
/// what is allowed. An unknown or doubled key is an error, so that a misspelt parameter cannot
/// silently keep its default.
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
    double least = -3.0e38;  ///< the smallest number that is allowed
    double most = 3.0e38;    ///< the largest number that is allowed
};

/// A value inside a JSON document, with the place it stands at. Holds references: the document must
/// outlive it.
class JsonValue {
  public:
    /// The value that stands at a JSON pointer (RFC 6901) in a file; both are for errors.
    JsonValue(const nlohmann::json& value, std::string file, std::string pointer = "")
        : value_(&value), file_(std::move(file)), pointer_(std::move(pointer)) {}

    /// The value itself.
    [[nodiscard]] const nlohmann::json& raw() const { return *value_; }
    /// The name of the file that it is from.
    [[nodiscard]] const std::string& file() const { return file_; }
    /// Where it stands there, as "/camera/position/0"; empty for the whole document.
    [[nodiscard]] const std::string& pointer() const { return pointer_; }

    /// Throws Error(usage) unless this is an object whose keys are all among the allowed ones.
    void require_keys(std::span<const std::string_view> allowed) const;
    /// The same for a list in braces.
    void require_keys(std::initializer_list<std::string_view> allowed) const {
        require_keys(std::span(allowed.begin(), allowed.size()));
    }

    /// Whether this is an object with such a key.
    [[nodiscard]] bool has(std::string_view key) const;
    /// Throws Error(usage) if this is no object or the key is missing.
    [[nodiscard]] JsonValue at(std::string_view key) const;
    /// Throws Error(usage) unless this is an array.
    [[nodiscard]] std::vector<JsonValue> elements() const;
    /// Keys and values. Throws Error(usage) unless this is an object.
    [[nodiscard]] std::vector<std::pair<std::string, JsonValue>> members() const;

    /// @name The value as a type of C++
    /// Each throws Error(usage) if the value is of another kind or out of range.
    /// @{
    [[nodiscard]] double number(NumberRange range = {}) const;   ///< a number in the range
    [[nodiscard]] float real(NumberRange range = {}) const;      ///< the same, rounded to float
    [[nodiscard]] int integer(int least, int most) const;        ///< 3, 3.0 and 3e0 are integers
    [[nodiscard]] bool boolean() const;                          ///< true or false
    [[nodiscard]] std::string string() const;                    ///< UTF-8
    [[nodiscard]] glm::vec3 vec3(NumberRange range = {}) const;  ///< an array of 3 numbers
    /// @}

    /// Throws Error(usage): "FILE: POINTER: found FOUND, allowed: ALLOWED".
    [[noreturn]] void fail(const std::string& allowed) const;
    /// The same, where what was found is better said than shown.
    [[noreturn]] void fail(const std::string& found, const std::string& allowed) const;

  private:
    const nlohmann::json* value_;
    std::string file_;
    std::string pointer_;
};

/// Parses a file. Throws Error(file) if it cannot be read, Error(usage) if it is no JSON or doubles
/// a key.
nlohmann::json parse_json_file(const std::string& path);

/// Parses text; name stands for the file in errors. Throws Error(usage) if it is no JSON or doubles
/// a key.
nlohmann::json parse_json_text(const std::string& text, const std::string& name);

/// "a, b, c"
std::string join(std::span<const std::string_view> names);

}  // namespace vecino
