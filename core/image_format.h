// SPDX-License-Identifier: Apache-2.0
//
// What image files can hold, and what of ours may go into them. Knows nothing of how files are read
// or written (core/image_io.cpp does), so that a command can refuse a name before it works for an
// hour.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/frame.h"
#include "core/planes.h"

namespace vecino {

/// Whole images are addressed with 32-bit numbers in more than one library.
constexpr long long kMaxPixels = std::numeric_limits<std::int32_t>::max();

/// An attribute that parts of a render have and images do not: the version of their format.
constexpr const char* kPartFormat = "part_format";

/// OpenImageIO may list a dozen faults, one a line, that follow from the first.
std::string first_fault(const std::string& text);

/// What a file keeps of a frame.
enum class Content {
    planes,  ///< all of it, as floats
    linear,  ///< radiance, as floats
    rgbe,  ///< radiance, as 8-bit mantissas and a shared exponent: neither NaN nor negative numbers
    encoded,  ///< radiance, clipped, sRGB-encoded, 8 bit
};

/// By the extension of a path. Throws an error of the given code if it is none that we can write.
Content content_of(const std::string& path, ExitCode code);

/// Empty, or what is wrong with the size of an image.
std::string size_fault(Extent size);

/// Throws Error(mismatch) if the image has no pixels or too many.
void require_pixels(Extent size, const std::string& path);

/// The planes that a frame holds. Throws Error(mismatch) if they do not share one size.
std::vector<const PlaneInfo*> planes_to_write(const Frame& frame, const std::string& path);

/// Throws Error(non_finite) naming the first pixel that is not a number.
void require_finite(const Image& image, const std::string& path);

/// A value that cannot stand in a plane, for an error.
struct BadValue {
    float value;
    std::size_t index;  ///< of the pixel
    int width;          ///< of the image
    std::string channel;
};
[[noreturn]] void fail(const BadValue& bad, const std::string& path, const std::string& allowed);

}  // namespace vecino
