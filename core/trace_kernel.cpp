// SPDX-License-Identifier: Apache-2.0
//
// The path tracer's inner loop: VECINO_WIDTH samples of one pixel side by side. Compiled once per
// width with the instruction set that goes with it (core/CMakeLists.txt). Whole packets go through
// Embree; shading is vector code.
#include "core/embree_scene.h"
#include "core/lanes.h"
#include "core/light_lanes.h"
#include "core/packet_log.h"
#include "core/random_lanes.h"
#include "core/trace_task.h"

namespace vecino {
namespace {

// Steradians below which a rectangle is sampled by area.
constexpr float kLeastSolidAngle = 2e-3f;

struct Ray {
    Float3 origin, direction;
};

/// What shading knows of the surfaces that W rays hit.
struct Surface {
    Mask hit;
    Float3 position;
    Float3 geometric_normal;  ///< as the shape defines it: the side that emits
    Float3 normal;            ///< geometric, on the side the ray came from
    Float3 shading_normal;    ///< likewise; equals normal unless the mesh has normals
    Float3 albedo;
    Float3 emission;  ///< 0 on the back
    Float offset;
    Float distance;
    Int object_id;
};

class Tracer {
  public:
    explicit Tracer(const TraceTask& task) : task_(task) {}

    Ray primary_ray(Float pixel_x, Float pixel_y) const;
    Surface trace(const Ray& ray, Mask active);
    Mask occluded(const Ray& ray, Float distance, Mask active);
    std::uint64_t rays() const { return rays_; }

  private:
    Surface shade(const Ray& ray, const HitPacket<W>& hits) const;
    void interpolate_normals(const HitPacket<W>& hits, const Ray& ray, Surface& surface) const;

