// SPDX-License-Identifier: Apache-2.0
#include "core/frame_planes.h"

#include "core/memory.h"

namespace vecino {
namespace {

void set(Image& plane, Pixel at, const glm::vec3& value) {
    if (!plane.empty()) plane(at.x, at.y) = value;
}

}  // namespace

Planes common(Planes a, Planes b) {
    Planes both;
    for (const PlaneInfo& info : all_planes()) {
        if (a.has(info.plane) && b.has(info.plane)) both.add(info.plane);
    }
    return both;
}

Frame make_frame(Extent size, Planes planes) {
    require_memory(bytes_of(planes, size), "frame of " + size_text(size));
    Frame frame;
    for (const PlaneInfo& info : all_planes()) {
        if (!planes.has(info.plane)) continue;
        std::visit([&]<class T>(Grid<T> Frame::*member) { frame.*member = Grid<T>(size); },
                   info.member);
    }
    return frame;
}

void store_values(const PixelValues& values, Pixel at, Frame& frame) {
    set(frame.radiance, at, values.radiance());
    set(frame.emission, at, values.emission);
    set(frame.direct, at, values.direct);
    set(frame.indirect, at, values.indirect);
    set(frame.variance, at, values.variance);
    if (!frame.sample_count.empty()) {
        frame.sample_count(at.x, at.y) = static_cast<float>(values.samples);
    }
}

void store_means(const GuideSums& sums, int samples, Pixel at, Frame& frame) {
    const auto mean = [&](const float(&v)[3]) {
        return glm::vec3(v[0], v[1], v[2]) / static_cast<float>(samples);
    };
    set(frame.albedo_mean, at, mean(sums.albedo));
    set(frame.normal_world_mean, at, mean(sums.normal_world));
}

void store_first_hit(const FirstHitRecord& hit, Pixel at, Frame& frame) {
    const auto vector = [](const float(&v)[3]) { return glm::vec3(v[0], v[1], v[2]); };
    set(frame.position_world, at, vector(hit.position_world));
    set(frame.normal_world, at, vector(hit.normal_world));
    set(frame.albedo, at, vector(hit.albedo));
    if (!frame.distance_world.empty()) frame.distance_world(at.x, at.y) = hit.distance_world;
    if (!frame.object_id.empty()) frame.object_id(at.x, at.y) = hit.object_id;
}

void fill_pattern(Frame& frame, Extent size) {
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            const glm::vec3 uv((static_cast<float>(x) + 0.5f) / static_cast<float>(size.width),
                               (static_cast<float>(y) + 0.5f) / static_cast<float>(size.height),
                               0.0f);
            PixelValues values;
            values.emission = uv;
            values.samples = 1;
            store_values(values, {x, y}, frame);
            FirstHitRecord hit{};
            hit.position_world[0] = uv.x;
            hit.position_world[1] = uv.y;
            hit.normal_world[2] = 1.0f;
            store_first_hit(hit, {x, y}, frame);
            store_means({{0, 0, 0}, {0, 0, 1}}, 1, {x, y}, frame);
        }
    }
}

}  // namespace vecino
