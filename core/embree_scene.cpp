// SPDX-License-Identifier: Apache-2.0
#include "core/embree_scene.h"

#include "core/embree_geometry.h"
#include "core/overlays.h"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace vecino {
namespace {

// Up to so many parallelograms are ours; with more, Embree's own quads are as fast: it goes on with
// single rays where packets fall apart deep down a tree.
constexpr std::size_t kMostParallelograms = 2048;

void bounds_of(const SphereShape& sphere, RTCBounds& box) {
    // One part in 2^20 wider, so that rounding cannot put a hit outside of its box.
    const float radius = sphere.radius * (1.0f + 1e-6f);
    box.lower_x = sphere.center[0] - radius;
    box.lower_y = sphere.center[1] - radius;
    box.lower_z = sphere.center[2] - radius;
    box.upper_x = sphere.center[0] + radius;
    box.upper_y = sphere.center[1] + radius;
    box.upper_z = sphere.center[2] + radius;
}

void bounds_of(const ParallelogramShape& shape, RTCBounds& box) {
    box.lower_x = shape.lower[0];
    box.lower_y = shape.lower[1];
    box.lower_z = shape.lower[2];
    box.upper_x = shape.upper[0];
    box.upper_y = shape.upper[1];
    box.upper_z = shape.upper[2];
}

/// Shapes of ours in a scene of Embree's.
template <class Shape>
struct Shapes {
    std::vector<Shape> list;
    std::vector<std::vector<unsigned>> overlays;  ///< find_overlays; empty: none
};

/// The functions that Embree calls for shapes of ours.
template <class Shape>
struct Callbacks {
    static const Shapes<Shape>& shapes(void* user_data) {
        return *static_cast<const Shapes<Shape>*>(user_data);
    }
    static const Shape& shape(void* user_data, unsigned number) {
        return shapes(user_data).list[number];
    }

    static void bounds(const RTCBoundsFunctionArguments* args) {
        bounds_of(shape(args->geometryUserPtr, args->primID), *args->bounds_o);
    }

    static void intersect(const RTCIntersectFunctionNArguments* args) {
        const unsigned n = args->N;
        RTCRayN* const rays = RTCRayHitN_RayN(args->rayhit, n);
        RTCHitN* const hits = RTCRayHitN_HitN(args->rayhit, n);
        const RayRows rows{reinterpret_cast<float*>(rays), args->valid, n};
        HitRows hit_rows{&RTCHitN_primID(hits, n, 0), &RTCHitN_geomID(hits, n, 0), args->primID,
                         args->geomID};
        const Shapes<Shape>& all = shapes(args->geometryUserPtr);
        vecino::intersect(all.list[args->primID], rows, hit_rows);
        if constexpr (std::is_same_v<Shape, ParallelogramShape>) {
            if (all.overlays.empty()) return;
            for (const unsigned above : all.overlays[args->primID]) {
                hit_rows.primitive_id = above;
                intersect_overlay(all.list[above], rows, hit_rows);
            }
        }
    }

    static void occluded(const RTCOccludedFunctionNArguments* args) {
        const RayRows rows{reinterpret_cast<float*>(args->ray), args->valid, args->N};
        occlude(shape(args->geometryUserPtr, args->primID), rows);
    }
};

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

template <class T>
T* new_buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, std::size_t count) {
    const std::size_t bytes = sizeof(T) * (format == RTC_FORMAT_UINT4 ? 4 : 3);
    void* const buffer = rtcSetNewGeometryBuffer(geometry, type, 0, format, bytes, count);
    if (buffer == nullptr) throw std::runtime_error("Embree: no memory");
    return static_cast<T*>(buffer);
}

void number(std::uint32_t* indices, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) indices[i] = static_cast<std::uint32_t>(i);
}

void attach_triangles(RTCDevice device, RTCScene scene, const EmbreeGeometry& input) {
    Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
    const std::size_t corners = 3 * input.triangle_count;
    auto* const positions =
        new_buffer<float>(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, corners);
    std::memcpy(positions, input.triangle_corners, corners * 3 * sizeof(float));
    number(new_buffer<std::uint32_t>(geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3,
                                     input.triangle_count),
           corners);
    attach(scene, std::move(geometry), kTriangles);
}

