// SPDX-License-Identifier: Apache-2.0
//
// Guides of simple scenes, seen from afar along -z, and low-res frames of light on them.
#pragma once

#include <functional>

#include "core/frame.h"
#include "filters/schemes.h"

namespace vecino {

/// The plane z = 0 from (0, 0) to (1, 1), facing the camera, of id 0 and albedo 1.
inline Frame flat_guide(Extent size) {
    Frame guide;
    guide.position_world = Grid<glm::vec3>(size);
    guide.normal_world = Grid<glm::vec3>(size, {0, 0, 1});
    guide.albedo = Image(size, glm::vec3(1.0f));
    guide.emission = Image(size);
    guide.object_id = Grid<std::int32_t>(size, 0);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            guide.position_world(x, y) = {
                (static_cast<float>(x) + 0.5f) / static_cast<float>(size.width),
                (static_cast<float>(y) + 0.5f) / static_cast<float>(size.height), 0};
        }
    }
    return guide;
}

using Field = std::function<glm::vec3(float u, float v)>;

/// Values at the centres of pixels.
inline Image sampled(Extent size, const Field& field) {
    Image image(size);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            image(x, y) = field((static_cast<float>(x) + 0.5f) / static_cast<float>(size.width),
                                (static_cast<float>(y) + 0.5f) / static_cast<float>(size.height));
        }
    }
    return image;
}

/// Means over the area of low-res pixels. Precondition: the size is a multiple of the low one.
inline Image averaged(const Image& image, Extent low) {
    Image result(low);
    const int fx = image.size().width / low.width;
    const int fy = image.size().height / low.height;
    for (int y = 0; y < image.size().height; ++y) {
        for (int x = 0; x < image.size().width; ++x)
            result(x / fx, y / fy) += image(x, y) / static_cast<float>(fx * fy);
    }
    return result;
}

/// emission + albedo * irradiance, pixel by pixel.
inline Image lit(const Frame& guide, const Image& irradiance) {
    Image image = irradiance;
    for (std::size_t i = 0; i < image.values().size(); ++i) {
        image.values()[i] =
            guide.emission.values()[i] + guide.albedo.values()[i] * irradiance.values()[i];
    }
    return image;
}

inline Frame frame_of(Image radiance) {
    Frame frame;
    frame.radiance = std::move(radiance);
    return frame;
}

inline double largest_difference(const Image& a, const Image& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.values().size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const float difference = std::abs(a.values()[i][c] - b.values()[i][c]);
            largest = std::max(largest, static_cast<double>(difference));
        }
    }
    return largest;
}

}  // namespace vecino
