// SPDX-License-Identifier: Apache-2.0
#include "eval/html_text.h"

#include <cstdint>
#include <stdexcept>

namespace vecino {
namespace {

std::string replaced(std::string text, std::string_view from, std::string_view to) {
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at)) {
        text.replace(at, from.size(), to);
        at += to.size();
    }
    return text;
}

}  // namespace

std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : text) {
        switch (c) {
            case '&':
                result += "&amp;";
                break;
            case '<':
                result += "&lt;";
                break;
            case '>':
                result += "&gt;";
                break;
            case '"':
                result += "&quot;";
                break;
            case '\'':
                result += "&#39;";
                break;
            default:
                result += c;
        }
    }
    return result;
}

std::string script_json(const nlohmann::json& json) {
    // In JSON a "<" stands in strings only, where an escape means the same.
    using Handler = nlohmann::json::error_handler_t;
    return replaced(json.dump(-1, ' ', false, Handler::replace), "<", "\\u003c");
}

std::string script_source(std::string_view source) {
    return replaced(std::string(source), "</script", "<\\/script");
}

std::string base64_text(std::string_view bytes) {
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        const auto byte = [&](std::size_t offset) {
            return i + offset < bytes.size() ? static_cast<unsigned char>(bytes[i + offset]) : 0u;
        };
        const std::uint32_t group = byte(0) << 16 | byte(1) << 8 | byte(2);
        for (const int shift : {18, 12, 6, 0}) text += kDigits[group >> shift & 63u];
    }
    const std::size_t padding = (3 - bytes.size() % 3) % 3;
    return text.replace(text.size() - padding, padding, padding, '=');
}

std::string png_url(std::string_view bytes) {
    return "data:image/png;base64," + base64_text(bytes);
}

std::string fill_page(std::string_view page,
                      const std::map<std::string_view, std::string>& values) {
    std::string result;
    for (std::size_t begin = page.find("{{"); begin != std::string_view::npos;
         begin = page.find("{{")) {
        const std::size_t end = page.find("}}", begin);
        const std::string_view name = page.substr(begin + 2, end - begin - 2);
        const auto value = values.find(name);
        if (value == values.end()) throw std::logic_error("page: {{" + std::string(name) + "}}");
        result += page.substr(0, begin);
        result += value->second;
        page.remove_prefix(end + 2);
    }
    return result.append(page);
}

}  // namespace vecino
