// SPDX-License-Identifier: Apache-2.0
#include "core/memory.h"

#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <limits>

#include "core/error.h"

namespace vecino {
namespace {

/// Memory and swap that are free, or can be freed; what cannot be found out counts as endless.
std::uint64_t available_bytes() {
    std::ifstream stream("/proc/meminfo");
    std::uint64_t kibibytes = 0;
    bool known = false;
    std::string name;
    std::uint64_t value = 0;
    for (std::string unit; stream >> name >> value && std::getline(stream, unit);) {
        if (name != "MemAvailable:" && name != "SwapFree:") continue;
        kibibytes += value;
        known = true;
    }
    return known ? kibibytes * 1024 : std::numeric_limits<std::uint64_t>::max();
}

std::string gibibytes(std::uint64_t bytes) {
    char text[32];
    std::snprintf(text, sizeof text, "%.1f GiB", static_cast<double>(bytes) * 0x1p-30);
    return text;
}

}  // namespace

void require_memory(std::uint64_t bytes, const std::string& who) {
    constexpr std::uint64_t kAlwaysThere = std::uint64_t{1} << 26;
    if (bytes < kAlwaysThere) return;
    const std::uint64_t available = available_bytes();
    if (bytes <= available) return;
    throw Error(ExitCode::file, who + ": needs " + gibibytes(bytes) +
                                    " of memory, this machine has " + gibibytes(available) +
                                    " left");
}

std::uint64_t bytes_of(Planes planes, Extent size) {
    std::uint64_t values = 0;
    for (const PlaneInfo& info : all_planes()) {
        if (planes.has(info.plane)) values += info.channel_count();
    }
    return values * sizeof(float) * size.area();
}

}  // namespace vecino
