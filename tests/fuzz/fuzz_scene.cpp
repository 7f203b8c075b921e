// SPDX-License-Identifier: Apache-2.0
//
// Reads any bytes as a scene; one that is accepted is what core/scene.h says, and can be traced.
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <string>
#include <variant>

#include "core/image_io.h"
#include "core/json_read.h"
#include "core/render.h"
#include "core/scene.h"
#include "tests/fuzz/contract.h"
#include "tests/temp_dir.h"

using namespace vecino;
using fuzz::require;

namespace {

bool in(const glm::vec3& v, float least, float most) {
    return std::min({v.x, v.y, v.z}) >= least && std::max({v.x, v.y, v.z}) <= most;
}

void check(const Quad& quad) {
    for (const glm::vec3& corner : quad.corners_world) require(is_finite(corner), "quad");
}

void check(const Sphere& sphere) {
    require(is_finite(sphere.center_world) && sphere.radius > 0.0f && std::isfinite(sphere.radius),
            "sphere");
}

void check(const TriangleMesh& mesh) {
    const std::size_t count = mesh.positions_world.size();
    for (const glm::vec3& position : mesh.positions_world) require(is_finite(position), "mesh");
    for (const auto& triangle : mesh.indices)
        for (const std::uint32_t corner : triangle) require(corner < count, "index of a mesh");
    require(mesh.normals_world.empty() || mesh.normals_world.size() == count, "normals of a mesh");
    require(mesh.uvs.empty() || mesh.uvs.size() == count, "uvs of a mesh");
    for (const glm::vec3& normal : mesh.normals_world)
        require(std::abs(glm::length(normal) - 1.0f) < 1e-3f, "normal of a mesh that is not unit");
}

std::size_t surfaces(const Scene& scene) {
    std::size_t count = 0;
    for (const Object& object : scene.objects) {
        const auto* const mesh = std::get_if<TriangleMesh>(&object.shape);
        count += mesh == nullptr ? 1 : mesh->indices.size();
    }
    return count;
}

void check(const Scene& scene) {
    require(in(scene.background, 0.0f, 1.0e30f), "background");
    for (const Material& material : scene.materials)
        require(in(material.albedo, 0.0f, 1.0f) && in(material.emission, 0.0f, 1.0e30f),
                "material");
    for (const Object& object : scene.objects) {
        require(object.material < scene.materials.size(), "material of an object");
        std::visit([](const auto& shape) { check(shape); }, object.shape);
    }
}

void check_render(const Scene& scene, Sampler sampler) {
    RenderSettings settings;
    settings.size = {3, 2};
    settings.spp = 4;
    settings.sampler = sampler;
    settings.threads = 1;
    Frame frame;
    if (!fuzz::gives_result([&] { frame = render(scene, settings).frame; })) return;
    for (const PlaneInfo& plane : all_planes()) {
        if (!Planes::all().has(plane.plane)) continue;
        const Extent size = std::visit([&](auto m) { return (frame.*m).size(); }, plane.member);
        require(size == settings.size, "size of plane " + std::string(plane.name));
    }
    for (const std::int32_t id : frame.object_id.values())
        require(
            id >= kMiss && id < static_cast<int>(std::max<std::size_t>(scene.objects.size(), 1)),
            "object id " + std::to_string(id));
}

/// In a folder with a texture, t.png.
std::string scene_path() {
    static const TempDir dir;
    Image texture({2, 2});
    texture(0, 0) = {1.0f, 0.5f, 0.0f};
    save_image(texture, dir.path("t.png"));
    return dir.path("a.json");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const std::string path = scene_path();
    const std::string text(reinterpret_cast<const char*>(data), size);
    Scene scene;
    const auto read = [&] { scene = parse_scene(parse_json_text(text, path), path); };
    if (!fuzz::gives_result(read)) return 0;
    check(scene);
    constexpr std::size_t kMostSurfaces = 200;
    if (surfaces(scene) > kMostSurfaces) return 0;
    check_render(scene, size % 2 == 0 ? Sampler::sobol : Sampler::independent);
    return 0;
}
