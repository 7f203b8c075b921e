// SPDX-License-Identifier: Apache-2.0
//
// A frame of which a method traces some pixels and makes the others from those. A traced pixel has
// the bits that path tracing gives it.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <optional>
#include <span>
#include <vector>

#include "core/pixel_tracer.h"
#include "filters/methods.h"
#include "filters/surface_guide.h"

namespace vecino {

using PixelList = std::vector<std::uint32_t>;

/// Weighted sums of what pixels hold, and of their albedos, so that light and albedo can be told
/// apart: what reaches a surface varies less than what it sends on.
class Blend {
  public:
    void add(const Frame& from, std::size_t pixel, const FirstHitRecord& hit, double weight);
    /// Of all weights so far.
    [[nodiscard]] double weight() const { return weight_; }
    /// The mean, with the light that reflects brought to a surface of another albedo, or as it is.
    /// Its samples are 0. Precondition: weight() is positive.
    [[nodiscard]] PixelValues values(std::optional<glm::vec3> albedo) const;

  private:
    double weight_ = 0;
    glm::dvec3 emission_{0.0}, direct_{0.0}, indirect_{0.0}, albedo_{0.0};
    glm::dvec3 variance_{0.0};  ///< of weighted sums
};

/// The weight of a source from its distance, for Weighting; mean_distance is that of all sources.
double source_weight(Weighting weighting, double distance, double mean_distance);

class PartialFrame {
  public:
    /// Traces the first hits of all pixel centres. Throws as render() does.
    PartialFrame(const MethodRequest& request, const Progress& progress);

    [[nodiscard]] Extent size() const { return guide_->size(); }
    [[nodiscard]] std::size_t area() const { return size().area(); }
    [[nodiscard]] const SurfaceGuide& guide() const { return *guide_; }
    /// Emission, direct, indirect and sample_count are there, whatever was asked for.
    [[nodiscard]] const Frame& frame() const { return frame_; }
    [[nodiscard]] PixelTracer& tracer() { return tracer_; }

    [[nodiscard]] bool is_traced(std::size_t pixel) const { return is_traced_[pixel] != 0; }
    /// Traced, finite, and of one surface that neither shines nor mirrors: light for its neighbours
    /// may come from it.
    [[nodiscard]] bool is_source(std::size_t pixel) const;

    /// Reader of the samples of a pixel, or none.
    using ReaderOf = std::function<BlockReader(std::size_t pixel)>;
    /// Traces pixels with all their samples. Each is traced once.
    void trace(const PixelList& pixels, const ReaderOf& reader_of = {});
    /// Traces all pixels, each with samples of its own.
    void trace_all(const std::function<SampleInterval(Pixel)>& samples_of);

    /// Gives a pixel that is not traced its values. Several threads may, for different pixels.
    void store(std::size_t pixel, const PixelValues& values);
    /// The same from a blend, for the pixel's own albedo.
    void store(std::size_t pixel, const Blend& blend);

    /// Runs body for all pixels of a list, or of the frame, in parallel.
    void for_each(const PixelList& pixels, const std::function<void(std::size_t)>& body) const;
    void for_each(const std::function<void(std::size_t)>& body) const;

    /// The frame with the planes that were asked for, times, and what holds for all methods as
    /// facts: traced_share, interpolated_share, passes, mean_spp. Ends this frame's life.
    MethodRender finish(nlohmann::json facts);

  private:
    void store_traced(PixelTrace& pixel);
    void add_first_hits(Frame& frame);

    const MethodRequest& request_;
    const Progress& progress_;
    Stopwatch watch_;
    PixelTracer tracer_;
    std::optional<SurfaceGuide> guide_;
    Frame frame_;
    std::vector<std::uint8_t> is_traced_;
    std::size_t traced_ = 0;
    int passes_ = 0;
};

}  // namespace vecino
