// SPDX-License-Identifier: Apache-2.0
#include "core/flat_scene.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <optional>

namespace vecino {
namespace {

// A hit is put back onto its surface, so it is off by a few units in the last place of the
// coordinates; 2^-17 of the largest one is some 64 of them. Relative, so that the unit of length
// does not matter.
constexpr float kOffset = 0x1p-17f;

void put(float (&to)[3], const glm::vec3& from) {
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

bool emits(const Material& material) {
    return material.emission != glm::vec3(0.0f);
}

struct Triangle {
    std::array<glm::vec3, 3> corners;
    std::array<glm::vec3, 3> normals{};  ///< zero: use the geometric one
};

class Flattener {
  public:
    explicit Flattener(const Scene& scene) : scene_(scene) {}

    FlatScene run() {
        for (std::size_t i = 0; i < scene_.objects.size(); ++i) add_object(i);
        flat_.triangle_count = static_cast<std::uint32_t>(flat_.surfaces.size());
        flat_.surfaces.insert(flat_.surfaces.end(), spheres_.begin(), spheres_.end());
        if (flat_.surfaces.empty()) flat_.surfaces.emplace_back();
        if (!has_normals_) flat_.vertex_normals.clear();
        set_selection_probabilities();
        flat_.embree = std::make_unique<EmbreeScene>(
            EmbreeGeometry{corners_.data(), flat_.triangle_count, sphere_shapes_.data(),
                           spheres_.size(), has_mesh_});
        return std::move(flat_);
    }

  private:
    void add_object(std::size_t index) {
        object_id_ = static_cast<std::int32_t>(index);
        material_ = &scene_.materials[scene_.objects[index].material];
        std::visit([this](const auto& shape) { add(shape); }, scene_.objects[index].shape);
    }

    void add(const Quad& quad) {
        const auto& p = quad.corners_world;
        add_triangle({{p[0], p[1], p[2]}});
        add_triangle({{p[0], p[2], p[3]}});
        if (!emits(*material_)) return;
        if (p[0] + p[2] == p[1] + p[3]) {
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
            }
            has_normals_ = has_normals_ || !mesh.normals_world.empty();
            add_triangle(triangle);
            if (emits(*material_)) add_flat_light(LightKind::triangle, triangle.corners);
        }
    }

    void add(const Sphere& sphere) {
        SurfaceRecord record = new_surface();
        record.shape[0] = sphere.center_world.x;
        record.shape[1] = sphere.center_world.y;
        record.shape[2] = sphere.center_world.z;
        record.shape[3] = sphere.radius;
        record.offset_world = kOffset * (largest(sphere.center_world) + sphere.radius);
        spheres_.push_back(record);
        sphere_shapes_.insert(sphere_shapes_.end(), record.shape, record.shape + 4);
        if (!emits(*material_)) return;
        LightRecord light = new_light(LightKind::sphere);
        put(light.origin, sphere.center_world);
        light.radius = sphere.radius;
        light.area = 4.0f * std::numbers::pi_v<float> * sphere.radius * sphere.radius;
        light.offset_world = record.offset_world;
        flat_.lights.push_back(light);
    }

    void add_triangle(const Triangle& triangle) {
        const auto& [a, b, c] = triangle.corners;
        // In double: the normal of a thin or tiny triangle keeps its digits.
        const glm::dvec3 normal = glm::normalize(
            glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a)));
        SurfaceRecord record = new_surface();
        record.shape[0] = static_cast<float>(normal.x);
        record.shape[1] = static_cast<float>(normal.y);
        record.shape[2] = static_cast<float>(normal.z);
        record.shape[3] = static_cast<float>(glm::dot(normal, glm::dvec3(a)));
        record.offset_world = kOffset * std::max({largest(a), largest(b), largest(c)});
        flat_.surfaces.push_back(record);
        for (const glm::vec3& corner : triangle.corners) {
            corners_.insert(corners_.end(), {corner.x, corner.y, corner.z});
        }
        VertexNormals normals;
        for (std::size_t k = 0; k < 3; ++k) put(normals.corner[k], triangle.normals[k]);
        flat_.vertex_normals.push_back(normals);
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
        light.offset_world = flat_.surfaces.back().offset_world;
        flat_.lights.push_back(light);
    }

    [[nodiscard]] SurfaceRecord new_surface() const {
        SurfaceRecord record{};
        put(record.albedo, material_->albedo);
        put(record.emission, material_->emission);
        record.object_id = object_id_;
        return record;
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
            const double luminance = 0.2126 * static_cast<double>(light.radiance[0]) +
                                     0.7152 * static_cast<double>(light.radiance[1]) +
                                     0.0722 * static_cast<double>(light.radiance[2]);
            return luminance * static_cast<double>(light.area);
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
    std::vector<SurfaceRecord> spheres_;
    std::vector<float> sphere_shapes_;
    std::vector<float> corners_;
    bool has_mesh_ = false;
    bool has_normals_ = false;
    std::int32_t object_id_ = 0;
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
    task.surfaces = flat.surfaces.data();
    task.vertex_normals = flat.vertex_normals.empty() ? nullptr : flat.vertex_normals.data();
    task.lights = flat.lights.data();
    task.light_count = static_cast<std::uint32_t>(flat.lights.size());
    task.triangle_count = flat.triangle_count;
    put(task.background, scene.background);
    task.has_background = scene.background != glm::vec3(0.0f);
    set_camera(scene.camera, aspect, task);
    return task;
}

}  // namespace vecino
