// SPDX-License-Identifier: Apache-2.0

/// @file
/// Planes in the files of other renderers, by the names that these give their channels: Blender's
/// multilayer EXR, the aov integrator of Mitsuba, the gbuffer film of pbrt, and our own.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/frame.h"
#include "core/planes.h"

namespace vecino {

/// The channels that hold a plane: one name or three.
using ChannelNames = std::map<Plane, std::vector<std::string>>;

/// Reads "PLANE=A" or "PLANE=A,B,C" into the names, as `--channel` is given. Throws Error(usage)
/// naming the planes there are, or how many channels the plane has.
void add_channel_names(const std::string& text, ChannelNames& names);

/// The channels of a file that hold a plane, by the table of names; none if there are none. Of
/// several names of a plane the first in the table counts. Throws Error(mismatch) where two layers
/// go by it, naming both and the flag that tells them apart. path stands in errors.
std::optional<std::vector<std::string>> find_plane(Plane plane,
                                                   std::span<const std::string> channels,
                                                   const std::string& path);

/// What a file of some renderer holds of the planes that were asked for.
struct RendererFrame {
    Frame frame;         ///< as in the file: nothing is checked or decoded
    Planes half_planes;  ///< planes of 16-bit floats: too coarse for positions
};

/// Reads the planes asked for, from whichever part of the file holds them. Those that are not
/// there are left out; only radiance has to be there if it is asked for. Names that are given
/// stand for those of the table, and their channels have to be there. Fractions of ids are
/// rounded. Files that are no EXR hold radiance alone. Throws as load_frame() does.
RendererFrame load_renderer_frame(const std::string& path, Planes wanted,
                                  const ChannelNames& given = {});

}  // namespace vecino
