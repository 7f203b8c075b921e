// SPDX-License-Identifier: Apache-2.0
//
// Images and frames whose every value is unlike its neighbours', so that a swap or an offset shows.
#pragma once

#include <cstddef>

#include "core/planes.h"

namespace vecino {

/// Positive, not all below 1, no two channels or pixels alike.
inline Image make_image(Extent size, float scale = 0.01f) {
    Image image(size);
    for (std::size_t i = 0; i < image.values().size(); ++i) {
        const auto x = static_cast<float>(i) + 0.1f;
        image.values()[i] = scale * glm::vec3(x, x + 0.3f, x + 0.6f);
    }
    return image;
}

inline void set_value(glm::vec3& value, float x) {
    value = {x, -x, x + 0.5f};
}
inline void set_value(float& value, float x) {
    value = x;
}
inline void set_value(std::int32_t& value, float x) {
    value = static_cast<std::int32_t>(x) - 1;
}

/// Radiance as make_image(), each other plane with values of its own.
inline Frame make_frame(Extent size, Planes planes) {
    Frame frame;
    float scale = 0.0f;
    for (const PlaneInfo& info : all_planes()) {
        scale += 1.0f;
        if (!planes.has(info.plane)) continue;
        const auto fill = [&](auto member) {
            auto& plane = frame.*member;
            plane = std::remove_reference_t<decltype(plane)>(size);
            float x = 0.0f;
            for (auto& value : plane.values()) set_value(value, scale * x++);
        };
        std::visit(fill, info.member);
    }
    frame.radiance = make_image(size);
    return frame;
}

}  // namespace vecino
