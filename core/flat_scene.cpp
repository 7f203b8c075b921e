// SPDX-License-Identifier: Apache-2.0
#include "core/flat_scene.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <numeric>
#include <optional>

#include "core/color.h"
#include "core/embree_geometry.h"
#include "core/texture.h"

namespace vecino {
namespace {

// A hit is put back onto its surface, so it is off by a few units in the last place of the
// coordinates; 2^-17 of the largest one is some 64 of them. Relative, so that the unit of length
// does not matter.
constexpr float kOffsetShare = 0x1p-17f;

void put(float* to, const glm::vec3& from) {
    to[0] = from.x;
    to[1] = from.y;
    to[2] = from.z;
}

float largest(const glm::vec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

bool is_perpendicular(glm::vec3 a, glm::vec3 b) {
    return std::abs(glm::dot(a, b)) <= 1e-6f * glm::length(a) * glm::length(b);
}

/// Unit. In double: that of a thin or tiny triangle keeps its digits.
glm::dvec3 normal_of(glm::dvec3 a, glm::dvec3 b, glm::dvec3 c) {
    return glm::normalize(glm::cross(b - a, c - a));
}

/// To the rounding of its coordinates.
bool is_parallelogram(const Quad& quad) {
    const auto& p = quad.corners_world;
    const float reach = std::max({largest(p[0]), largest(p[1]), largest(p[2]), largest(p[3])});
    return largest((p[0] + p[2]) - (p[1] + p[3])) <= 0x1p-21f * reach;
}

bool emits(const Material& material) {
    return material.emission != glm::vec3(0.0f);
}

struct Triangle {
    std::array<glm::vec3, 3> corners;
    std::array<glm::vec3, 3> normals{};  ///< zero: use the geometric one
    std::array<glm::vec2, 3> uvs{};
};

// Of the two halves of a quad.
constexpr std::array<glm::vec2, 3> kUvs012{{{0, 0}, {1, 0}, {1, 1}}};
constexpr std::array<glm::vec2, 3> kUvs023{{{0, 0}, {1, 1}, {0, 1}}};

struct Surface {
    float fields[kSurfaceFields];
    std::int32_t object_id;
};

/// Surfaces of one kind, and their shapes as Embree takes them.
template <class Shape>
struct Surfaces {
    std::vector<Surface> list;
    std::vector<Shape> shapes;
};

class Flattener {
  public:
    explicit Flattener(const Scene& scene) : scene_(scene) {}

    FlatScene run() {
        for (std::size_t i = 0; i < scene_.objects.size(); ++i) add_object(i);
        if (!has_normals_) flat_.vertex_normals.clear();
        put_emitters_last();
        fill_table();
        set_selection_probabilities();
        flat_.light_tree = build_light_tree(flat_.lights);
        flat_.embree = std::make_unique<EmbreeScene>(EmbreeGeometry{
            quads_.shapes.data(), quads_.list.size(), triangles_.shapes.data(),
            triangles_.list.size(), spheres_.shapes.data(), spheres_.list.size(), has_mesh_});
        return std::move(flat_);
    }

  private:
    void add_object(std::size_t index) {
        object_id_ = static_cast<std::int32_t>(index);
        material_ = &scene_.materials[scene_.objects[index].material];
        std::visit([this](const auto& shape) { add(shape); }, scene_.objects[index].shape);
    }

    // Of parallelograms in one place the last is hit. A lamp that lies in a wall's plane is there
    // for rays as it is for next-event estimation, wherever the file names it.
    void put_emitters_last() {
        std::vector<std::size_t> order(quads_.list.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::stable_partition(order.begin(), order.end(), [&](std::size_t i) {
            return std::bit_cast<std::int32_t>(quads_.list[i].fields[kLight]) < 0;
        });
        Surfaces<std::array<glm::vec3, 4>> sorted;
        for (const std::size_t i : order) {
            sorted.list.push_back(quads_.list[i]);
            sorted.shapes.push_back(quads_.shapes[i]);
        }
        quads_ = std::move(sorted);
    }

    // Columns in the order of EmbreeKind.
    void fill_table() {
        constexpr std::size_t kPadding = 32;
        const std::vector<Surface>* const kinds[] = {&quads_.list, &triangles_.list,
                                                     &spheres_.list};
        std::size_t count = 0;
        for (const auto* kind : kinds) count += kind->size();
        const std::size_t stride = (count + kPadding) / kPadding * kPadding;
        flat_.first_triangle = static_cast<std::uint32_t>(quads_.list.size());
        flat_.first_sphere = static_cast<std::uint32_t>(count - spheres_.list.size());
        flat_.surface_stride = static_cast<std::uint32_t>(stride);
        flat_.surface_fields.assign(stride * kSurfaceFields, 0.0f);
        for (const auto* kind : kinds) {
            for (const Surface& surface : *kind) {
                const std::size_t column = flat_.object_id.size();
                flat_.object_id.push_back(surface.object_id);
                for (std::size_t k = 0; k < kSurfaceFields; ++k)
                    flat_.surface_fields[k * stride + column] = surface.fields[k];
            }
        }
    }

    void add(const Quad& quad) {
        const auto& p = quad.corners_world;
        if (is_parallelogram(quad)) {
            quads_.list.push_back(flat_surface({{p[0], p[1], p[2]}, {}, kUvs012}, largest(p[3])));
            quads_.shapes.push_back(p);
        } else {
            add_triangle({{p[0], p[1], p[2]}, {}, kUvs012});
            add_triangle({{p[0], p[2], p[3]}, {}, kUvs023});
        }
        if (!emits(*material_)) return;
        if (is_parallelogram(quad)) {
            const bool is_rectangle = is_perpendicular(p[1] - p[0], p[3] - p[0]);
            add_flat_light(is_rectangle ? LightKind::rectangle : LightKind::parallelogram,
                           {p[0], p[1], p[3]});
        } else {
            add_flat_light(LightKind::triangle, {p[0], p[1], p[2]});
            add_flat_light(LightKind::triangle, {p[0], p[2], p[3]});
        }
    }

    void add(const TriangleMesh& mesh) {
        has_mesh_ = true;
        for (const auto& index : mesh.indices) {
            Triangle triangle;
            for (std::size_t k = 0; k < 3; ++k) {
                triangle.corners[k] = mesh.positions_world[index[k]];
                if (!mesh.normals_world.empty()) triangle.normals[k] = mesh.normals_world[index[k]];
                if (!mesh.uvs.empty()) triangle.uvs[k] = mesh.uvs[index[k]];
            }
            has_normals_ = has_normals_ || !mesh.normals_world.empty();
            add_triangle(triangle);
            if (emits(*material_)) add_flat_light(LightKind::triangle, triangle.corners);
        }
    }

    void add(const Sphere& sphere) {
        Surface surface = new_surface();
        put(surface.fields + kShape, sphere.center_world);
        surface.fields[kShape + 3] = sphere.radius;
        surface.fields[kOffset] = kOffsetShare * (largest(sphere.center_world) + sphere.radius);
        spheres_.list.push_back(surface);
        const glm::vec3& c = sphere.center_world;
        spheres_.shapes.push_back({{c.x, c.y, c.z}, sphere.radius});
        if (!emits(*material_)) return;
        LightRecord light = new_light(LightKind::sphere);
        put(light.origin, sphere.center_world);
        light.radius = sphere.radius;
        light.area = 4.0f * std::numbers::pi_v<float> * sphere.radius * sphere.radius;
        light.offset_world = surface.fields[kOffset];
        flat_.lights.push_back(light);
    }

    void add_triangle(const Triangle& triangle) {
        triangles_.list.push_back(flat_surface(triangle, 0.0f));
        for (const glm::vec3& c : triangle.corners)
            triangles_.shapes.insert(triangles_.shapes.end(), {c.x, c.y, c.z});
        VertexNormals normals;
        for (std::size_t k = 0; k < 3; ++k) put(normals.corner[k], triangle.normals[k]);
        flat_.vertex_normals.push_back(normals);
    }

    /// Through three corners; any others' coordinates are at most `others`.
    [[nodiscard]] Surface flat_surface(const Triangle& triangle, float others) {
        const auto& corners = triangle.corners;
        const glm::dvec3 normal = normal_of(corners[0], corners[1], corners[2]);
        Surface surface = new_surface();
        put(surface.fields + kShape, normal);
        surface.fields[kShape + 3] = static_cast<float>(glm::dot(normal, glm::dvec3(corners[0])));
        for (const glm::vec3& corner : corners) others = std::max(others, largest(corner));
        surface.fields[kOffset] = kOffsetShare * others;
        if (material_->albedo_texture != nullptr) {
            surface.fields[kTexture] =
                std::bit_cast<float>(static_cast<std::int32_t>(flat_.textures.size()));
            flat_.textures.push_back(
                place_texture(*material_->albedo_texture, corners, triangle.uvs));
        }
        return surface;
    }

    void add_flat_light(LightKind kind, const std::array<glm::vec3, 3>& corners) {
        const glm::dvec3 edge1 = glm::dvec3(corners[1]) - glm::dvec3(corners[0]);
        const glm::dvec3 edge2 = glm::dvec3(corners[2]) - glm::dvec3(corners[0]);
        const glm::dvec3 cross = glm::cross(edge1, edge2);
        LightRecord light = new_light(kind);
        put(light.origin, corners[0]);
        put(light.edge1, edge1);
        put(light.edge2, edge2);
        put(light.normal, glm::normalize(cross));
        const double share = kind == LightKind::triangle ? 0.5 : 1.0;
        light.area = static_cast<float>(share * glm::length(cross));
        float reach = 0;
        for (const glm::vec3& corner : corners) reach = std::max(reach, largest(corner));
        light.offset_world =
            kOffsetShare * std::max(reach, largest(corners[1] + corners[2] - corners[0]));
        light.inverse_length[0] = static_cast<float>(1.0 / glm::length(edge1));
        light.inverse_length[1] = static_cast<float>(1.0 / glm::length(edge2));
        flat_.lights.push_back(light);
    }

    // An emitter is added for each surface that emits, in the same order.
    [[nodiscard]] Surface new_surface() {
        Surface surface{};
        surface.fields[kLight] =
            std::bit_cast<float>(emits(*material_) ? emitting_surfaces_++ : -1);
        put(surface.fields + kAlbedo, material_->albedo);
        put(surface.fields + kEmission, material_->emission);
        surface.fields[kMirror] = std::bit_cast<float>(material_->mirror ? -1 : 0);
        surface.fields[kTexture] = std::bit_cast<float>(-1);
        flat_.has_mirrors = flat_.has_mirrors || material_->mirror;
        surface.object_id = object_id_;
        return surface;
    }

    [[nodiscard]] LightRecord new_light(LightKind kind) const {
        LightRecord light{};
        light.kind = kind;
        put(light.radiance, material_->emission);
        return light;
    }

    // In proportion to emitted power.
    void set_selection_probabilities() {
        const auto power = [](const LightRecord& light) {
            return luminance(light.radiance) * static_cast<double>(light.area);
        };
        double total = 0;
        for (const LightRecord& light : flat_.lights) total += power(light);
        double sum = 0;
        for (LightRecord& light : flat_.lights) {
            sum += power(light);
            light.selection_probability = static_cast<float>(power(light) / total);
            light.selection_cdf = static_cast<float>(sum / total);
        }
    }

    const Scene& scene_;
    FlatScene flat_;
    Surfaces<std::array<glm::vec3, 4>> quads_;
    Surfaces<float> triangles_;
    Surfaces<SphereShape> spheres_;
    bool has_mesh_ = false;
    bool has_normals_ = false;
    std::int32_t object_id_ = 0;
    std::int32_t emitting_surfaces_ = 0;
    const Material* material_ = nullptr;
};

void set_camera(const Camera& camera, float aspect, TraceTask& task) {
    const glm::vec3 forward = glm::normalize(camera.look_at_world - camera.position_world);
    const glm::vec3 right = glm::normalize(glm::cross(forward, camera.up_world));
    const glm::vec3 up = glm::cross(right, forward);
    const float radians = camera.vertical_fov_degrees * std::numbers::pi_v<float> / 180.0f;
    const float half_height = std::tan(0.5f * radians);
    put(task.camera_origin, camera.position_world);
    put(task.camera_forward, forward);
    put(task.camera_right, right * (half_height * aspect));
    put(task.camera_up, up * half_height);
}

}  // namespace

FlatScene flatten(const Scene& scene) {
    return Flattener(scene).run();
}

TraceTask trace_task(const Scene& scene, const FlatScene& flat, float aspect) {
    TraceTask task{};
    task.embree = flat.embree.get();
    task.surfaces = {flat.surface_fields.data(), flat.surface_stride,
                     static_cast<std::uint32_t>(flat.object_id.size()), flat.object_id.data()};
    task.first_triangle = flat.first_triangle;
    task.first_sphere = flat.first_sphere;
    task.has_triangles = flat.first_sphere > flat.first_triangle;
    task.has_spheres = task.surfaces.count > flat.first_sphere;
    task.vertex_normals = flat.vertex_normals.empty() ? nullptr : flat.vertex_normals.data();
    task.textures = flat.textures.empty() ? nullptr : flat.textures.data();
    task.has_mirrors = flat.has_mirrors;
    task.lights = flat.lights.data();
    task.light_count = static_cast<std::uint32_t>(flat.lights.size());
    task.light_tree = {flat.light_tree.fields.data(), flat.light_tree.stride,
                       flat.light_tree.count};
    put(task.background, scene.background);
    task.has_background = scene.background != glm::vec3(0.0f);
    set_camera(scene.camera, aspect, task);
    return task;
}

}  // namespace vecino
