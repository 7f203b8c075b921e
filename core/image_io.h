// SPDX-License-Identifier: Apache-2.0

/// @file
/// Image files, through OpenImageIO (which appears nowhere else: image_io.cpp reads,
/// image_write.cpp writes). A file is written under a temporary name and renamed: whole or not at
/// all. By extension:
/// - `.exr`: every plane of a frame (channel names: core/planes.h), linear 32-bit float
/// - `.hdr` `.tif` `.tiff`: radiance only, linear float (`.hdr` is RGBE)
/// - `.png` `.bmp`: radiance only, clipped to [0,1], sRGB-encoded, 8 bit
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <variant>

#include "core/frame.h"

namespace vecino {

/// Attributes of an EXR file beside its planes, by name: "scene", "spp", "seed", ...
using Metadata = std::map<std::string, std::variant<int, float, std::string>>;

/// Writes a frame: the planes that it holds to .exr, radiance alone to other files, which also have
/// no place for metadata. Throws Error(file) when it cannot be written or the extension is none of
/// the above, Error(mismatch) if it has no pixels, more than 2^31 - 1, or planes of several sizes,
/// and Error(non_finite) for a non-finite pixel bound for an 8-bit or RGBE file, which could not
/// show it.
void save_frame(const Frame& frame, const std::string& path, const Metadata& metadata = {});

/// Writes radiance alone. Throws as save_frame() does.
void save_image(const Image& image, const std::string& path);

/// Writes 8-bit RGB values as they are (already encoded) to .png or .bmp: pictures such as error
/// maps. Throws Error(file) for other extensions or when it cannot be written, Error(mismatch) if
/// there are no pixels.
void save_raster(const Grid<glm::u8vec3>& raster, const std::string& path);

/// The formats that can be written, for help and errors: ".exr, .hdr, ...".
std::string writable_extensions();

/// Throws Error(usage) if the extension of path cannot be written; so that a long job fails before
/// it starts.
void require_writable_extension(const std::string& path);

/// Reads radiance and every known plane that the file holds. Integer formats are decoded from sRGB,
/// floating ones are linear. Grey becomes RGB; alpha and unknown channels play no part. Throws
/// Error(file) if it cannot be read or decoded, Error(mismatch) if it has no colour channels or
/// only some channels of a plane, and Error(non_finite) if an object id is no 32-bit integer.
Frame load_frame(const std::string& path);

/// Reads radiance alone. Throws as load_frame() does.
Image load_image(const std::string& path);

/// Reads radiance from the channels of these names, as other programs call them. Throws as
/// load_image() does, Error(mismatch) naming what is there if one of them is not.
Image load_image(const std::string& path, const std::array<std::string, 3>& channels);

/// Of OpenImageIO: "2.4.7".
std::string image_library_version();

}  // namespace vecino
