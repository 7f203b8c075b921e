// SPDX-License-Identifier: Apache-2.0
//
// Embree (3.13 or 4.x) behind one class: triangles and spheres in, packets of rays through. No
// Embree type leaves embree_scene.cpp. Plain data only, for the reason given in trace_task.h.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vecino {

/// Rays side by side, laid out as Embree's own packets are, so that none is copied.
template <int W>
struct alignas(W == 1 ? 16 : 64) RayPacket {
    float origin[3][W];
    float t_near[W];
    float direction[3][W];  ///< of any length but 0; t counts in lengths of it
    float time[W];          ///< read by no geometry of ours
    float t_far[W];
    std::uint32_t mask[W];  ///< all ones
    std::uint32_t unread[2][W];
};

/// Rays, and what they hit: geometry is an EmbreeKind, or kNoGeometry, which it must be before.
template <int W>
struct alignas(W == 1 ? 16 : 64) HitPacket {
    RayPacket<W> ray;  ///< t_far: of the hit
    float normal[3][W];
    float u[W], v[W];  ///< barycentric, triangles only
    std::uint32_t primitive[W];
    std::uint32_t geometry[W];
    std::uint32_t instance[4][W];  ///< room for what versions of Embree keep here
};

/// The kinds of geometry. Primitives of each are counted from 0.
enum EmbreeKind : std::uint32_t { kQuads = 0, kTriangles = 1, kSpheres = 2 };

constexpr std::uint32_t kNoGeometry = 0xFFFFFFFFu;

struct EmbreeGeometry;  // embree_geometry.h

/// How those of a packet lie to each other. Hits do not depend on it, the time does.
enum class Rays {
    scattered,  ///< anyhow
    coherent,   ///< about the same way from about the same place: they are traversed together
};

class EmbreeScene {
  public:
    /// Copies the geometry. Throws std::runtime_error with Embree's reason.
    explicit EmbreeScene(const EmbreeGeometry& geometry);
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    /// Rays whose active is -1; those of 0 are left alone. Defined for W = 1, 4,
    /// 8, 16.
    template <int W>
    void intersect(const std::int32_t (&active)[W], HitPacket<W>& hits, Rays rays) const;

    /// Sets t_far to -infinity where something lies before it.
    template <int W>
    void occluded(const std::int32_t (&active)[W], RayPacket<W>& rays) const;

  private:
    struct Handles;
    Handles* handles_;
};

/// "3.13.5"
const char* embree_version();

}  // namespace vecino
