// SPDX-License-Identifier: Apache-2.0
//
// Rays through Embree and the surfaces that they hit, VECINO_WIDTH side by side. Included only by
// trace_kernel.cpp, like lanes.h.
#pragma once

#include "core/embree_scene.h"
#include "core/lanes.h"
#include "core/packet_log.h"
#include "core/texture_lanes.h"
#include "core/trace_task.h"

namespace vecino {
namespace {

struct Ray {
    Float3 origin;
    Float3 direction;                 ///< of any length but 0; distances count in lengths of it
    Rays relation = Rays::scattered;  ///< of the W to each other
};

/// What shading knows of the surfaces that W rays hit.
struct Surface {
    Mask hit;
    Float3 position;
    Float3 geometric_normal;  ///< as the shape defines it: the side that emits
    Float3 normal;            ///< geometric, on the side the ray came from
    Float3 shading_normal;    ///< likewise; equals normal unless the mesh has normals
    Float3 albedo;
    Float offset;
    Float distance;
    Int index;         ///< into the table of surfaces; 0 at a miss
    Mask front;        ///< seen from the side that emits
    Float3 direction;  ///< of the ray that hit it
};

class Tracer {
  public:
    explicit Tracer(const TraceTask& task) : task_(task) {}

    Ray primary_ray(Float pixel_x, Float pixel_y) const;
    /// Of rays whose direction is unit.
    Surface trace(const Ray& ray, Mask active);
    /// The same where it is known that the rays hit a quad or a sphere: without tracing them.
    Surface revisit(const Ray& ray, std::int32_t surface, Mask active) const;
    /// Whether something lies between the origin and t_far.
    Mask occluded(const Ray& ray, Float t_far, Mask active);
    /// Radiance that surfaces send back along the rays that hit them.
    Float3 emission(const Surface& surface) const;
    /// The numbers of the emitters that send it; -1 where there is none.
    Int emitter(const Surface& surface) const;
    /// Those that reflect as mirrors do.
    Mask mirrors(const Surface& surface) const;
    std::uint64_t rays() const { return rays_; }

  private:
    Surface shade(const Ray& ray, const HitPacket<W>& hits, Mask active) const;
    Int surface_index(const HitPacket<W>& hits) const;
    void put_on_spheres(const Float3& along_ray, const Float3& center, Float radius,
                        Surface& surface) const;
    void interpolate_normals(const HitPacket<W>& hits, const Ray& ray, Surface& surface) const;
    void look_up_textures(Surface& surface) const;
    Float field(int number, Int index) const {
        const SurfaceTable& table = task_.surfaces;
        return lookup(table.fields + static_cast<std::size_t>(number) * table.stride, table.count,
                      index);
    }
    Float3 fields(int first, Int index) const {
        return {field(first, index), field(first + 1, index), field(first + 2, index)};
    }