    const TraceTask& task_;
    std::uint64_t rays_ = 0;
};

/// Where shading and geometry agree on the horizon.
Mask is_flat(const Surface& s) {
    return dot(s.shading_normal, s.normal) > 0.999999f;
}

RayPacket<W> pack(const Ray& ray, Float t_far, Mask active) {
    RayPacket<W> packet;
    store(packet.origin[0], ray.origin.x);
    store(packet.origin[1], ray.origin.y);
    store(packet.origin[2], ray.origin.z);
    store(packet.direction[0], ray.direction.x);
    store(packet.direction[1], ray.direction.y);
    store(packet.direction[2], ray.direction.z);
    store(packet.t_far, t_far);
    store(packet.active, active);
    return packet;
}

Ray Tracer::primary_ray(Float pixel_x, Float pixel_y) const {
    const Float right = pixel_x * (2.0f / static_cast<float>(task_.width)) - 1.0f;
    const Float up = 1.0f - pixel_y * (2.0f / static_cast<float>(task_.height));
    const Float3 direction = splat3(task_.camera_forward) + splat3(task_.camera_right) * right +
                             splat3(task_.camera_up) * up;
    return {splat3(task_.camera_origin), normalise(direction)};
}

Surface Tracer::trace(const Ray& ray, Mask active) {
    const RayPacket<W> packet = pack(ray, splat(__builtin_inff()), active);
    if (task_.packet_log) log_packet(*task_.packet_log, RayQuery::nearest_hit, packet);
    HitPacket<W> hits;
    task_.embree->intersect(packet, hits);
    rays_ += static_cast<std::uint64_t>(count(active));
    return shade(ray, hits);
}

Mask Tracer::occluded(const Ray& ray, Float distance, Mask active) {
    const RayPacket<W> packet = pack(ray, distance, active);
    if (task_.packet_log) log_packet(*task_.packet_log, RayQuery::any_hit, packet);
    alignas(64) std::int32_t blocked[W];
    task_.embree->occluded(packet, blocked);
    rays_ += static_cast<std::uint64_t>(count(active));
    return load<Mask>(blocked);
}

Surface Tracer::shade(const Ray& ray, const HitPacket<W>& hits) const {
    constexpr int kFields = 11;  // shape, albedo, offset, emission
    alignas(64) float gathered[kFields][W];
    alignas(64) std::int32_t ids[W];
    alignas(64) std::int32_t sphere[W];
    alignas(64) std::int32_t hit[W];
    for (int i = 0; i < W; ++i) {
        const std::uint32_t primitive = hits.primitive[i];
        const bool miss = primitive == kNoPrimitive;
        // A miss reads the first record and masks it; a scene without surfaces has one dummy
        // record.
        const SurfaceRecord& record = task_.surfaces[miss ? 0 : primitive];
        float fields[kFields];
        __builtin_memcpy(fields, &record, sizeof fields);
        for (int k = 0; k < kFields; ++k) gathered[k][i] = fields[k];
        ids[i] = record.object_id;
        sphere[i] = primitive >= task_.triangle_count ? -1 : 0;
        hit[i] = miss ? 0 : -1;
    }
    Surface s;
    s.hit = load<Mask>(hit);
    s.object_id = load<Int>(ids);
    s.distance = load<Float>(hits.t);
    const Mask on_sphere = load<Mask>(sphere) & s.hit;
    const Float3 shape = {load<Float>(gathered[0]), load<Float>(gathered[1]),
                          load<Float>(gathered[2])};
    const Float offset_or_radius = load<Float>(gathered[3]);
    s.albedo = {load<Float>(gathered[4]), load<Float>(gathered[5]), load<Float>(gathered[6])};
    s.offset = load<Float>(gathered[7]);
    s.emission = {load<Float>(gathered[8]), load<Float>(gathered[9]), load<Float>(gathered[10])};

    // Put the hit back onto its surface: t alone leaves it off by its own rounding.
    const Float3 along_ray = ray.origin + ray.direction * s.distance;
    const Float3 on_plane = along_ray + shape * (offset_or_radius - dot(shape, along_ray));
    s.position = on_plane;
    s.geometric_normal = shape;
    if (any(on_sphere)) {
        const Float3 outward = normalise(along_ray - shape);
        s.geometric_normal = select(on_sphere, outward, s.geometric_normal);
        s.position = select(on_sphere, shape + outward * offset_or_radius, s.position);
    }
    const Mask front = dot(s.geometric_normal, ray.direction) < 0.0f;
    const Float3 zero{};
    s.normal = select(front, s.geometric_normal, zero - s.geometric_normal);
    s.emission = select(front & s.hit, s.emission, zero);
    s.shading_normal = s.normal;
    if (task_.vertex_normals != nullptr) interpolate_normals(hits, ray, s);
    return s;
}

void Tracer::interpolate_normals(const HitPacket<W>& hits, const Ray& ray, Surface& s) const {
    alignas(64) float normal[3][W];
    alignas(64) std::int32_t on_triangle[W];
    for (int i = 0; i < W; ++i) {
        const bool triangle = hits.primitive[i] < task_.triangle_count;
        on_triangle[i] = triangle ? -1 : 0;
        const VertexNormals& corners = task_.vertex_normals[triangle ? hits.primitive[i] : 0];
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
    const Float3 zero{};
    const Float3 upright = select(same_side, unit, zero - unit);
    const Mask front = dot(s.geometric_normal, ray.direction) < 0.0f;
    const Float3 facing = select(front, upright, zero - upright);
    const Mask usable =
        load<Mask>(on_triangle) & (length2 > 1e-12f) & (dot(facing, ray.direction) < 0.0f);
    s.shading_normal = select(usable, facing, s.shading_normal);
}

/// Cosine-weighted direction around a normal (Malley's method).
Float3 cosine_direction(Float3 n, Pair u) {
    Float sine, cosine;
    sincos_turns(u.v, sine, cosine);
    const Float radius = sqrt(u.u);
    const Float x = radius * cosine;
    const Float y = radius * sine;
    const Float z = sqrt(max(1.0f - u.u, splat(0.0f)));
    const Basis basis = basis_around(n);
    return normalise(basis.tangent * x + basis.bitangent * y + n * z);
}

/// A point on the picked emitter, for its kind; where it is a rectangle that fills a solid angle
/// worth the trouble, also the rectangle as the surface sees it.
struct LightSample {
    LightPoint point;
    SphericalRectangle rectangle;
    Mask has_rectangle;
};

LightSample sample_light(const TraceTask& task, const PickedLight& light, Float3 from, Pair u) {
    LightSample sample{sample_area(light, from, u), {}, Mask{}};
    const auto replace = [&](Mask where, const LightPoint& by) {
        sample.point.position = select(where, by.position, sample.point.position);
        sample.point.normal = select(where, by.normal, sample.point.normal);
        sample.point.inverse_pdf = select(where, by.inverse_pdf, sample.point.inverse_pdf);
    };
    if (any(light.sphere)) replace(light.sphere, sample_sphere(light, from, u));
    if (!(task.by_solid_angle || task.control_variate) || !any(light.rectangle)) return sample;
    const Float3 to_corner = light.origin - from;
    sample.rectangle = spherical_rectangle(to_corner, light.edge1, light.edge2);
    // Sums of angles lose the digits of a small one, over which sampling by area is as good.
    sample.has_rectangle = light.rectangle & (dot(to_corner, light.normal) < 0.0f) &
                           (sample.rectangle.solid_angle > kLeastSolidAngle);
    if (task.by_solid_angle) {
        const Float3 position = from + sample_rectangle(sample.rectangle, u);
        replace(sample.has_rectangle, {position, light.normal, sample.rectangle.solid_angle});
    }
    return sample;
}

/// Light that arrives at a surface straight from one emitter, times cos / pi.
Float3 sample_direct(Tracer& tracer, const TraceTask& task, const Surface& s, Mask active,
                     Pair random) {
    const PickedLight light = pick_light(task, random.u);
    const Float3 from = s.position + s.normal * s.offset;
    const LightSample sample = sample_light(task, light, from, {light.u, random.v});
    const LightPoint& point = sample.point;
    const Float3 to_light = point.position + point.normal * light.offset - from;
    const Float distance = sqrt(dot(to_light, to_light));
    const Ray shadow = {from, to_light * (1.0f / distance)};
    const Float cosine = dot(shadow.direction, s.shading_normal);
    const Mask lit = active & (point.inverse_pdf > 0.0f) & (cosine > 0.0f) &
                     (dot(shadow.direction, s.normal) > 0.0f);
    const Float3 zero{};
    if (!any(lit)) return zero;
    const Mask visible = lit & ~tracer.occluded(shadow, distance, lit);
    const Float3 radiance = light.radiance * (1.0f / light.probability);
    const Float unhidden = cosine * point.inverse_pdf * (1.0f / kPi);
    Float weight = select(visible, unhidden, splat(0.0f));
    if (task.control_variate && any(sample.has_rectangle)) {
        const Irradiance exact = rectangle_irradiance(sample.rectangle, s.shading_normal);
        const Mask usable = sample.has_rectangle & exact.exact & lit & is_flat(s);
        const Float hidden = select(visible, splat(0.0f), unhidden);
        weight = select(usable, exact.value - hidden, weight);
    }
    return select(lit, radiance * weight, zero);
}

void add(float (&plane)[3][kBlockSamples], int at, Float3 light) {
    store(plane[0] + at, load<Float>(plane[0] + at) + light.x);
    store(plane[1] + at, load<Float>(plane[1] + at) + light.y);
    store(plane[2] + at, load<Float>(plane[2] + at) + light.z);
}

void record_first_hit(const Surface& s, int lane, FirstHitRecord& out) {
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
    out.object_id = hit ? s.object_id[lane] : -1;
}

/// W paths from the camera on. Light found at vertex k went through k bounces.
class PathPacket {
  public:
    PathPacket(const TraceTask& task, const PathRandom& random) : task_(task), random_(random) {}

    void run(Tracer& tracer, const Ray& primary, Mask active, SampleBlock& block, int at) {
        const Float3 background = splat3(task_.background);
        surface_ = tracer.trace(primary, active);
        first_ = surface_;
        const Float3 zero{};
        add(block.emission, at,
            select(active, select(surface_.hit, surface_.emission, background), zero));
        active_ = active & surface_.hit;
        throughput_ = surface_.albedo;
        for (int bounce = 1; bounce <= task_.max_depth; ++bounce) {
            active_ &= (throughput_.x + throughput_.y + throughput_.z) > 0.0f;
            if (!any(active_)) return;
            const Float3 light = next_vertex(tracer, bounce);
            add(bounce == 1 ? block.direct : block.indirect, at, light);
        }
    }
    const Surface& first() const { return first_; }

  private:
    /// Light that reaches the path by its bounce-th bounce; moves on to the next vertex where one
    /// is needed.
    Float3 next_vertex(Tracer& tracer, int bounce) {
        const auto vertex = static_cast<std::uint32_t>(bounce - 1);
        const bool last = bounce == task_.max_depth;
        const bool by_light = task_.next_event_estimation;
        Float3 light{};
        if (by_light && task_.light_count > 0) {
            light = throughput_ *
                    sample_direct(tracer, task_, surface_, active_, random_.pair(1 + 2 * vertex));
        }
        if (by_light && last && !task_.has_background) return light;
        const Ray ray = bounce_ray(random_.pair(2 + 2 * vertex));
        // A direction below the true surface (possible with shading normals) carries nothing.
        active_ &= dot(ray.direction, surface_.normal) > 0.0f;
        return light + follow(tracer, ray, last);
    }

    Ray bounce_ray(Pair u) const {
        const Float3 from = surface_.position + surface_.normal * surface_.offset;
        return {from, cosine_direction(surface_.shading_normal, u)};
    }

    Float3 follow(Tracer& tracer, const Ray& ray, bool last) {
        const Float3 background = splat3(task_.background);
        const Float3 zero{};
        if (task_.next_event_estimation && last) {  // only the background is still to be found
            const Mask blocked = tracer.occluded(ray, splat(__builtin_inff()), active_);
            return select(active_ & ~blocked, throughput_ * background, zero);
        }
        const Float3 throughput = throughput_;
        const Mask traced = active_;
        surface_ = tracer.trace(ray, traced);
        active_ = traced & surface_.hit;
        throughput_ = throughput * surface_.albedo;
        const Float3 emitted = task_.next_event_estimation ? zero : surface_.emission;
        return select(traced, throughput * select(surface_.hit, emitted, background), zero);
    }

    const TraceTask& task_;
    const PathRandom& random_;
    Surface surface_, first_;
    Float3 throughput_;
    Mask active_;
};

Int lane_numbers() {
    Int lanes;
    for (int i = 0; i < W; ++i) lanes[i] = i;
    return lanes;
}

std::uint64_t trace_samples(const TraceTask& task, const SampleRange& range, SampleBlock& block,
                            FirstHitRecord* first_hit) {
    __builtin_memset(&block, 0, sizeof block);
    Tracer tracer(task);
    const auto pixel =
        static_cast<std::uint32_t>(range.y) * static_cast<std::uint32_t>(task.width) +
        static_cast<std::uint32_t>(range.x);
    for (int at = 0; at < range.count; at += W) {
        const Int lane = lane_numbers() + at;
        const Mask active = lane < range.count;
        const PathRandom random(task, pixel, (Uint)lane + range.first_sample);
        const Pair jitter = random.pair(0);
        const Ray primary = tracer.primary_ray(jitter.u + static_cast<float>(range.x),
                                               jitter.v + static_cast<float>(range.y));
        PathPacket paths(task, random);
        paths.run(tracer, primary, active, block, at);
        if (at == 0 && first_hit != nullptr) record_first_hit(paths.first(), 0, *first_hit);
    }
    return tracer.rays();
}

std::uint64_t trace_centres(const TraceTask& task, const SampleRange& range, FirstHitRecord* out) {
    Tracer tracer(task);
    for (int at = 0; at < range.count; at += W) {
        const Int lane = lane_numbers() + at;
        const Mask active = lane < range.count;
        const Float x = __builtin_convertvector(lane + range.x, Float) + 0.5f;
        const Ray ray = tracer.primary_ray(x, splat(static_cast<float>(range.y) + 0.5f));
        const Surface surface = tracer.trace(ray, active);
        for (int i = 0; i < W && at + i < range.count; ++i)
            record_first_hit(surface, i, out[at + i]);
    }
    return tracer.rays();
}

}  // namespace

#define VECINO_CONCAT(a, b) a##b
#define VECINO_KERNEL_NAME(width) VECINO_CONCAT(kTraceKernel, width)
extern const TraceKernel VECINO_KERNEL_NAME(VECINO_WIDTH);
const TraceKernel VECINO_KERNEL_NAME(VECINO_WIDTH) = {VECINO_WIDTH, trace_samples, trace_centres};

}  // namespace vecino
