// SPDX-License-Identifier: Apache-2.0
//
// The options of a render: one name for matrices and one flag for the command line each, from one
// table.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "core/option_row.h"
#include "core/render.h"

namespace vecino {

using RenderOption = OptionRow<RenderSettings>;

/// Options that make the image what it is; all may be axes of a matrix.
std::span<const RenderOption> render_options();

/// Whether results name an option: that of a camera that is not moved stays out of them, so that
/// they are those of the same cells as before there was one.
bool is_told(const RenderOption& row, const RenderSettings& settings);

/// A value from the command line as JSON: a number where it reads as one, [W, H] for WxH, [X, Y]
/// for X,Y, else a string.
nlohmann::json option_value(const std::string& text);

}  // namespace vecino
