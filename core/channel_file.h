// SPDX-License-Identifier: Apache-2.0
//
// EXR files of any channels, each one 32-bit float per pixel, kept bit for bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/grid.h"
#include "core/image_io.h"

namespace vecino {

/// A channel of a plane's value.
inline float component(const glm::vec3& value, std::size_t c) {
    return value[static_cast<int>(c)];
}
inline float component(float value, std::size_t) {
    return value;
}
inline float component(std::int32_t value, std::size_t) {
    return static_cast<float>(value);
}

/// A channel to write: its name, and its values by the number of the pixel, counted row by row.
struct ChannelSource {
    std::string name;
    std::function<float(std::size_t pixel)> value;
};

/// Writes one row after the other; no copy of all channels is made. Throws Error(file).
void save_channels(const std::string& path, Extent size, std::span<const ChannelSource> channels,
                   const Metadata& metadata);

struct Channel {
    std::string name;
    std::vector<float> values;  ///< one per pixel, row by row
};

struct ChannelFile {
    Extent size;
    Metadata metadata;
    std::vector<Channel> channels;
};

/// Reads all but the channels. Throws as load_channels() does.
ChannelFile load_header(const std::string& path);

/// Reads what save_channels() wrote; attributes of other types than Metadata has are left out.
/// Throws Error(file) if it cannot be read or decoded.
ChannelFile load_channels(const std::string& path);

/// A channel of some part of a file.
struct ChannelInfo {
    std::string name;
    bool is_half = false;  ///< 16 bits, of which 11 are digits
};

/// All channels, of all parts of a file. Throws as load_channels() does.
std::vector<ChannelInfo> list_channels(const std::string& path);

/// Reads the channels of these names, in this order, whichever part holds them. Throws
/// Error(file) if the file cannot be read or decoded, Error(mismatch) if a channel is not there,
/// holds integers, or is of another size than the first part.
ChannelFile load_channels(const std::string& path, std::span<const std::string> names);

}  // namespace vecino
