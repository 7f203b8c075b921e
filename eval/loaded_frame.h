// SPDX-License-Identifier: Apache-2.0
//
// Images of any program, with the planes that they have in our names.
#pragma once

#include <string>

#include "core/frame.h"

namespace vecino {

struct LoadedFrame {
    Frame frame;            ///< radiance at least
    std::string no_planes;  ///< why its planes could not be read; empty: they were, as far as
                            ///< there are any
};

/// Other programs' planes may not be what ours are: then radiance alone is loaded. Throws as
/// load_image() does.
LoadedFrame load_planes(const std::string& path);

/// The same without planes.
LoadedFrame load_radiance(const std::string& path);

}  // namespace vecino
