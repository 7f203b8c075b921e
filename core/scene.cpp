// SPDX-License-Identifier: Apache-2.0
#include "core/scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <iterator>

#include "core/json_read.h"

namespace vecino {
namespace {

constexpr NumberRange kAlbedoRange{0.0, 1.0};
constexpr NumberRange kRadianceRange{0.0, 1.0e30};  // leaves room for sums

// A triangle whose area is lost in the rounding of its own coordinates has no normal.
bool has_area(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const glm::dvec3 ab = glm::dvec3(b) - glm::dvec3(a);
    const glm::dvec3 ac = glm::dvec3(c) - glm::dvec3(a);
    const double longest = std::max(glm::dot(ab, ab), glm::dot(ac, ac));
    return glm::length(glm::cross(ab, ac)) > 1e-7 * longest && longest > 1e-60;
}

Camera parse_camera(const JsonValue& json) {
    json.require_keys({"position", "look_at", "up", "vertical_fov_degrees"});
    Camera camera;
    camera.position_world = json.at("position").vec3();
    camera.look_at_world = json.at("look_at").vec3();
    camera.up_world = json.at("up").vec3();
    camera.vertical_fov_degrees = json.at("vertical_fov_degrees").real({0.001, 179.0});
    if (!has_area(glm::vec3(0.0f), camera.look_at_world - camera.position_world, camera.up_world)) {
        json.at("up").fail(
            "a direction that is not parallel to look_at - position, "
            "which are different points");
    }
    return camera;
}

Material parse_material(const std::string& name, const JsonValue& json) {
    json.require_keys({"albedo", "emission"});
    Material material{.name = name};
    if (json.has("albedo")) material.albedo = json.at("albedo").vec3(kAlbedoRange);
    if (json.has("emission")) material.emission = json.at("emission").vec3(kRadianceRange);
    return material;
}

Quad parse_quad(const JsonValue& json) {
    const auto corners = json.elements();
    if (corners.size() != 4) {
        json.fail(std::to_string(corners.size()) + " corners", "4 corners of 3 numbers");
    }
    Quad quad;
    std::ranges::transform(corners, quad.corners_world.begin(),
                           [](const JsonValue& corner) { return corner.vec3(); });
    const auto& p = quad.corners_world;
    if (!has_area(p[0], p[1], p[2]) || !has_area(p[0], p[2], p[3])) {
        json.fail("a zero-area shape", "corners 012 and 023 that span triangles");
    }
    return quad;
}

Sphere parse_sphere(const JsonValue& json) {
    json.require_keys({"center", "radius"});
    const JsonValue radius = json.at("radius");
    Sphere sphere{json.at("center").vec3(), radius.real()};
    if (!(sphere.radius > 0.0f)) radius.fail("a number above 0");
    return sphere;
}

std::array<std::uint32_t, 3> parse_triangle(const JsonValue& json,
                                            const std::vector<glm::vec3>& positions) {
    const auto corners = json.elements();
    if (corners.size() != 3) json.fail(std::to_string(corners.size()) + " indices", "3 indices");
    std::array<std::uint32_t, 3> triangle{};
    const int last = static_cast<int>(positions.size()) - 1;
    std::ranges::transform(corners, triangle.begin(), [&](const JsonValue& corner) {
        return static_cast<std::uint32_t>(corner.integer(0, last));
    });
    if (!has_area(positions[triangle[0]], positions[triangle[1]], positions[triangle[2]])) {
        json.fail("a zero-area shape", "three positions that span a triangle");
    }
    return triangle;
}

std::vector<glm::vec3> parse_points(const JsonValue& json) {
    std::vector<glm::vec3> points;
    for (const JsonValue& point : json.elements()) points.push_back(point.vec3());
    return points;
}

std::vector<glm::vec3> parse_normals(const JsonValue& json, std::size_t count) {
    std::vector<glm::vec3> normals;
    for (const JsonValue& element : json.elements()) {
        const glm::vec3 normal = element.vec3();
        const float length = glm::length(normal);
        if (!(length > 0.0f) || !std::isfinite(length))
            element.fail("a direction of length above 0");
        normals.push_back(normal / length);
    }
    if (normals.size() != count) {
        json.fail(std::to_string(normals.size()) + " normals",
                  "as many as positions (" + std::to_string(count) + ")");
    }
    return normals;
}

TriangleMesh parse_mesh(const JsonValue& json) {
    json.require_keys({"positions", "indices", "normals"});
    TriangleMesh mesh;
    mesh.positions_world = parse_points(json.at("positions"));
    if (mesh.positions_world.empty()) json.at("positions").fail("at least 3 positions");
    for (const JsonValue& triangle : json.at("indices").elements()) {
        mesh.indices.push_back(parse_triangle(triangle, mesh.positions_world));
    }
    if (mesh.indices.empty()) json.at("indices").fail("at least 1 triangle");
    if (json.has("normals")) {
        mesh.normals_world = parse_normals(json.at("normals"), mesh.positions_world.size());
    }
    return mesh;
}

// The shapes a scene may hold: one row each.
struct ShapeKey {
    std::string_view key;
    void (*parse)(const JsonValue&, Object&);
};
constexpr ShapeKey kShapes[] = {
    {"quad", [](const JsonValue& json, Object& object) { object.shape = parse_quad(json); }},
    {"sphere", [](const JsonValue& json, Object& object) { object.shape = parse_sphere(json); }},
    {"triangles", [](const JsonValue& json, Object& object) { object.shape = parse_mesh(json); }},
};

std::size_t parse_material_name(const JsonValue& json, const std::vector<Material>& materials) {
    const auto row = std::ranges::find(materials, json.string(), &Material::name);
    if (row != materials.end()) return static_cast<std::size_t>(row - materials.begin());
    std::vector<std::string_view> names;
    for (const Material& material : materials) names.push_back(material.name);
    json.fail("one of the scene's materials: " + join(names));
}

Object parse_object(const JsonValue& json, const std::vector<Material>& materials) {
    std::vector<std::string_view> keys;
    std::ranges::transform(kShapes, std::back_inserter(keys), &ShapeKey::key);
    const std::string shapes = join(keys);
    keys.push_back("material");
    json.require_keys(keys);
    Object object;
    int found = 0;
    for (const ShapeKey& row : kShapes) {
        if (!json.has(row.key)) continue;
        row.parse(json.at(row.key), object);
        ++found;
    }
    if (found != 1) json.fail(std::to_string(found) + " shapes", "exactly one of " + shapes);
    object.material = parse_material_name(json.at("material"), materials);
    return object;
}

Scene parse_pattern(const JsonValue& json, Scene scene) {
    json.require_keys({"pattern"});
    if (json.at("pattern").string() != "xy_gradient") json.at("pattern").fail("\"xy_gradient\"");
    scene.pattern = Pattern::xy_gradient;
    return scene;
}

}  // namespace

Scene parse_scene(const nlohmann::json& document, const std::string& file) {
    const JsonValue json(document, file);
    Scene scene;
    scene.name = std::filesystem::path(file).stem().string();
    if (document.is_object() && json.has("pattern")) return parse_pattern(json, std::move(scene));
    json.require_keys({"camera", "materials", "objects", "background"});
    scene.camera = parse_camera(json.at("camera"));
    for (const auto& [name, material] : json.at("materials").members()) {
        scene.materials.push_back(parse_material(name, material));
    }
    for (const JsonValue& object : json.at("objects").elements()) {
        scene.objects.push_back(parse_object(object, scene.materials));
    }
    if (json.has("background")) scene.background = json.at("background").vec3(kRadianceRange);
    return scene;
}

Scene load_scene(const std::string& path) {
    return parse_scene(parse_json_file(path), path);
}

}  // namespace vecino
