// SPDX-License-Identifier: Apache-2.0
//
// Text for HTML pages. Nothing that comes from a run may reach a page unless it went through here.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace vecino {

/// With & < > " ' as character references: for text and for quoted attributes.
std::string escaped(std::string_view text);

/// JSON for the inside of a script element: no "<" in it, so that no value can end the element.
std::string script_json(const nlohmann::json& json);

/// JavaScript for the inside of a script element. Our own or a library's, not a run's.
std::string script_source(std::string_view source);

/// Base64 with padding (RFC 4648).
std::string base64_text(std::string_view bytes);

/// A data: URL that holds a PNG file.
std::string png_url(std::string_view bytes);

/// Puts values in the place of {{name}}; what is put in is not searched again. Throws
/// std::logic_error for a name without value: the page is part of the program.
std::string fill_page(std::string_view page, const std::map<std::string_view, std::string>& values);

}  // namespace vecino
