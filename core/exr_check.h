// SPDX-License-Identifier: Apache-2.0
//
// OpenImageIO ends the program when it meets a type of pixels that EXR does not have. So it never
// meets one.
#pragma once

#include <string>
#include <string_view>

namespace vecino {

/// Empty, or what is wrong with the channels that the header of an EXR file lists. Bytes that are
/// no EXR at all, or cut off within the header, are not its business.
std::string exr_fault(std::string_view bytes);

}  // namespace vecino
