// SPDX-License-Identifier: Apache-2.0
//
// The path tracer's inner loop: VECINO_WIDTH samples of one pixel side by side. Compiled once per
// width with the instruction set that goes with it (core/CMakeLists.txt). Whole packets go through
// Embree; shading is vector code.
#include "core/lanes.h"
#include "core/light_lanes.h"
#include "core/random_lanes.h"
#include "core/rectangle_lanes.h"
#include "core/surface_lanes.h"
#include "core/trace_task.h"

namespace vecino {
namespace {

// Steradians from which the exact irradiance of a rectangle is used.
constexpr float kLeastSolidAngle = 1e-2f;
// Points on a rectangle are sampled by solid angle within a distance whose square is so many times
// its area. Farther away it looks nearly the same from all sides, and sampling by area is as good
// and costs less. Within the same distance multiple importance sampling is worth it.
constexpr float kNearAreas = 4.0f;

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
    RectangleView rectangle;
    Mask has_rectangle;
};

void replace(LightPoint& point, Mask where, const LightPoint& by) {
    point.position = select(where, by.position, point.position);
    point.normal = select(where, by.normal, point.normal);
    point.inverse_pdf = select(where, by.inverse_pdf, point.inverse_pdf);
}

LightSample sample_light(const TraceTask& task, const PickedLight& light, Float3 from, Pair u) {
    LightSample sample;
    sample.point = sample_area(light, from, u);
    if (any(light.sphere)) replace(sample.point, light.sphere, sample_sphere(light, from, u));
    sample.has_rectangle = Mask{};
    if (!(task.by_solid_angle || task.control_variate) || !any(light.rectangle)) return sample;
    sample.rectangle = view_rectangle({light.origin - from, light.edge1, light.edge2, light.normal,
                                       light.inverse_length1, light.inverse_length2});
    // What is chosen here must not depend on the random point. Sums of angles lose the digits of a
    // small solid angle, over which sampling by area is as good.
    const RectangleView& r = sample.rectangle;
    const Float middle_x = 0.5f * (r.x0 + r.x1);
    const Float middle_y = 0.5f * (r.y0 + r.y1);
    const Float distance2 = middle_x * middle_x + middle_y * middle_y + r.height * r.height;
    const Mask in_sight = light.rectangle & (r.height > 0.0f);
    const Mask near = in_sight & (distance2 < kNearAreas * light.area);
    const Mask worth = light.area * r.height > kLeastSolidAngle * distance2 * sqrt(distance2);
    sample.has_rectangle = near | (in_sight & worth);
    if (task.by_solid_angle && any(near)) {
        const SolidAngleSample by_angle = sample_solid_angle(sample.rectangle, u);
        replace(sample.point, near, {from + by_angle.to_point, light.normal, by_angle.solid_angle});
    }
    return sample;
}

/// The direction in which a mirror sends on what hits it.
Float3 mirror_direction(const Surface& s) {
    return s.direction - s.shading_normal * (2.0f * dot(s.direction, s.shading_normal));
}

Float3 ray_origin(const Surface& s) {
    return s.position + s.normal * s.offset;
}

/// Whether a bounce that finds the emitter's light stands for a share of it: where points by area
/// are noisy, close to it. Farther away they are not, and the bounce would only add its own noise.
Mask is_shared(const TraceTask& task, const Emitter& emitter, Float3 from) {
    const Float middle = select(emitter.triangle, splat(1.0f / 3.0f), splat(0.5f));
    const Float3 to_middle = emitter.origin + (emitter.edge1 + emitter.edge2) * middle - from;
    const Mask near = dot(to_middle, to_middle) < kNearAreas * emitter.area;
    const bool otherwise = task.by_solid_angle || task.control_variate;
    return near & ~(otherwise ? emitter.sphere | emitter.rectangle : emitter.sphere);
}

/// Surfaces that ask for light: those that are active, and of these, those whose bounce stands for
/// a share of it too.
struct Asking {
    Mask active, weighed;
};

/// Light that arrives at a surface straight from one emitter, times cos / pi; where it is weighed,
/// less the share that the bounce stands for (balance heuristic, Veach and Guibas 1995).
Float3 sample_direct(Tracer& tracer, const TraceTask& task, const Surface& s, Asking asking,
                     Pair random) {
    const Float3 from = ray_origin(s);
    const PickedLight light = pick_light(task, {from, s.shading_normal}, random.u);
    const LightSample sample = sample_light(task, light, from, {light.u, random.v});
    const LightPoint& point = sample.point;
    const Ray shadow = {from, point.position + point.normal * light.offset - from};
    const Float distance = sqrt(dot(shadow.direction, shadow.direction));
    const Float cosine = dot(shadow.direction, s.shading_normal) / distance;
    const Mask lit = asking.active & (light.probability * point.inverse_pdf > 0.0f) &
                     (cosine > 0.0f) & (dot(shadow.direction, s.normal) > 0.0f);
    if (!any(lit)) return Float3{};
    const Mask visible = lit & ~tracer.occluded(shadow, splat(1.0f), lit);
    const Float3 radiance = light.radiance * (1.0f / light.probability);
    Float unhidden = cosine * point.inverse_pdf * (1.0f / kPi);
    if (task.multiple_importance) {
        const Mask shared = asking.weighed & is_shared(task, light, from);
        unhidden = select(shared, unhidden / (1.0f + unhidden / light.probability), unhidden);
    }
    Float weight = select(visible, unhidden, splat(0.0f));
    if (task.control_variate && any(sample.has_rectangle)) {
        const Irradiance exact = rectangle_irradiance(sample.rectangle, s.shading_normal);
        const Mask usable = sample.has_rectangle & exact.exact & is_flat(s);
        const Float hidden = select(visible, splat(0.0f), unhidden);
        weight = select(usable, exact.value - hidden, weight);
    }
    return select(lit, radiance * weight, Float3{});
}

/// The share of an emitter's light that a bounce which hits it stands for, where next-event
/// estimation stands for the rest.
Float bounce_weight(const TraceTask& task, const Receiver& from, const Ray& ray, const Surface& hit,
                    Int emitter) {
    const Int number = max(emitter, Int{});
    const Emitter light = emitter_at(task, number);
    Float probability = splat(1.0f);
    if (task.light_count > 1) {
        probability = task.by_contribution ? probability_by_contribution(task, from, number)
                                           : probability_by_power(task, number);
    }
    const Float3 to_hit = hit.position - from.position;
    const Float distance2 = dot(to_hit, to_hit);
    const Float cosine = -dot(hit.geometric_normal, ray.direction);
    const Float pdf_light = probability * distance2 / (cosine * light.area);
    const Float pdf_bounce = dot(ray.direction, from.normal) * (1.0f / kPi);
    return select(is_shared(task, light, from.position), pdf_bounce / (pdf_bounce + pdf_light),
                  splat(0.0f));
}

void add(float (&plane)[3][kBlockSamples], int at, Float3 light) {
    store(plane[0] + at, load<Float>(plane[0] + at) + light.x);
    store(plane[1] + at, load<Float>(plane[1] + at) + light.y);
    store(plane[2] + at, load<Float>(plane[2] + at) + light.z);
}

/// W paths from the camera on. Light found at vertex k went through k bounces.
class PathPacket {
  public:
    PathPacket(const TraceTask& task, const PathRandom& random) : task_(task), random_(random) {}

