// SPDX-License-Identifier: Apache-2.0
//
// The float values behind a report's pictures, for its viewer: as scripts beside the page, which a
// browser loads from disk when they are looked at, or inside of the page.
#pragma once

#include <optional>
#include <string>

#include "core/grid.h"

namespace vecino {

/// How exactly a page keeps the values that it embeds. Beside it they are always float32.
enum class PlanePrecision {
    float32,  ///< the values themselves
    float16,  ///< their differences from the reference, which stays float32
};

struct PlaneOptions {
    std::string page;                        ///< where it goes; "": DIR/report.html
    std::optional<PlanePrecision> embedded;  ///< none: beside the page
};

/// "float32", "float16"
std::string precision_name(PlanePrecision precision);

/// Throws Error(usage) for another name.
PlanePrecision parse_precision(const std::string& name);

/// Red, green, blue of all pixels, row by row from the top: little-endian float32 in base64.
std::string plane_base64(const Image& image);

/// The differences from a reference of the same size, as float16 in base64. Where the reference is
/// not finite, the value itself. Finite values stay finite: what a half cannot hold is clipped.
std::string difference_base64(const Image& image, const Image& reference);

/// Bytes that a plane of a size takes in a page, about.
double embedded_bytes(Extent size, PlanePrecision precision);

/// Writes a script that hands a plane to the page. A file that holds it already is left alone.
/// Throws Error(file).
void write_plane_script(const Image& image, const std::string& id, const std::string& path);

/// The same as an element of the page; text is what plane_base64 or difference_base64 gave.
std::string plane_element(const std::string& id, Extent size, const std::string& text);

}  // namespace vecino