// Embree cuts a quad from its second corner to its fourth, a scene from the first to the third: the
// corners start one later.
void attach_quads(RTCDevice device, RTCScene scene, const EmbreeGeometry& input) {
    Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD));
    const std::size_t corners = 4 * input.quad_count;
    auto* const positions =
        new_buffer<float>(geometry.get(), RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, corners);
    for (std::size_t i = 0; i < corners; ++i)
        std::memcpy(positions + 3 * i, &input.quads[i / 4][(i + 1) % 4], 3 * sizeof(float));
    number(new_buffer<std::uint32_t>(geometry.get(), RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT4,
                                     input.quad_count),
           corners);
    attach(scene, std::move(geometry), kQuads);
}

/// Shapes of ours; they must outlive the scene.
template <class Shape>
void attach_shapes(RTCDevice device, RTCScene scene, Shapes<Shape>& shapes, unsigned id) {
    Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER));
    rtcSetGeometryUserPrimitiveCount(geometry.get(), static_cast<unsigned>(shapes.list.size()));
    rtcSetGeometryUserData(geometry.get(), &shapes);
    rtcSetGeometryBoundsFunction(geometry.get(), Callbacks<Shape>::bounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry.get(), Callbacks<Shape>::intersect);
    rtcSetGeometryOccludedFunction(geometry.get(), Callbacks<Shape>::occluded);
    attach(scene, std::move(geometry), id);
}

// The packet calls of Embree by width, and the one difference between its versions 3 and 4.
#if RTC_VERSION_MAJOR >= 4
#define VECINO_CALL(function, valid, scene, ray) function(valid, scene, ray, &args.value)
#define VECINO_CALL_ONE(function, scene, ray) function(scene, ray, &args.value)
struct IntersectArguments {
    RTCIntersectArguments value;
    explicit IntersectArguments(Rays rays) {
        rtcInitIntersectArguments(&value);
        if (rays == Rays::coherent) value.flags = RTC_RAY_QUERY_FLAG_COHERENT;
    }
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
    explicit IntersectArguments(Rays rays = Rays::scattered) {
        rtcInitIntersectContext(&value);
        if (rays == Rays::coherent) value.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }
};
using OccludedArguments = IntersectArguments;
#endif