    /// surface: what the primary rays hit.
    void run(Tracer& tracer, const Surface& surface, Mask active, SampleBlock& block, int at) {
        const Float3 background = splat3(task_.background);
        surface_ = surface;
        add(block.emission, at,
            select(active, select(surface_.hit, tracer.emission(surface_), background), Float3{}));
        active_ = active & surface_.hit;
        throughput_ = surface_.albedo;
        for (int bounce = 1; bounce <= task_.max_depth; ++bounce) {
            active_ &= (throughput_.x + throughput_.y + throughput_.z) > 0.0f;
            if (!any(active_)) return;
            const Float3 light = next_vertex(tracer, bounce);
            add(bounce == 1 ? block.direct : block.indirect, at, light);
        }
    }

    /// All light that reaches a surface but that straight from emitters, as if its albedo were 1.
    /// Light of the background counts as direct. Returns one over the distances to what the bounces
    /// hit; 0 where that is nothing.
    Float gather(Tracer& tracer, const Surface& surface, Mask active, SampleBlock& block, int at) {
        surface_ = surface;
        throughput_ = {splat(1.0f), splat(1.0f), splat(1.0f)};
        mirror_ = Mask{};
        weighed_ = Mask{};
        const Ray ray = bounce_ray(random_.pair(2));
        active_ = active & (dot(ray.direction, surface_.normal) > 0.0f);
        if (!any(active_)) return Float{};
        if (task_.max_depth < 2 && !task_.has_background) return Float{};
        add(block.direct, at, follow(tracer, ray));  // what hides a background, too, is near or not
        const Float nearness = select(active_, 1.0f / surface_.distance, Float{});
        for (int bounce = 2; bounce <= task_.max_depth; ++bounce) {
            active_ &= (throughput_.x + throughput_.y + throughput_.z) > 0.0f;
            if (!any(active_)) break;
            add(block.indirect, at, next_vertex(tracer, bounce));
        }
        return nearness;
    }

