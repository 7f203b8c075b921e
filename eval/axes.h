// SPDX-License-Identifier: Apache-2.0
//
// The vocabulary of matrices: which keys name a parameter of a cell, and what values they take.
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/json_read.h"

namespace vecino {

/// Values by key. Refers to the document that it was read from.
using Axes = std::map<std::string, std::vector<JsonValue>>;

/// "scene", "scheme", "method", "image", "budget" and every row of the option tables of renders,
/// schemes and render methods.
std::vector<std::string_view> cell_keys();

/// Throws Error(usage) unless the value may stand at that key. Precondition: key is a cell key.
void require_cell_value(const std::string& key, const JsonValue& value);

/// Throws Error(usage) if an object of cell keys has two of "method", "scheme" and "image".
void require_one_kind(const JsonValue& json);

/// An object of cell keys, each with one value or an array of several, all of them checked.
Axes read_axes(const JsonValue& json);

/// The values of one key: an array lists several, but "size" and "camera_shift" take [X, Y] as
/// one.
std::vector<JsonValue> listed(const std::string& key, const JsonValue& value);

/// Whether only schemes read this key, so that it says nothing about a method.
bool is_scheme_key(const std::string& key);

/// Whether only render methods read this key, so that it says nothing about a scheme.
bool is_method_key(const std::string& key);

}  // namespace vecino
