// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "core/planes.h"

namespace vecino {

/// Throws Error(file), naming who asks, if so much memory is not to be had on this machine. Linux
/// hands out more than there is, and kills the program when it is used.
void require_memory(std::uint64_t bytes, const std::string& who);

/// What planes of a size take.
std::uint64_t bytes_of(Planes planes, Extent size);

}  // namespace vecino
