// SPDX-License-Identifier: Apache-2.0
//
// Some pixels of a render, traced again and again by one thread, and the same packets through
// Embree alone.
#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <vector>

#include "core/flat_scene.h"
#include "core/packet_replay.h"
#include "core/render.h"

namespace vecino {

class TraceBench {
  public:
    /// Pixels spread evenly over the frame; a pixel may be among them twice. Of the settings those
    /// of the number of threads and of planes play no part. Throws Error(usage) as render() does,
    /// and for a scene that is a pattern. pixel_count >= 1.
    TraceBench(const Scene& scene, const RenderSettings& settings, int pixel_count);

    /// Traces all pixels, to their means. Returns the number of rays.
    std::uint64_t trace() const;

    /// The packets of trace(), from every kind of ray.
    [[nodiscard]] const PacketLog& packets() const { return packets_; }
    [[nodiscard]] const EmbreeScene& embree() const { return *flat_.embree; }
    [[nodiscard]] int simd_width() const { return kernel_.width; }
    [[nodiscard]] std::uint64_t samples() const;  ///< that trace() takes

  private:
    std::uint64_t trace(const TraceTask& task) const;
    [[nodiscard]] PacketLog record() const;

    FlatScene flat_;
    TraceTask task_;
    const TraceKernel& kernel_;
    int spp_;
    std::vector<glm::ivec2> pixels_;
    PacketLog packets_;
};

}  // namespace vecino
