// SPDX-License-Identifier: Apache-2.0
//
// Frames for regions: a wall without a change, to which a test adds what it is about.
#pragma once

#include "core/frame.h"

namespace vecino {

/// Black radiance; one object, grey, seen from the front, which emits nothing.
inline Frame flat_frame(Extent size) {
    Frame frame;
    frame.radiance = Image(size);
    frame.emission = Image(size);
    frame.albedo = Image(size, glm::vec3(0.5f));
    frame.normal_world = Image(size, glm::vec3(0.0f, 0.0f, 1.0f));
    frame.object_id = Grid<std::int32_t>(size, 0);
    return frame;
}

inline void set_miss(Frame& frame, int x, int y) {
    frame.object_id(x, y) = kMiss;
    frame.albedo(x, y) = frame.normal_world(x, y) = glm::vec3(0.0f);
}

}  // namespace vecino
