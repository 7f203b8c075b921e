// SPDX-License-Identifier: Apache-2.0
//
// Parts of a render as EXR files. A sum has up to 16 channels of integers, Sum.NAME.I for digit I
// (core/exact_sum.h): a digit that is 0 in every pixel has none. First hits have the channels that
// images have. Attributes beside those of the render: "part_format", "samples" ("0:128"), "planes".
#pragma once

#include <string>

#include "core/image_io.h"
#include "core/part.h"

namespace vecino {

constexpr int kPartFormatVersion = 1;

/// Writes a part and attributes of the render that it belongs to, "spp" and "sampler" among them.
/// Throws as save_frame() does.
void save_part(const Part& part, const std::string& path, Metadata metadata);

/// What stands in front of a part's sums.
struct PartHeader {
    std::string path;
    Extent size;
    int spp = 0;  ///< of the whole render
    SampleInterval samples;
    Planes planes;
    VarianceOf variance_of = VarianceOf::nothing;
    Metadata metadata;  ///< all attributes of the file
};

/// Throws Error(file) if the file cannot be read, Error(mismatch) if it is no part, or one of
/// another version.
PartHeader load_part_header(const std::string& path);

/// Reads what a header stands in front of. Throws Error(file) if that is damaged.
Part load_part(const PartHeader& header);

}  // namespace vecino
