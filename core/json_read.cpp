// SPDX-License-Identifier: Apache-2.0
#include "core/json_read.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <limits>
#include <utility>

#include "core/error.h"
#include "core/files.h"

namespace vecino {
namespace {

using nlohmann::json;

/// Far deeper than any file of ours, far shallower than what exhausts a stack.
constexpr std::size_t kMaxDepth = 100;
constexpr std::size_t kShownCharacters = 60;

/// Cuts between characters of UTF-8, never inside one.
std::string shortened(std::string text) {
    if (text.size() <= kShownCharacters) return text;
    std::size_t end = kShownCharacters;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;
    return text.substr(0, end) + "...";
}

std::string dumped(const json& value) {
    return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

std::string valid_utf8(const std::string& text) {
    return json::parse(dumped(text)).get<std::string>();
}

std::string pointer_token(const std::string& key) {
    std::string token = "/";
    for (const char c : key) {
        if (c == '~' || c == '/') {
            token += c == '~' ? "~0" : "~1";
        } else {
            token += c;
        }
    }
    return token;
}

std::string number_text(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", value);
    return text;
}

/// "a number from 0 to 10"; the default bounds are named only when the value breaks them.
std::string describe(NumberRange range, bool both) {
    const NumberRange unbounded;
    const bool least = both || range.least > unbounded.least;
    const bool most = both || range.most < unbounded.most;
    std::string text = "a number";
    if (least) text += (most ? " from " : " of at least ") + number_text(range.least);
    if (most) text += (least ? " to " : " of at most ") + number_text(range.most);
    return text;
}

std::string describe_integers(int least, int most) {
    const std::string text = "an integer ";
    if (most == std::numeric_limits<int>::max())
        return text + "of at least " + std::to_string(least);
    return text + "from " + std::to_string(least) + " to " + std::to_string(most);
}

/// Builds the document as nlohmann's own parser does, and refuses what that one lets pass: doubled
/// keys and bottomless nesting.
class DocumentBuilder final : public nlohmann::json_sax<json> {
  public:
    DocumentBuilder(const std::string& text, const std::string& name) : text_(text), name_(name) {}

    json take() { return std::move(document_); }

    bool null() override { return add(nullptr) != nullptr; }
    bool boolean(bool value) override { return add(value) != nullptr; }
    bool number_integer(number_integer_t value) override { return add(value) != nullptr; }
    bool number_unsigned(number_unsigned_t value) override { return add(value) != nullptr; }
    bool number_float(number_float_t value, const string_t&) override {
        return add(value) != nullptr;
    }
    bool string(string_t& value) override { return add(std::move(value)) != nullptr; }
    bool binary(binary_t&) override { return false; }  // text holds none

    bool start_object(std::size_t) override { return open(json::object()); }
    bool end_object() override { return close(); }
    bool start_array(std::size_t) override { return open(json::array()); }
    bool end_array() override { return close(); }

    bool key(string_t& name) override {
        if (levels_.back().container->contains(name)) {
            here(levels_.size() - 1)
                .fail("the key " + shortened(dumped(name)) + " twice", "every key once");
        }
        levels_.back().key = name;
        return true;
    }

    bool parse_error(std::size_t position, const std::string& last_token,
                     const json::exception& error) override {
        throw Error(ExitCode::usage,
                    one_line(name_ + ": " + place(position) + reason(error.what(), last_token)));
    }

  private:
    struct Level {
        json* container;
        std::string key;  ///< of the member being read, in an object
    };

    json* add(json value) {
        if (levels_.empty()) return &(document_ = std::move(value));
        json& container = *levels_.back().container;
        if (container.is_object()) return &(container[levels_.back().key] = std::move(value));
        container.push_back(std::move(value));
        return &container.back();
    }

    bool open(json empty) {
        if (levels_.size() == kMaxDepth) {
            const std::string limit = std::to_string(kMaxDepth);
            here(0).fail("values nested deeper than " + limit, "at most " + limit + " levels");
        }
        levels_.push_back({add(std::move(empty)), ""});
        return true;
    }

    bool close() {
        levels_.pop_back();
        return true;
    }

    /// The place of the value that is read at a depth of nesting.
    [[nodiscard]] JsonValue here(std::size_t depth) const {
        std::string pointer;
        for (std::size_t i = 0; i < depth; ++i) {
            const Level& level = levels_[i];
            pointer += level.container->is_object()
                           ? pointer_token(level.key)
                           : "/" + std::to_string(level.container->size() - 1);
        }
        return {document_, name_, pointer};
    }

    /// The place of the last character that was read; nlohmann tells it in some errors only.
    [[nodiscard]] std::string place(std::size_t characters_read) const {
        const std::size_t last =
            std::min(std::max<std::size_t>(characters_read, 1) - 1, text_.size());
        const auto end = text_.begin() + static_cast<std::ptrdiff_t>(last);
        const auto line = 1 + std::count(text_.begin(), end, '\n');
        const auto line_start = std::find(std::reverse_iterator(end), text_.rend(), '\n').base();
        return "line " + std::to_string(line) + ", column " + std::to_string(end - line_start + 1) +
               ": ";
    }

    /// "[json.exception.parse_error.101] parse error at line 1, column 2: REASON" without its head,
    /// and with the last token, which may be a megabyte of string, shortened.
    static std::string reason(std::string what, const std::string& last_token) {
        what.erase(0, what.find("] ") + 2);
        if (what.starts_with("parse error at ")) what.erase(0, what.find(": ") + 2);
        const std::size_t token = what.find(last_token);
        if (token != std::string::npos) {
            what.replace(token, last_token.size(), shortened(last_token));
        }
        return valid_utf8(what);
    }

    const std::string& text_;
    const std::string& name_;
    json document_;
    std::vector<Level> levels_;
};

}  // namespace

void JsonValue::fail(const std::string& allowed) const {
    fail(shortened(dumped(*value_)), allowed);
}

void JsonValue::fail(const std::string& found, const std::string& allowed) const {
    const std::string place = pointer_.empty() ? "/" : pointer_;
    throw Error(ExitCode::usage,
                one_line(file_ + ": " + place + ": found " + found + ", allowed: " + allowed));
}

void JsonValue::require_keys(std::span<const std::string_view> allowed) const {
    if (!value_->is_object()) fail("an object");
    for (const auto& [key, value] : value_->items()) {
        if (std::ranges::find(allowed, key) != allowed.end()) continue;
        fail("unknown key " + shortened(dumped(key)), allowed.empty() ? "none" : join(allowed));
    }
}

bool JsonValue::has(std::string_view key) const {
    return value_->contains(key);
}

JsonValue JsonValue::at(std::string_view key) const {
    if (!value_->is_object()) fail("an object");
    const std::string name(key);
    const auto found = value_->find(name);
    if (found == value_->end()) fail("no key \"" + name + "\"", "an object that has it");
    return {*found, file_, pointer_ + pointer_token(name)};
}

std::vector<JsonValue> JsonValue::elements() const {
    if (!value_->is_array()) fail("an array");
    std::vector<JsonValue> elements;
    elements.reserve(value_->size());
    for (const json& element : *value_) {
        elements.emplace_back(element, file_, pointer_ + "/" + std::to_string(elements.size()));
    }
    return elements;
}

std::vector<std::pair<std::string, JsonValue>> JsonValue::members() const {
    if (!value_->is_object()) fail("an object");
    std::vector<std::pair<std::string, JsonValue>> members;
    members.reserve(value_->size());
    for (const auto& [key, value] : value_->items()) {
        members.emplace_back(key, JsonValue(value, file_, pointer_ + pointer_token(key)));
    }
    return members;
}

double JsonValue::number(NumberRange range) const {
    if (!value_->is_number()) fail(describe(range, false));
    const auto number = value_->get<double>();
    const NumberRange unbounded;
    const bool extreme = number < unbounded.least || number > unbounded.most;
    if (!(number >= range.least && number <= range.most)) fail(describe(range, extreme));
    return number;
}

float JsonValue::real(NumberRange range) const {
    constexpr double limit = std::numeric_limits<float>::max();
    range = {std::max(range.least, -limit), std::min(range.most, limit)};
    const auto value = static_cast<float>(number(range));
    if (range.least > 0.0 && value == 0.0f) fail(describe(range, false));  // it underflowed
    return value;
}

int JsonValue::integer(int least, int most) const {
    if (!value_->is_number()) fail(describe_integers(least, most));
    const auto number = value_->get<double>();  // 3.0 and 1e4 are integers too
    const bool fits = number >= least && number <= most && std::trunc(number) == number;
    if (!fits) fail(describe_integers(least, most));
    return static_cast<int>(number);
}

bool JsonValue::boolean() const {
    if (!value_->is_boolean()) fail("true or false");
    return value_->get<bool>();
}

std::string JsonValue::string() const {
    if (!value_->is_string()) fail("a string");
    return value_->get<std::string>();
}

glm::vec3 JsonValue::vec3(NumberRange range) const {
    if (!value_->is_array()) fail("3 numbers");
    const std::vector<JsonValue> parts = elements();
    if (parts.size() != 3) {
        fail(std::to_string(parts.size()) + (parts.size() == 1 ? " element" : " elements"),
             "3 numbers");
    }
    return {parts[0].real(range), parts[1].real(range), parts[2].real(range)};
}

json parse_json_file(const std::string& path) {
    return parse_json_text(read_file(path), path);
}

json parse_json_text(const std::string& text, const std::string& name) {
    if (text.empty()) {  // the library words this differently from version to version
        throw Error(ExitCode::usage, name + ": line 1, column 1: unexpected end of input");
    }
    DocumentBuilder builder(text, name);
    json::sax_parse(text, &builder);
    return builder.take();
}

std::string join(std::span<const std::string_view> names) {
    std::string list;
    for (const std::string_view name : names) {
        if (!list.empty()) list += ", ";
        list += name;
    }
    return list;
}

}  // namespace vecino
