// SPDX-License-Identifier: Apache-2.0
//
// A scene as its file says it: plain values, no acceleration structure. Lengths are in the scene's
// own unit.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>
#include <vector>

namespace vecino {

/// A pinhole camera. The aspect ratio is the image's.
struct Camera {
    glm::vec3 position_world{0.0f};
    glm::vec3 look_at_world{0.0f, 0.0f, -1.0f};
    glm::vec3 up_world{0.0f, 1.0f, 0.0f};
    float vertical_fov_degrees = 45.0f;  ///< in (0, 180)
};

/// A two-sided diffuse surface. An emitter shines on one side: the one its geometric normal points
/// to.
struct Material {
    std::string name;
    glm::vec3 albedo{0.0f};    ///< in [0, 1]
    glm::vec3 emission{0.0f};  ///< radiance, >= 0
};

/// The triangles 012 and 023. Emits to (p1 - p0) x (p2 - p0).
struct Quad {
    std::array<glm::vec3, 4> corners_world;
};

/// Emits outwards.
struct Sphere {
    glm::vec3 center_world{0.0f};
    float radius = 1.0f;
};

struct TriangleMesh {
    std::vector<glm::vec3> positions_world;
    std::vector<std::array<std::uint32_t, 3>> indices;
    std::vector<glm::vec3>
        normals_world;  ///< for shading, unit, one per position; empty: geometric normals
};

struct Object {
    std::variant<Quad, Sphere, TriangleMesh> shape;
    std::size_t material = 0;  ///< index into Scene::materials
};

/// A scene that is not 3D: radiance (u, v, 0) of the pixel centre (Eq. 1 of the thesis).
enum class Pattern { none, xy_gradient };

struct Scene {
    std::string name;  ///< file name without directory and extension
    Pattern pattern = Pattern::none;
    Camera camera;
    std::vector<Material> materials;
    std::vector<Object> objects;
    glm::vec3 background{0.0f};  ///< radiance of a miss, >= 0
};

/// Reads a scene file. Throws Error(file) if it cannot be read; Error(usage), naming file, JSON
/// pointer, what was found and what is allowed, for any content that is not a sound scene.
Scene load_scene(const std::string& path);

/// The same from a parsed document; file stands in errors.
Scene parse_scene(const nlohmann::json& document, const std::string& file);

}  // namespace vecino
