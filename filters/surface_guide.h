// SPDX-License-Identifier: Apache-2.0
//
// What a method knows of the scene before it traces light: the first hit at the centre of every
// pixel, which pixels show the same surface, and which have to be traced whatever stands around.
#pragma once

#include <cstdint>
#include <vector>

#include "core/frame_planes.h"
#include "core/scene.h"
#include "core/trace_task.h"

namespace vecino {

struct GuideSettings {
    Extent size;              ///< of the traced frame
    float min_normal_cosine;  ///< -1 to 1: normals of one surface have a larger cosine
    int threads;
};

class SurfaceGuide {
  public:
    /// hits: of the pixels' centres, row by row.
    SurfaceGuide(std::vector<FirstHitRecord> hits, const Scene& scene,
                 const GuideSettings& settings);

    [[nodiscard]] Extent size() const { return settings_.size; }
    [[nodiscard]] const std::vector<FirstHitRecord>& hits() const { return hits_; }
    [[nodiscard]] const FirstHitRecord& hit(std::size_t pixel) const { return hits_[pixel]; }
    [[nodiscard]] bool is_miss(std::size_t pixel) const;

    /// Whether two pixels show one surface: the same object, normals of a like direction, and
    /// neither hit farther than a footprint from the tangent plane of the other. Misses are one
    /// surface.
    [[nodiscard]] bool is_same_surface(std::size_t a, std::size_t b) const;
    /// Whether normals alone are alike: the gate of the thesis. A miss is like nothing.
    [[nodiscard]] bool has_like_normal(std::size_t a, std::size_t b) const;
    /// Between two hits, in footprints of the first: widths of its pixel at its distance. Of two
    /// misses, in pixels.
    [[nodiscard]] double distance(std::size_t from, std::size_t to) const;

    /// Some pixel around it shows another surface, so that it shows both.
    [[nodiscard]] bool is_edge(std::size_t pixel) const { return (marks_[pixel] & kEdge) != 0; }
    /// Its light does not follow from the light around it: an edge, an emitter or a mirror.
    [[nodiscard]] bool must_trace(std::size_t pixel) const { return marks_[pixel] != 0; }

  private:
    static constexpr std::uint8_t kEdge = 1;
    static constexpr std::uint8_t kSpecial = 2;

    void mark(std::size_t pixel, const Scene& scene);
    [[nodiscard]] float footprint(std::size_t pixel) const;

    std::vector<FirstHitRecord> hits_;
    GuideSettings settings_;
    float pixel_angle_;  ///< width of a pixel at distance 1
    std::vector<std::uint8_t> marks_;
};

}  // namespace vecino