  private:
    /// Light that reaches the path by its bounce-th bounce; moves on to the next vertex where one
    /// is needed.
    Float3 next_vertex(Tracer& tracer, int bounce) {
        const auto vertex = static_cast<std::uint32_t>(bounce - 1);
        const bool last = bounce == task_.max_depth;
        const bool by_light = task_.next_event_estimation;
        Float3 light{};
        mirror_ = active_ & tracer.mirrors(surface_);
        weighed_ = Mask{};
        if (by_light && task_.light_count > 0) {
            const Mask diffuse = active_ & ~mirror_;
            if (task_.multiple_importance) weighed_ = diffuse & weighed_surfaces(last);
            light = throughput_ * sample_direct(tracer, task_, surface_, {diffuse, weighed_},
                                                random_.pair(1 + 2 * vertex));
        }
        if (by_light && last && !task_.has_background) active_ &= weighed_ | mirror_;
        if (!any(active_)) return light;
        const Ray ray = bounce_ray(random_.pair(2 + 2 * vertex));
        // A direction below the true surface (possible with shading normals) carries nothing.
        active_ &= dot(ray.direction, surface_.normal) > 0.0f;
        if (by_light && last && !any(weighed_ | mirror_))
            return light + find_background(tracer, ray);
        return light + follow(tracer, ray);
    }

    /// The last surface's bounce would be traced for nothing else.
    Mask weighed_surfaces(bool last) const {
        return last ? active_ & is_near_emitters(task_, surface_.position) : active_;
    }

    Ray bounce_ray(Pair u) const {
        const Float3 diffuse = cosine_direction(surface_.shading_normal, u);
        if (!any(mirror_)) return {ray_origin(surface_), diffuse};
        return {ray_origin(surface_), select(mirror_, mirror_direction(surface_), diffuse)};
    }

    Float3 find_background(Tracer& tracer, const Ray& ray) const {
        const Mask blocked = tracer.occluded(ray, splat(__builtin_inff()), active_);
        return select(active_ & ~blocked, throughput_ * splat3(task_.background), Float3{});
    }

    Float3 follow(Tracer& tracer, const Ray& ray) {
        const Float3 background = splat3(task_.background);
        const Float3 throughput = throughput_;
        const Mask traced = active_;
        const Receiver from = {ray.origin, surface_.shading_normal};
        surface_ = tracer.trace(ray, traced);
        active_ = traced & surface_.hit;
        throughput_ = throughput * surface_.albedo;
        const Float3 emitted = found_light(tracer, from, ray);
        return select(traced, throughput * select(surface_.hit, emitted, background), Float3{});
    }

