// SPDX-License-Identifier: Apache-2.0
#include "eval/loaded_frame.h"

#include "core/error.h"
#include "core/image_io.h"

namespace vecino {

LoadedFrame load_planes(const std::string& path) {
    try {
        return {load_frame(path), ""};
    } catch (const Error& error) {
        LoadedFrame loaded = load_radiance(path);
        loaded.no_planes = error.what();
        return loaded;
    }
}

LoadedFrame load_radiance(const std::string& path) {
    LoadedFrame loaded;
    loaded.frame.radiance = load_image(path);
    return loaded;
}

}  // namespace vecino
