// SPDX-License-Identifier: Apache-2.0
#include "core/embree_scene.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

// The sphere test is compiled for several instruction sets; the loader picks one.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__)
#define VECINO_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define VECINO_CLONES
#endif

namespace vecino {
namespace {

constexpr int kMaxPacket = 16;
constexpr unsigned kTriangles = 0;
constexpr unsigned kSpheres = 1;

struct SphereData {
    float center[3];
    float radius;
};

// Up to 16 rays against one sphere: t of the nearest hit in (t_near, t_far), or t_far where there
// is none. The discriminant is taken from the distance of the centre to the ray, which keeps its
// digits when the sphere is far away (Haines et al., Ray Tracing Gems, chapter 7).
VECINO_CLONES void nearest_sphere_hits(const SphereData& sphere, const float* rays, unsigned n,
                                       float* __restrict nearest) {
    const float* const ox = rays;
    const float* const oy = rays + n;
    const float* const oz = rays + 2 * n;
    const float* const t_near = rays + 3 * n;
    const float* const dx = rays + 4 * n;
    const float* const dy = rays + 5 * n;
    const float* const dz = rays + 6 * n;
    const float* const t_far = rays + 8 * n;
    for (unsigned i = 0; i < n; ++i) {
        const float fx = sphere.center[0] - ox[i];
        const float fy = sphere.center[1] - oy[i];
        const float fz = sphere.center[2] - oz[i];
        const float a = dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i];
        const float along = fx * dx[i] + fy * dy[i] + fz * dz[i];
        const float closest = along / a;
        const float ex = fx - closest * dx[i];
        const float ey = fy - closest * dy[i];
        const float ez = fz - closest * dz[i];
        const float rr = sphere.radius * sphere.radius;
        const float discriminant = rr - (ex * ex + ey * ey + ez * ez);
        const float root = std::sqrt(a * (discriminant > 0.0f ? discriminant : 0.0f));
        const float q = along + (along < 0.0f ? -root : root);
        const float c = fx * fx + fy * fy + fz * fz - rr;
        const float s = c / q;
        const float t = q / a;
        const float first = s < t ? s : t;
        const float second = s < t ? t : s;
        float hit = first > t_near[i] ? first : second;
        hit = hit > t_near[i] && hit < t_far[i] && discriminant > 0.0f ? hit : t_far[i];
        nearest[i] = hit;
    }
}

void sphere_bounds(const RTCBoundsFunctionArguments* args) {
    const auto& sphere = static_cast<const SphereData*>(args->geometryUserPtr)[args->primID];
    // One part in 2^20 wider, so that rounding cannot put a hit outside of its box.
    const float radius = sphere.radius * (1.0f + 1e-6f);
    RTCBounds& box = *args->bounds_o;
    box.lower_x = sphere.center[0] - radius;
    box.lower_y = sphere.center[1] - radius;
    box.lower_z = sphere.center[2] - radius;
    box.upper_x = sphere.center[0] + radius;
    box.upper_y = sphere.center[1] + radius;
    box.upper_z = sphere.center[2] + radius;
}

void intersect_sphere(const RTCIntersectFunctionNArguments* args) {
    const auto& sphere = static_cast<const SphereData*>(args->geometryUserPtr)[args->primID];
    RTCRayN* const rays = RTCRayHitN_RayN(args->rayhit, args->N);
    RTCHitN* const hits = RTCRayHitN_HitN(args->rayhit, args->N);
    float nearest[kMaxPacket];
    nearest_sphere_hits(sphere, reinterpret_cast<const float*>(rays), args->N, nearest);
    for (unsigned i = 0; i < args->N; ++i) {
        float& t_far = RTCRayN_tfar(rays, args->N, i);
        if (args->valid[i] == 0 || !(nearest[i] < t_far)) continue;
        t_far = nearest[i];
        RTCHitN_geomID(hits, args->N, i) = args->geomID;
        RTCHitN_primID(hits, args->N, i) = args->primID;
    }
}

void occlude_sphere(const RTCOccludedFunctionNArguments* args) {
    const auto& sphere = static_cast<const SphereData*>(args->geometryUserPtr)[args->primID];
    float nearest[kMaxPacket];
    nearest_sphere_hits(sphere, reinterpret_cast<const float*>(args->ray), args->N, nearest);
    for (unsigned i = 0; i < args->N; ++i) {
        float& t_far = RTCRayN_tfar(args->ray, args->N, i);
        if (args->valid[i] == 0 || !(nearest[i] < t_far)) continue;
        t_far = -std::numeric_limits<float>::infinity();
    }
}

struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct ReleaseGeometry {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
template <class Handle, class Release>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;
using Device = Owned<RTCDevice, ReleaseDevice>;
using Geometry = Owned<RTCGeometry, ReleaseGeometry>;

void attach(RTCScene scene, Geometry geometry, unsigned id) {
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometryByID(scene, geometry.get(), id);
}

void attach_triangles(RTCDevice device, RTCScene scene, const EmbreeGeometry& input) {
    Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
    const std::size_t corners = 3 * input.triangle_count;
    void* const positions = rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                                    RTC_FORMAT_FLOAT3, 3 * sizeof(float), corners);
    auto* const indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), input.triangle_count));
    if (positions == nullptr || indices == nullptr) throw std::runtime_error("Embree: no memory");
    std::memcpy(positions, input.triangle_corners, corners * 3 * sizeof(float));
    for (std::size_t i = 0; i < corners; ++i) indices[i] = static_cast<std::uint32_t>(i);
    attach(scene, std::move(geometry), kTriangles);
}

