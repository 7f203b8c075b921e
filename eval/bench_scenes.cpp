// SPDX-License-Identifier: Apache-2.0
#include "eval/bench_scenes.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/json_read.h"
#include "eval/bench.h"

namespace vecino {
namespace {

/// A ball of 2 x 64 x 128 triangles with smooth normals.
TriangleMesh tessellate(const Sphere& sphere) {
    constexpr std::uint32_t kRings = 65;
    constexpr std::uint32_t kSegments = 128;
    TriangleMesh mesh;
    for (std::uint32_t i = 0; i <= kRings; ++i) {
        for (std::uint32_t k = 0; k < kSegments; ++k) {
            const float polar = std::numbers::pi_v<float> * static_cast<float>(i) / kRings;
            const float azimuth = 2 * std::numbers::pi_v<float> * static_cast<float>(k) / kSegments;
            const glm::vec3 normal(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                                   std::sin(polar) * std::sin(azimuth));
            mesh.normals_world.push_back(normal);
            mesh.positions_world.push_back(sphere.center_world + sphere.radius * normal);
        }
    }
    for (std::uint32_t i = 0; i < kRings; ++i) {
        for (std::uint32_t k = 0; k < kSegments; ++k) {
            const std::uint32_t a = i * kSegments + k;
            const std::uint32_t b = i * kSegments + (k + 1) % kSegments;
            // At a pole one of the two would have no area.
            if (i > 0) mesh.indices.push_back({a, b, a + kSegments});
            if (i + 1 < kRings) mesh.indices.push_back({b, b + kSegments, a + kSegments});
        }
    }
    return mesh;
}

Scene parse(std::string_view json, const std::string& name) {
    return parse_scene(parse_json_text(std::string(json), name), name);
}

Scene cornell_mesh() {
    Scene scene = parse(kCornellSphereJson, "cornell_mesh");
    for (Object& object : scene.objects) {
        if (const auto* const sphere = std::get_if<Sphere>(&object.shape)) {
            object.shape = tessellate(*sphere);
        }
    }
    return scene;
}

struct Entry {
    std::string_view name;
    Scene (*make)();
};

constexpr Entry kScenes[] = {
    {"cornell", [] { return parse(kCornellJson, "cornell"); }},
    {"cornell_sphere", [] { return parse(kCornellSphereJson, "cornell_sphere"); }},
    {"cornell_mesh", cornell_mesh},
    {"hard_shadows", [] { return parse(kHardShadowsJson, "hard_shadows"); }},
    {"checker_spheres", [] { return parse(kCheckerSpheresJson, "checker_spheres"); }},
};

}  // namespace

std::vector<std::string> bench_scene_names() {
    std::vector<std::string> names;
    std::ranges::transform(kScenes, std::back_inserter(names),
                           [](const Entry& entry) { return std::string(entry.name); });
    return names;
}

BenchScene bench_scene(const std::string& name_or_path) {
    const auto* const entry = std::ranges::find(kScenes, name_or_path, &Entry::name);
    if (entry != std::end(kScenes)) return {name_or_path, entry->make()};
    Scene scene = load_scene(name_or_path);
    return {scene.name, std::move(scene)};
}

}  // namespace vecino