template <int W>
struct Packet;
#define VECINO_PACKET(W)                                                                  \
    template <>                                                                           \
    struct Packet<W> {                                                                    \
        using Ray = RTCRay##W;                                                            \
        using RayHit = RTCRayHit##W;                                                      \
        static void intersect(const int* valid, RTCScene scene, RayHit* ray, Rays rays) { \
            IntersectArguments args(rays);                                                \
            VECINO_CALL(rtcIntersect##W, valid, scene, ray);                              \
        }                                                                                 \
        static void occluded(const int* valid, RTCScene scene, Ray* ray) {                \
            OccludedArguments args;                                                       \
            VECINO_CALL(rtcOccluded##W, valid, scene, ray);                               \
        }                                                                                 \
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
    static void intersect(const int* valid, RTCScene scene, RayHit* ray, Rays rays) {
        IntersectArguments args(rays);
        if (*valid != 0) VECINO_CALL_ONE(rtcIntersect1, scene, reinterpret_cast<RTCRayHit*>(ray));
    }
    static void occluded(const int* valid, RTCScene scene, Ray* ray) {
        OccludedArguments args;
        if (*valid != 0) VECINO_CALL_ONE(rtcOccluded1, scene, reinterpret_cast<RTCRay*>(ray));
    }
};

template <int W>
constexpr bool kSameLayout =
    offsetof(RayPacket<W>, origin) == offsetof(typename Packet<W>::Ray, org_x) &&
    offsetof(RayPacket<W>, t_near) == offsetof(typename Packet<W>::Ray, tnear) &&
    offsetof(RayPacket<W>, direction) == offsetof(typename Packet<W>::Ray, dir_x) &&
    offsetof(RayPacket<W>, time) == offsetof(typename Packet<W>::Ray, time) &&
    offsetof(RayPacket<W>, t_far) == offsetof(typename Packet<W>::Ray, tfar) &&
    offsetof(RayPacket<W>, mask) == offsetof(typename Packet<W>::Ray, mask) &&
    sizeof(RayPacket<W>) == sizeof(typename Packet<W>::Ray) &&
    offsetof(HitPacket<W>, normal) == offsetof(typename Packet<W>::RayHit, hit.Ng_x) &&
    offsetof(HitPacket<W>, u) == offsetof(typename Packet<W>::RayHit, hit.u) &&
    offsetof(HitPacket<W>, primitive) == offsetof(typename Packet<W>::RayHit, hit.primID) &&
    offsetof(HitPacket<W>, geometry) == offsetof(typename Packet<W>::RayHit, hit.geomID) &&
    sizeof(HitPacket<W>) >= sizeof(typename Packet<W>::RayHit);

}  // namespace

struct EmbreeScene::Handles {
    Device device;
    Owned<RTCScene, ReleaseScene> scene;
    Shapes<SphereShape> spheres;
    Shapes<ParallelogramShape> parallelograms;
    bool is_large = false;

    /// In a small tree, to keep rays together costs more than it saves.
    [[nodiscard]] Rays worth_it(Rays rays) const { return is_large ? rays : Rays::scattered; }
};

EmbreeScene::EmbreeScene(const EmbreeGeometry& geometry) : handles_(nullptr) {
    auto handles = std::make_unique<Handles>();
    handles->device.reset(rtcNewDevice(nullptr));
    if (!handles->device) throw std::runtime_error("Embree: no device");
    handles->scene.reset(rtcNewScene(handles->device.get()));
    // Else rays slip between neighbouring triangles, the two halves of a quad among them.
    if (geometry.watertight || geometry.quad_count > kMostParallelograms)
        rtcSetSceneFlags(handles->scene.get(), RTC_SCENE_FLAG_ROBUST);
    RTCDevice const device = handles->device.get();
    RTCScene const scene = handles->scene.get();
    handles->spheres.list.assign(geometry.spheres, geometry.spheres + geometry.sphere_count);
    if (geometry.quad_count > kMostParallelograms) {
        attach_quads(device, scene, geometry);
    } else if (geometry.quad_count > 0) {
        for (std::size_t i = 0; i < geometry.quad_count; ++i)
            handles->parallelograms.list.push_back(parallelogram_shape(geometry.quads[i]));
        handles->parallelograms.overlays =
            find_overlays({geometry.quads, geometry.quad_count}, handles->parallelograms.list);
        attach_shapes(device, scene, handles->parallelograms, kQuads);
    }
    if (geometry.triangle_count > 0) attach_triangles(device, scene, geometry);
    if (geometry.sphere_count > 0) attach_shapes(device, scene, handles->spheres, kSpheres);
    constexpr std::size_t kFew = 32;
    handles->is_large =
        geometry.quad_count + geometry.triangle_count + geometry.sphere_count > kFew;
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
void EmbreeScene::intersect(const std::int32_t (&active)[W], HitPacket<W>& hits, Rays rays) const {
    static_assert(kSameLayout<W>);
    Packet<W>::intersect(active, handles_->scene.get(),
                         reinterpret_cast<typename Packet<W>::RayHit*>(&hits),
                         handles_->worth_it(rays));
}

template <int W>
void EmbreeScene::occluded(const std::int32_t (&active)[W], RayPacket<W>& rays) const {
    Packet<W>::occluded(active, handles_->scene.get(),
                        reinterpret_cast<typename Packet<W>::Ray*>(&rays));
}

#define VECINO_INSTANTIATE(W)                                                                     \
    template void EmbreeScene::intersect<W>(const std::int32_t(&)[W], HitPacket<W>&, Rays) const; \
    template void EmbreeScene::occluded<W>(const std::int32_t(&)[W], RayPacket<W>&) const;
VECINO_INSTANTIATE(1)
VECINO_INSTANTIATE(4)
VECINO_INSTANTIATE(8)
VECINO_INSTANTIATE(16)

const char* embree_version() {
    return RTC_VERSION_STRING;
}

}  // namespace vecino
