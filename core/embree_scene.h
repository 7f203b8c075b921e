// SPDX-License-Identifier: Apache-2.0
//
// Embree (3.13 or 4.x) behind one class: triangles and spheres in, packets of rays through. No
// Embree type leaves embree_scene.cpp. Plain data only, for the reason given in trace_task.h.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vecino {

constexpr std::uint32_t kNoPrimitive = 0xFFFFFFFFu;

/// Rays side by side. Directions are unit. Inactive lanes have active == 0, active ones -1.
template <int W>
struct alignas(64) RayPacket {
    float origin[3][W];
    float direction[3][W];
    float t_far[W];
    std::int32_t active[W];
};

/// Nearest hits. primitive: triangles count from 0, spheres go on from there; kNoPrimitive is a
/// miss.
template <int W>
struct alignas(64) HitPacket {
    float t[W];
    float u[W], v[W];  ///< barycentric, triangles only
    std::uint32_t primitive[W];
};

struct EmbreeGeometry {
    const float* triangle_corners;  ///< 9 floats a triangle
    std::size_t triangle_count;
    const float* spheres;  ///< 4 floats a sphere: centre, radius
    std::size_t sphere_count;
    /// Costs about 40 % more time: no ray slips through an edge that triangles share. Without it
    /// some 1 in 10^6 do on a fine closed mesh, none were seen on boxes made of quads.
    bool watertight;
};

class EmbreeScene {
  public:
    /// Copies the geometry. Throws std::runtime_error with Embree's reason.
    explicit EmbreeScene(const EmbreeGeometry& geometry);
    ~EmbreeScene();
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;

    /// Defined for W = 1, 4, 8, 16.
    template <int W>
    void intersect(const RayPacket<W>& rays, HitPacket<W>& hits) const;

    /// Sets blocked[i] to -1 where something lies before t_far, 0 where not or where the lane is
    /// inactive.
    template <int W>
    void occluded(const RayPacket<W>& rays, std::int32_t* blocked) const;

  private:
    struct Handles;
    Handles* handles_;
};

/// "3.13.5"
const char* embree_version();

}  // namespace vecino