void attach_spheres(RTCDevice device, RTCScene scene, std::vector<SphereData>& spheres) {
    Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER));
    rtcSetGeometryUserPrimitiveCount(geometry.get(), static_cast<unsigned>(spheres.size()));
    rtcSetGeometryUserData(geometry.get(), spheres.data());
    rtcSetGeometryBoundsFunction(geometry.get(), sphere_bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry.get(), intersect_sphere);
    rtcSetGeometryOccludedFunction(geometry.get(), occlude_sphere);
    attach(scene, std::move(geometry), kSpheres);
}

// The packet calls of Embree by width, and the one difference between its versions 3 and 4.
#if RTC_VERSION_MAJOR >= 4
#define VECINO_CALL(function, valid, scene, ray) function(valid, scene, ray, &args.value)
#define VECINO_CALL_ONE(function, scene, ray) function(scene, ray, &args.value)
struct IntersectArguments {
    RTCIntersectArguments value;
    IntersectArguments() { rtcInitIntersectArguments(&value); }
};
struct OccludedArguments {
    RTCOccludedArguments value;
    OccludedArguments() { rtcInitOccludedArguments(&value); }
};
#else
#define VECINO_CALL(function, valid, scene, ray) function(valid, scene, &args.value, ray)
#define VECINO_CALL_ONE(function, scene, ray) function(scene, &args.value, ray)
struct IntersectArguments {
    RTCIntersectContext value;
    IntersectArguments() { rtcInitIntersectContext(&value); }
};
using OccludedArguments = IntersectArguments;
#endif

