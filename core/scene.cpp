// SPDX-License-Identifier: Apache-2.0
#include "core/scene.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <iterator>
#include <limits>
#include <utility>

#include "core/json_schema.h"
#include "core/texture.h"

namespace vecino {
namespace {

using enum Presence;

constexpr Vec3Kind kPoint{};
constexpr Vec3Kind kAlbedo{{0.0, 1.0}};
constexpr Vec3Kind kRadiance{{0.0, 1.0e30}};  // leaves room for sums
constexpr RealKind kFieldOfView{{0.001, 179.0}};
constexpr IntegerKind kIndex{0, std::numeric_limits<int>::max()};
constexpr TextKind kText{};
constexpr BooleanKind kBoolean{};
constexpr RealKind kUnit{{0.0, 1.0}};
constexpr Named<Pattern> kPatternNames[] = {{"xy_gradient", Pattern::xy_gradient}};
constexpr ChoiceKind kPattern{kPatternNames};

// A triangle whose area is lost in the rounding of its own coordinates has no normal.
bool has_area(glm::vec3 a, glm::vec3 b, glm::vec3 c) {
    const glm::dvec3 ab = glm::dvec3(b) - glm::dvec3(a);
    const glm::dvec3 ac = glm::dvec3(c) - glm::dvec3(a);
    const double longest = std::max(glm::dot(ab, ab), glm::dot(ac, ac));
    return glm::length(glm::cross(ab, ac)) > 1e-7 * longest && longest > 1e-60;
}

constexpr JsonKey<Camera> kCameraKeys[] = {
    member_key<kPoint, &Camera::position_world>("position", required, "where the camera stands"),
    member_key<kPoint, &Camera::look_at_world>("look_at", required,
                                               "the point in the middle of the image"),
    member_key<kPoint, &Camera::up_world>("up", required, "a direction that is up in the image"),
    member_key<kFieldOfView, &Camera::vertical_fov_degrees>("vertical_fov_degrees", required,
                                                            "from bottom to top of the image"),
};

Camera parse_camera(const JsonValue& json) {
    Camera camera;
    read_object(json, kCameraKeys, camera);
    if (!has_area(glm::vec3(0.0f), camera.look_at_world - camera.position_world, camera.up_world)) {
        json.at("up").fail(
            "a direction that is not parallel to look_at - position, "
            "which are different points");
    }
    return camera;
}

constexpr JsonKey<Material> kMaterialKeys[] = {
    member_key<kAlbedo, &Material::albedo>(
        "albedo", optional, "share of light reflected; default 0, of a mirror without texture 1"),
    // Loaded once the others are read: materials share it.
    {"albedo_texture", optional,
     "an image instead of albedo, its path relative to the scene file; 8 and 16 bit are sRGB, "
     "floating-point values linear",
     [](Material&, const JsonValue& json) { (void)json.string(); }, schema_of<kText>},
    member_key<kRadiance, &Material::emission>("emission", optional,
                                               "radiance sent out, on one side"),
    member_key<kBoolean, &Material::mirror>(
        "mirror", optional,
        "a perfect mirror instead of a diffuse surface; first hits are its own"),
};

/// The texture of an earlier material that names the same file, or a new one.
std::shared_ptr<const Texture> texture_of(const JsonValue& json,
                                          const std::vector<Material>& materials) {
    const std::string file = texture_file(json);
    for (const Material& other : materials) {
        if (other.albedo_texture != nullptr && other.albedo_texture->file == file)
            return other.albedo_texture;
    }
    return load_texture(file, json);
}

Material parse_material(const std::string& name, const JsonValue& json,
                        const std::vector<Material>& materials) {
    Material material{.name = name};
    read_object(json, kMaterialKeys, material);
    const bool has_albedo = json.has("albedo");
    if (json.has("albedo_texture")) {
        if (has_albedo) json.fail("both albedo and albedo_texture", "one of them");
        material.albedo_texture = texture_of(json.at("albedo_texture"), materials);
    } else if (material.mirror && !has_albedo) {
        material.albedo = glm::vec3(1.0f);
    }
    return material;
}

void read_quad(Object& object, const JsonValue& json) {
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
    object.shape = quad;
}

void read_radius(Sphere& sphere, const JsonValue& json) {
    sphere.radius = json.real();
    if (!(sphere.radius > 0.0f)) json.fail("a number above 0");
}

constexpr JsonKey<Sphere> kSphereKeys[] = {
    member_key<kPoint, &Sphere::center_world>("center", required, ""),
    {"radius", required, "", read_radius,
     [] {
         return nlohmann::json{{"type", "number"}, {"exclusiveMinimum", 0}};
     }},
};

std::array<std::uint32_t, 3> parse_triangle(const JsonValue& json,
                                            const std::vector<glm::vec3>& positions) {
    const auto corners = json.elements();
    if (corners.size() != 3) json.fail(std::to_string(corners.size()) + " indices", "3 indices");
    std::array<std::uint32_t, 3> triangle{};
    const int last = static_cast<int>(positions.size()) - 1;
    std::ranges::transform(corners, triangle.begin(), [&](const JsonValue& corner) {
        return static_cast<std::uint32_t>(corner.integer(kIndex.least, last));
    });
    if (!has_area(positions[triangle[0]], positions[triangle[1]], positions[triangle[2]])) {
        json.fail("a zero-area shape", "three positions that span a triangle");
    }
    return triangle;
}

void read_positions(TriangleMesh& mesh, const JsonValue& json) {
    for (const JsonValue& point : json.elements()) mesh.positions_world.push_back(point.vec3());
    if (mesh.positions_world.size() < 3) json.fail("at least 3 positions");
}

void read_indices(TriangleMesh& mesh, const JsonValue& json) {
    for (const JsonValue& triangle : json.elements()) {
        mesh.indices.push_back(parse_triangle(triangle, mesh.positions_world));
    }
    if (mesh.indices.empty()) json.fail("at least 1 triangle");
}

void read_normals(TriangleMesh& mesh, const JsonValue& json) {
    for (const JsonValue& element : json.elements()) {
        const glm::vec3 normal = element.vec3();
        const float length = glm::length(normal);
        if (!(length > 0.0f) || !std::isfinite(length))
            element.fail("a direction of length above 0");
        mesh.normals_world.push_back(normal / length);
    }
    const std::size_t count = mesh.positions_world.size();
    if (mesh.normals_world.size() != count) {
        json.fail(std::to_string(mesh.normals_world.size()) + " normals",
                  "as many as positions (" + std::to_string(count) + ")");
    }
}

glm::vec2 parse_uv(const JsonValue& json) {
    const auto numbers = json.elements();
    if (numbers.size() != 2) json.fail(std::to_string(numbers.size()) + " elements", "2 numbers");
    return {kUnit.read(numbers[0]), kUnit.read(numbers[1])};
}

void read_uvs(TriangleMesh& mesh, const JsonValue& json) {
    for (const JsonValue& uv : json.elements()) mesh.uvs.push_back(parse_uv(uv));
    const std::size_t count = mesh.positions_world.size();
    if (mesh.uvs.size() != count) {
        json.fail(std::to_string(mesh.uvs.size()) + " uvs",
                  "as many as positions (" + std::to_string(count) + ")");
    }
}

// In this order: triangles are checked against the positions, normals and uvs counted.
constexpr JsonKey<TriangleMesh> kMeshKeys[] = {
    {"positions", required, "of the corners", read_positions,
     [] {
         return array_schema(kPoint.schema(), {3, 0});
     }},
    {"indices", required, "the positions of each triangle's corners, from 0", read_indices,
     [] {
         return array_schema(array_schema(kIndex.schema(), {3, 3}), {1, 0});
     }},
    {"normals", optional, "for shading, one for each position", read_normals,
     [] {
         return array_schema(kPoint.schema(), {3, 0});
     }},
    {"uvs", optional,
     "where a texture's image lies, one for each position: (0, 0) is its lower left corner, "
     "(1, 1) its upper right one",
     read_uvs,
     [] {
         return array_schema(array_schema(kUnit.schema(), {2, 2}), {3, 0});
     }},
};

/// Reads an object of these keys as the shape.
template <class Shape, const auto& kKeys>
void read_shape(Object& object, const JsonValue& json) {
    Shape shape;
    read_object(json, kKeys, shape);
    object.shape = std::move(shape);
}

// The shapes an object may have: exactly one of them.
constexpr JsonKey<Object> kShapes[] = {
    {"quad", optional, "corners of two triangles, 012 and 023", read_quad,
     [] {
         return array_schema(kPoint.schema(), {4, 4});
     }},
    {"sphere", optional, "", read_shape<Sphere, kSphereKeys>,
     [] { return object_schema(kSphereKeys); }},
    {"triangles", optional, "a mesh", read_shape<TriangleMesh, kMeshKeys>,
     [] { return object_schema(kMeshKeys); }},
};

std::size_t parse_material_name(const JsonValue& json, const std::vector<Material>& materials) {
    const auto row = std::ranges::find(materials, json.string(), &Material::name);
    if (row != materials.end()) return static_cast<std::size_t>(row - materials.begin());
    std::vector<std::string_view> names;
    for (const Material& material : materials) names.push_back(material.name);
    json.fail("one of the scene's materials: " + join(names));
}

/// A texture needs to know where its image lies.
void require_uvs(const Object& object, const JsonValue& json) {
    if (std::holds_alternative<Sphere>(object.shape)) {
        json.at("sphere").fail("a sphere of a material with albedo_texture",
                               "a quad, or triangles with uvs");
    }
    const auto* const mesh = std::get_if<TriangleMesh>(&object.shape);
    if (mesh != nullptr && mesh->uvs.empty()) {
        json.at("triangles").fail("no key \"uvs\"", "uvs, since the material has albedo_texture");
    }
}

Object parse_object(const JsonValue& json, const std::vector<Material>& materials) {
    std::vector<std::string_view> keys;
    std::ranges::transform(kShapes, std::back_inserter(keys), &JsonKey<Object>::name);
    const std::string shapes = join(keys);
    keys.push_back("material");
    json.require_keys(keys);
    Object object;
    int found = 0;
    for (const JsonKey<Object>& shape : kShapes) {
        if (!json.has(shape.name)) continue;
        shape.read(object, json.at(shape.name));
        ++found;
    }
    if (found != 1) json.fail(std::to_string(found) + " shapes", "exactly one of " + shapes);
    object.material = parse_material_name(json.at("material"), materials);
    if (materials[object.material].albedo_texture != nullptr) require_uvs(object, json);
    return object;
}

nlohmann::json one_object_schema() {
    nlohmann::json schema = object_schema(kShapes);
    schema["properties"]["material"] = {{"type", "string"},
                                        {"description", "the name of one of the materials"}};
    schema["required"] = {"material"};
    for (const JsonKey<Object>& shape : kShapes) {
        schema["oneOf"].push_back({{"required", {shape.name}}});
    }
    return schema;
}

void read_materials(Scene& scene, const JsonValue& json) {
    for (const auto& [name, material] : json.members()) {
        scene.materials.push_back(parse_material(name, material, scene.materials));
    }
}

nlohmann::json materials_schema() {
    nlohmann::json material = object_schema(kMaterialKeys);
    material["not"] = {{"required", {"albedo", "albedo_texture"}}};
    return {{"type", "object"}, {"additionalProperties", material}};
}

void read_objects(Scene& scene, const JsonValue& json) {
    for (const JsonValue& object : json.elements()) {
        scene.objects.push_back(parse_object(object, scene.materials));
    }
}

constexpr JsonKey<Scene> kSchemaKey{"$schema", optional, "the JSON Schema of scenes, for editors",
                                    [](Scene&, const JsonValue& json) { (void)json.string(); },
                                    schema_of<kText>};

// In this order: objects name materials.
constexpr JsonKey<Scene> kSceneKeys[] = {
    kSchemaKey,
    {"camera", required, "a pinhole camera",
     [](Scene& scene, const JsonValue& json) { scene.camera = parse_camera(json); },
     [] { return object_schema(kCameraKeys); }},
    {"materials", required, "by name", read_materials, materials_schema},
    {"objects", required,
     "what there is to see; of up to 2048 parallelograms, emitters hide what else lies in their "
     "plane, and of others those that stand later here the earlier ones",
     read_objects,
     [] {
         return array_schema(one_object_schema(), {0, 0});
     }},
    member_key<kRadiance, &Scene::background>("background", optional,
                                              "radiance where a ray hits nothing"),
};

constexpr JsonKey<Scene> kPatternKeys[] = {
    kSchemaKey,
    member_key<kPattern, &Scene::pattern>("pattern", required, "a picture that is not 3D"),
};

}  // namespace

Scene parse_scene(const nlohmann::json& document, const std::string& file) {
    const JsonValue json(document, file);
    Scene scene;
    scene.name = std::filesystem::path(file).stem().string();
    if (json.has("pattern")) {
        read_object(json, kPatternKeys, scene);
    } else {
        read_object(json, kSceneKeys, scene);
    }
    return scene;
}

Scene load_scene(const std::string& path) {
    return parse_scene(parse_json_file(path), path);
}

nlohmann::json scene_schema() {
    return document_schema("A scene of vecino", {{"if", {{"required", {"pattern"}}}},
                                                 {"then", object_schema(kPatternKeys)},
                                                 {"else", object_schema(kSceneKeys)}});
}

}  // namespace vecino
