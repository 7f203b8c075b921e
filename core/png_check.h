// SPDX-License-Identifier: Apache-2.0
//
// libpng prints to stderr, by itself and whoever calls it, when it meets a broken file. So it never
// meets one.
#pragma once

#include <string>
#include <string_view>

namespace vecino {

/// Empty, or what is wrong with the bytes of a PNG file: cut off, or damaged by its own checksums.
/// Bytes that are no PNG at all are not its business.
std::string png_fault(std::string_view bytes);

}  // namespace vecino
