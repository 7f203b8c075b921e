// SPDX-License-Identifier: Apache-2.0

/// @file
/// A scene as its file says it: plain values, no acceleration structure. Lengths are in the scene's
/// own unit.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>
#include <vector>

#include "core/frame.h"

namespace vecino {

/// A pinhole camera. The aspect ratio is the image's.
struct Camera {
    glm::vec3 position_world{0.0f};              ///< where all rays start
    glm::vec3 look_at_world{0.0f, 0.0f, -1.0f};  ///< what the image's centre shows
    glm::vec3 up_world{0.0f, 1.0f, 0.0f};  ///< up in the image; not parallel to the view direction
    float vertical_fov_degrees = 45.0f;    ///< in (0, 180)
};

/// An image that surfaces wear. Its top row is at v = 1, its bottom row at v = 0; values are
/// interpolated between the centres of texels, and those at the border go on outwards.
struct Texture {
    std::string file;  ///< as it was opened
    Image texels;      ///< linear, in [0, 1]; at least one
};

/// A two-sided surface, diffuse or a mirror. An emitter shines on one side: the one its geometric
/// normal points to.
struct Material {
    std::string name;          ///< unique in its scene
    glm::vec3 albedo{0.0f};    ///< share of light reflected, in [0, 1]; without a texture
    glm::vec3 emission{0.0f};  ///< radiance, >= 0
    bool mirror = false;       ///< reflects as a perfect mirror does, else diffusely
    /// The albedo at each point of quads and of meshes with uvs. Null: the same everywhere.
    std::shared_ptr<const Texture> albedo_texture = nullptr;
};

/// The triangles 012 and 023, with uv (0, 0), (1, 0), (1, 1), (0, 1) at the corners: the image of a
/// texture has its lower left corner at p0, its lower right one at p1. Emits to (p1 - p0) x (p2 -
/// p0).
struct Quad {
    std::array<glm::vec3, 4> corners_world;  ///< in order around it; both triangles have an area
};

/// Emits outwards.
struct Sphere {
    glm::vec3 center_world{0.0f};  ///< the centre
    float radius = 1.0f;           ///< > 0
};

/// Triangles that share corners. A triangle abc emits to (b - a) x (c - a).
struct TriangleMesh {
    std::vector<glm::vec3> positions_world;  ///< corners
    std::vector<std::array<std::uint32_t, 3>>
        indices;  ///< into positions_world, one row a triangle
    std::vector<glm::vec3>
        normals_world;  ///< for shading, unit, one per position; empty: geometric normals
    std::vector<glm::vec2>
        uvs;  ///< where a texture's image lies, in [0, 1], one per position; empty: nowhere
};

/// A shape of a material. Its index in Scene::objects is what Frame::object_id holds.
struct Object {
    std::variant<Quad, Sphere, TriangleMesh> shape;  ///< where it is
    std::size_t material = 0;                        ///< index into Scene::materials
};

/// What a scene is made of.
enum class Pattern {
    none,         ///< objects seen by a camera
    xy_gradient,  ///< not 3D: radiance (u, v, 0) of the pixel centre, equation 1 of the thesis
};

/// What load_scene() returns and render() reads. It may be put together in memory too; then the
/// ranges given here are preconditions.
struct Scene {
    std::string name;                 ///< file name without directory and extension
    Pattern pattern = Pattern::none;  ///< unless none, all that follows plays no part
    Camera camera;                    ///< what it is seen by
    std::vector<Material> materials;  ///< in the order of their names
    std::vector<Object> objects;      ///< in the order of the file
    glm::vec3 background{0.0f};       ///< radiance of a miss, >= 0
};

/// Reads a scene file. Throws Error(file) if it cannot be read; Error(usage), naming file, JSON
/// pointer, what was found and what is allowed, for any content that is not a sound scene. Textures
/// are read with it, from paths relative to its directory; what is wrong with one is told in the
/// same way, with the code of load_image().
Scene load_scene(const std::string& path);

/// The same from a parsed document; file stands in errors, its stem is the scene's name, and its
/// directory that of textures.
Scene parse_scene(const nlohmann::json& document, const std::string& file);

/// The JSON Schema of scene files, from the tables that they are read by.
nlohmann::json scene_schema();

}  // namespace vecino