template <int W>
struct Packet;
#define VECINO_PACKET(W)                                                       \
    template <>                                                                \
    struct Packet<W> {                                                         \
        using Ray = RTCRay##W;                                                 \
        using RayHit = RTCRayHit##W;                                           \
        static void intersect(const int* valid, RTCScene scene, RayHit* ray) { \
            IntersectArguments args;                                           \
            VECINO_CALL(rtcIntersect##W, valid, scene, ray);                   \
        }                                                                      \
        static void occluded(const int* valid, RTCScene scene, Ray* ray) {     \
            OccludedArguments args;                                            \
            VECINO_CALL(rtcOccluded##W, valid, scene, ray);                    \
        }                                                                      \
    };
VECINO_PACKET(4)
VECINO_PACKET(8)
VECINO_PACKET(16)

/// One ray has no mask, and its fields are no arrays: it is a packet of one all the same.
template <>
struct Packet<1> {
    using Ray = RTCRayNt<1>;
    struct alignas(16) RayHit {
        RTCRayNt<1> ray;
        RTCHitNt<1> hit;
    };
    static_assert(sizeof(RayHit) == sizeof(RTCRayHit) && sizeof(Ray) == sizeof(RTCRay));
    static void intersect(const int* valid, RTCScene scene, RayHit* ray) {
        IntersectArguments args;
        ray->hit.u[0] = ray->hit.v[0] = 0.0f;  // which a miss or an inactive ray leaves alone
        if (*valid != 0) VECINO_CALL_ONE(rtcIntersect1, scene, reinterpret_cast<RTCRayHit*>(ray));
    }
    static void occluded(const int* valid, RTCScene scene, Ray* ray) {
        OccludedArguments args;
        if (*valid != 0) VECINO_CALL_ONE(rtcOccluded1, scene, reinterpret_cast<RTCRay*>(ray));
    }
};

template <int W, class Ray>
void load_rays(const RayPacket<W>& rays, Ray& out) {
    constexpr std::size_t kBytes = W * sizeof(float);
    std::memcpy(out.org_x, rays.origin[0], kBytes);
    std::memcpy(out.org_y, rays.origin[1], kBytes);
    std::memcpy(out.org_z, rays.origin[2], kBytes);
    std::memcpy(out.dir_x, rays.direction[0], kBytes);
    std::memcpy(out.dir_y, rays.direction[1], kBytes);
    std::memcpy(out.dir_z, rays.direction[2], kBytes);
    std::memcpy(out.tfar, rays.t_far, kBytes);
    std::memset(out.tnear, 0, kBytes);
    std::memset(out.time, 0, kBytes);
    std::memset(out.mask, 0xFF, kBytes);
    std::memset(out.flags, 0, kBytes);
}

}  // namespace

struct EmbreeScene::Handles {
    Device device;
    Owned<RTCScene, ReleaseScene> scene;
    std::vector<SphereData> spheres;
    std::uint32_t triangle_count = 0;
};

EmbreeScene::EmbreeScene(const EmbreeGeometry& geometry) : handles_(nullptr) {
    auto handles = std::make_unique<Handles>();
    handles->device.reset(rtcNewDevice(nullptr));
    if (!handles->device) throw std::runtime_error("Embree: no device");
    handles->scene.reset(rtcNewScene(handles->device.get()));
    if (geometry.watertight) rtcSetSceneFlags(handles->scene.get(), RTC_SCENE_FLAG_ROBUST);
    handles->triangle_count = static_cast<std::uint32_t>(geometry.triangle_count);
    const auto* const spheres = reinterpret_cast<const SphereData*>(geometry.spheres);
    handles->spheres.assign(spheres, spheres + geometry.sphere_count);
    RTCScene const scene = handles->scene.get();
    if (geometry.triangle_count > 0) attach_triangles(handles->device.get(), scene, geometry);
    if (geometry.sphere_count > 0) attach_spheres(handles->device.get(), scene, handles->spheres);
    rtcCommitScene(scene);
    const RTCError error = rtcGetDeviceError(handles->device.get());
    if (error != RTC_ERROR_NONE) {
        throw std::runtime_error("Embree: error " + std::to_string(static_cast<int>(error)));
    }
    handles_ = handles.release();
}

EmbreeScene::~EmbreeScene() {
    delete handles_;
}

template <int W>
void EmbreeScene::intersect(const RayPacket<W>& rays, HitPacket<W>& hits) const {
    alignas(64) typename Packet<W>::RayHit packet;
    load_rays(rays, packet.ray);
    std::memset(packet.hit.geomID, 0xFF, sizeof packet.hit.geomID);
    std::memset(packet.hit.instID, 0xFF, sizeof packet.hit.instID);
    Packet<W>::intersect(rays.active, handles_->scene.get(), &packet);
    std::memcpy(hits.t, packet.ray.tfar, sizeof hits.t);
    std::memcpy(hits.u, packet.hit.u, sizeof hits.u);
    std::memcpy(hits.v, packet.hit.v, sizeof hits.v);
    for (int i = 0; i < W; ++i) {
        const unsigned geometry = packet.hit.geomID[i];
        const std::uint32_t base = geometry == kSpheres ? handles_->triangle_count : 0;
        const bool miss = geometry == RTC_INVALID_GEOMETRY_ID || rays.active[i] == 0;
        hits.primitive[i] = miss ? kNoPrimitive : packet.hit.primID[i] + base;
    }
}

template <int W>
void EmbreeScene::occluded(const RayPacket<W>& rays, std::int32_t* blocked) const {
    alignas(64) typename Packet<W>::Ray packet;
    load_rays(rays, packet);
    Packet<W>::occluded(rays.active, handles_->scene.get(), &packet);
    for (int i = 0; i < W; ++i) blocked[i] = packet.tfar[i] < 0.0f ? rays.active[i] : 0;
}

template void EmbreeScene::intersect<1>(const RayPacket<1>&, HitPacket<1>&) const;
template void EmbreeScene::intersect<4>(const RayPacket<4>&, HitPacket<4>&) const;
template void EmbreeScene::intersect<8>(const RayPacket<8>&, HitPacket<8>&) const;
template void EmbreeScene::intersect<16>(const RayPacket<16>&, HitPacket<16>&) const;
template void EmbreeScene::occluded<1>(const RayPacket<1>&, std::int32_t*) const;
template void EmbreeScene::occluded<4>(const RayPacket<4>&, std::int32_t*) const;
template void EmbreeScene::occluded<8>(const RayPacket<8>&, std::int32_t*) const;
template void EmbreeScene::occluded<16>(const RayPacket<16>&, std::int32_t*) const;

const char* embree_version() {
    return RTC_VERSION_STRING;
}

}  // namespace vecino
