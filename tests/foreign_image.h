// SPDX-License-Identifier: Apache-2.0
//
// Image files as other programs write them: any channels, any type.
#pragma once

#include <OpenImageIO/imageio.h>

#include <string>
#include <vector>

#include "core/grid.h"
#include "tests/catch.h"

namespace vecino {

inline OIIO::ImageSpec make_spec(Extent size, const std::vector<std::string>& channels,
                                 const OIIO::TypeDesc& type) {
    OIIO::ImageSpec spec(size.width, size.height, static_cast<int>(channels.size()), type);
    spec.channelnames = channels;
    return spec;
}

template <class Value>
void write_foreign(const std::string& path, const OIIO::ImageSpec& spec,
                   const std::vector<Value>& values) {
    REQUIRE(values.size() == spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
    const auto output = OIIO::ImageOutput::create(path);
    REQUIRE(output);
    REQUIRE(output->open(path, spec));
    REQUIRE(output->write_image(spec.format, values.data()));
    REQUIRE(output->close());
}

}  // namespace vecino