    /// Light of emitters that a bounce has hit, but for what next-event estimation stands for:
    /// nothing at a mirror.
    Float3 found_light(const Tracer& tracer, const Receiver& from, const Ray& ray) const {
        if (!task_.next_event_estimation) return tracer.emission(surface_);
        if (!any(weighed_ | mirror_)) return Float3{};
        const Int emitter = tracer.emitter(surface_);
        const Mask found = (weighed_ | mirror_) & (emitter >= 0);
        if (!any(found)) return Float3{};
        Float weight = splat(1.0f);
        if (any(found & ~mirror_))
            weight = select(mirror_, weight, bounce_weight(task_, from, ray, surface_, emitter));
        return select(found, tracer.emission(surface_) * weight, Float3{});
    }

    const TraceTask& task_;
    const PathRandom& random_;
    Surface surface_;
    Float3 throughput_;
    Mask active_;
    Mask mirror_;   ///< surfaces whose bounce stands for all light
    Mask weighed_;  ///< those whose bounce stands for a share of the light of emitters
};

Int lane_numbers() {
    Int lanes;
    for (int i = 0; i < W; ++i) lanes[i] = i;
    return lanes;
}

/// The sum of the lanes in a mask, in their order.
float sum(Float values, Mask lanes) {
    float total = 0.0f;
    for (int i = 0; i < W; ++i) total += lanes[i] != 0 ? values[i] : 0.0f;
    return total;
}

void add(GuideSums& sums, const Surface& s) {
    const auto add_vector = [&](float(&to)[3], const Float3& from) {
        to[0] += sum(from.x, s.hit);
        to[1] += sum(from.y, s.hit);
        to[2] += sum(from.z, s.hit);
    };
    add_vector(sums.albedo, s.albedo);
    add_vector(sums.normal_world, s.shading_normal);
}

std::uint64_t trace_samples(const TraceTask& task, const SampleRange& range, SampleBlock& block,
                            const PrimaryHits& kept) {
    __builtin_memset(&block, 0, sizeof block);
    Tracer tracer(task);
    const auto number =
        static_cast<std::uint32_t>(range.y) * static_cast<std::uint32_t>(task.width) +
        static_cast<std::uint32_t>(range.x);
    const std::uint32_t pixel = task.shares_samples ? 0 : number;
    for (int at = 0; at < range.count; at += W) {
        const Int lane = lane_numbers() + at;
        const Mask active = lane < range.count;
        const PathRandom random(task, pixel, (Uint)lane + range.first_sample);
        const Pair jitter = random.pair(0);
        const Ray primary = tracer.primary_ray(jitter.u + static_cast<float>(range.x),
                                               jitter.v + static_cast<float>(range.y));
        const Surface surface = tracer.trace(primary, active);
        if (at == 0 && kept.first != nullptr) record_first_hit(task, surface, 0, *kept.first);
        if (kept.sums != nullptr) add(*kept.sums, surface);
        PathPacket(task, random).run(tracer, surface, active, block, at);
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
        const Float3 emission =
            select(surface.hit, tracer.emission(surface), splat3(task.background));
        for (int i = 0; i < W && at + i < range.count; ++i) {
            record_first_hit(task, surface, i, out[at + i]);
            out[at + i].emission[0] = emission.x[i];
            out[at + i].emission[1] = emission.y[i];
            out[at + i].emission[2] = emission.z[i];
        }
    }
    return tracer.rays();
}

}  // namespace
}  // namespace vecino

// What builds on all of the above.
#include "core/cluster_lanes.h"
#include "core/further_lanes.h"
#include "core/gather_lanes.h"

namespace vecino {
namespace {

constexpr RecordKernel kRecordKernel = {trace_pilot, add_samples, add_few, gather_record};

}  // namespace

#define VECINO_CONCAT(a, b) a##b
#define VECINO_KERNEL_NAME(width) VECINO_CONCAT(kTraceKernel, width)
extern const TraceKernel VECINO_KERNEL_NAME(VECINO_WIDTH);
const TraceKernel VECINO_KERNEL_NAME(VECINO_WIDTH) = {VECINO_WIDTH, trace_samples, trace_centres,
                                                      &kRecordKernel};

}  // namespace vecino