    const TraceTask& task_;
    std::uint64_t rays_ = 0;
};

/// Where shading and geometry agree on the horizon.
inline Mask is_flat(const Surface& s) {
    return dot(s.shading_normal, s.normal) > 0.999999f;
}

inline void pack(const Ray& ray, Float t_far, RayPacket<W>& packet) {
    store(packet.origin[0], ray.origin.x);
    store(packet.origin[1], ray.origin.y);
    store(packet.origin[2], ray.origin.z);
    store(packet.t_near, Float{});
    store(packet.direction[0], ray.direction.x);
    store(packet.direction[1], ray.direction.y);
    store(packet.direction[2], ray.direction.z);
    store(packet.time, Float{});
    store(packet.t_far, t_far);
    store(packet.mask, Int{} - 1);
}

inline Ray Tracer::primary_ray(Float pixel_x, Float pixel_y) const {
    const Float right = pixel_x * (2.0f / static_cast<float>(task_.width)) - 1.0f;
    const Float up = 1.0f - pixel_y * (2.0f / static_cast<float>(task_.height));
    const Float3 direction = splat3(task_.camera_forward) + splat3(task_.camera_right) * right +
                             splat3(task_.camera_up) * up;
    return {splat3(task_.camera_origin), normalise(direction), Rays::coherent};
}

inline Surface Tracer::trace(const Ray& ray, Mask active) {
    HitPacket<W> hits;
    pack(ray, splat(__builtin_inff()), hits.ray);
    store(hits.geometry, splat(kNoGeometry));
    store(hits.instance, splat(kNoGeometry));
    alignas(64) std::int32_t lanes[W];
    store(lanes, active);
    if (task_.packet_log) log_packet(*task_.packet_log, RayQuery::nearest_hit, lanes, hits.ray);
    task_.embree->intersect(lanes, hits, ray.relation);
    rays_ += static_cast<std::uint64_t>(count(active));
    return shade(ray, hits, active);
}

inline Mask Tracer::occluded(const Ray& ray, Float t_far, Mask active) {
    RayPacket<W> rays;
    pack(ray, t_far, rays);
    alignas(64) std::int32_t lanes[W];
    store(lanes, active);
    if (task_.packet_log) log_packet(*task_.packet_log, RayQuery::any_hit, lanes, rays);
    task_.embree->occluded(lanes, rays);
    rays_ += static_cast<std::uint64_t>(count(active));
    return active & (load<Float>(rays.t_far) < 0.0f);
}

inline Int Tracer::surface_index(const HitPacket<W>& hits) const {
    const Int geometry = load<Int>(hits.geometry);
    Int index = load<Int>(hits.primitive);
    if (task_.has_triangles)
        index += (geometry == static_cast<int>(kTriangles)) & (Int)splat(task_.first_triangle);
    if (task_.has_spheres)
        index += (geometry == static_cast<int>(kSpheres)) & (Int)splat(task_.first_sphere);
    return index;
}

inline Surface Tracer::shade(const Ray& ray, const HitPacket<W>& hits, Mask active) const {
    const Int geometry = load<Int>(hits.geometry);
    Surface s;
    s.hit = active & (geometry != static_cast<int>(kNoGeometry));
    s.index = surface_index(hits) & s.hit;
    s.distance = load<Float>(hits.ray.t_far);
    const Float3 shape = fields(kShape, s.index);
    const Float offset_or_radius = field(kShape + 3, s.index);
    s.albedo = fields(kAlbedo, s.index);
    s.offset = field(kOffset, s.index);

    // Put the hit back onto its surface: t alone leaves it off by its own rounding.
    const Float3 along_ray = ray.origin + ray.direction * s.distance;
    s.position = along_ray + shape * (offset_or_radius - dot(shape, along_ray));
    s.geometric_normal = shape;
    if (task_.has_spheres) put_on_spheres(along_ray, shape, offset_or_radius, s);
    s.front = dot(s.geometric_normal, ray.direction) < 0.0f;
    s.normal = select(s.front, s.geometric_normal, -s.geometric_normal);
    s.shading_normal = s.normal;
    s.direction = ray.direction;
    if (task_.vertex_normals != nullptr) interpolate_normals(hits, ray, s);
    if (task_.textures != nullptr) look_up_textures(s);
    return s;
}

inline void Tracer::put_on_spheres(const Float3& along_ray, const Float3& center, Float radius,
                                   Surface& s) const {
    const Mask on_sphere = s.index >= (Int)splat(task_.first_sphere);
    if (!any(on_sphere)) return;
    const Float3 outward = normalise(along_ray - center);
    s.geometric_normal = select(on_sphere, outward, s.geometric_normal);
    s.position = select(on_sphere, center + outward * radius, s.position);
}

inline Float3 Tracer::emission(const Surface& s) const {
    return select(s.front & s.hit, fields(kEmission, s.index), Float3{});
}

inline Int Tracer::emitter(const Surface& s) const {
    return select(s.front & s.hit, (Int)field(kLight, s.index), Int{} - 1);
}

inline Mask Tracer::mirrors(const Surface& s) const {
    return task_.has_mirrors ? s.hit & (Int)field(kMirror, s.index) : Mask{};
}

inline void Tracer::look_up_textures(Surface& s) const {
    const Int number = select(s.hit, (Int)field(kTexture, s.index), Int{} - 1);
    for (int i = 0; i < W; ++i) {
        if (number[i] < 0) continue;
        const float position[3] = {s.position.x[i], s.position.y[i], s.position.z[i]};
        const Texel texel = look_up(task_.textures[number[i]], position);
        s.albedo.x[i] = texel.rgb[0];
        s.albedo.y[i] = texel.rgb[1];
        s.albedo.z[i] = texel.rgb[2];
    }
}

inline void Tracer::interpolate_normals(const HitPacket<W>& hits, const Ray& ray,
                                        Surface& s) const {
    alignas(64) float normal[3][W];
    const Mask on_triangle = s.hit & (load<Int>(hits.geometry) == static_cast<int>(kTriangles));
    for (int i = 0; i < W; ++i) {
        const VertexNormals& corners =
            task_.vertex_normals[on_triangle[i] != 0 ? hits.primitive[i] : 0];
        const float b[3] = {1.0f - hits.u[i] - hits.v[i], hits.u[i], hits.v[i]};
        for (int k = 0; k < 3; ++k) {
            normal[k][i] = b[0] * corners.corner[0][k] + b[1] * corners.corner[1][k] +
                           b[2] * corners.corner[2][k];
        }
    }
    const Float3 smooth = {load<Float>(normal[0]), load<Float>(normal[1]), load<Float>(normal[2])};
    // A triangle without normals has zeros; a normal that faces away from the ray cannot shade it.
    const Float length2 = dot(smooth, smooth);
    const Float3 unit = smooth * (1.0f / sqrt(max(length2, splat(1e-20f))));
    const Mask same_side = dot(unit, s.geometric_normal) > 0.0f;
    const Float3 upright = select(same_side, unit, -unit);
    const Float3 facing = select(s.front, upright, -upright);
    const Mask usable = on_triangle & (length2 > 1e-12f) & (dot(facing, ray.direction) < 0.0f);
    s.shading_normal = select(usable, facing, s.shading_normal);
}

inline Surface Tracer::revisit(const Ray& ray, std::int32_t surface, Mask active) const {
    const bool on_sphere = static_cast<std::uint32_t>(surface) >= task_.first_sphere;
    const Int index = Int{} + surface;
    const Float3 shape = fields(kShape, index);
    const Float offset_or_radius = field(kShape + 3, index);
    Float t = (offset_or_radius - dot(shape, ray.origin)) / dot(shape, ray.direction);
    if (on_sphere) {
        const Float3 to_center = shape - ray.origin;
        const Float middle = dot(to_center, ray.direction);
        const Float3 off = to_center - ray.direction * middle;
        const Float half2 = offset_or_radius * offset_or_radius - dot(off, off);
        const Float half = sqrt(max(half2, Float{}));
        t = select(middle > half, middle - half, middle + half);
    }
    HitPacket<W> hits;
    const std::uint32_t kind = on_sphere ? kSpheres : kQuads;
    store(hits.ray.t_far, t);
    store(hits.geometry, splat(kind));
    store(hits.primitive,
          splat(static_cast<std::uint32_t>(surface) - (on_sphere ? task_.first_sphere : 0u)));
    return shade(ray, hits, active);
}

inline void record_first_hit(const TraceTask& task, const Surface& s, int lane,
                             FirstHitRecord& out) {
    const bool hit = s.hit[lane] != 0;
    const auto put = [&](float(&to)[3], const Float3& from) {
        to[0] = hit ? from.x[lane] : 0.0f;
        to[1] = hit ? from.y[lane] : 0.0f;
        to[2] = hit ? from.z[lane] : 0.0f;
    };
    put(out.position_world, s.position);
    put(out.normal_world, s.normal);
    put(out.albedo, s.albedo);
    out.distance_world = hit ? s.distance[lane] : 0.0f;
    out.object_id = hit ? task.surfaces.object_id[s.index[lane]] : -1;
}

}  // namespace
}  // namespace vecino
