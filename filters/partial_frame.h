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
#include "core/timing.h"
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

/// Part of a whole, as a number for facts.
inline double share(std::size_t part, std::size_t whole) {
    return static_cast<double>(part) / static_cast<double>(whole);
}

/// A pixel that another takes light from, and how far apart their hits are, in any unit.
struct Source {
    std::uint32_t pixel;
    double distance;
};

class PartialFrame {
  public:
    /// Traces the first hits of all pixel centres. Throws as render() does.
    PartialFrame(const MethodRequest& request, const Progress& progress);
    /// The same, where the method needs the variance whether or not its plane was asked for.
    PartialFrame(const MethodRequest& request, const Progress& progress, VarianceOf variance_of);

    [[nodiscard]] Extent size() const { return guide_->size(); }
    [[nodiscard]] std::size_t area() const { return size().area(); }
    [[nodiscard]] const SurfaceGuide& guide() const { return *guide_; }
    /// Emission, direct, indirect and sample_count are there, whatever was asked for.
    [[nodiscard]] const Frame& frame() const { return frame_; }
    [[nodiscard]] PixelTracer& tracer() { return tracer_; }

    [[nodiscard]] bool is_traced(std::size_t pixel) const { return state_[pixel] != kUntraced; }
    [[nodiscard]] bool is_finite(std::size_t pixel) const { return state_[pixel] == kFinite; }
    /// Traced, finite, and of one surface: the light of others of that surface may come from it.
    [[nodiscard]] bool is_source(std::size_t pixel) const {
        return is_finite(pixel) && !guide_->is_edge(pixel);
    }

    /// Reader of the samples of a pixel, or none.
    using ReaderOf = std::function<BlockReader(std::size_t pixel)>;
    /// Traces pixels with all their samples. Each is traced once.
    void trace(const PixelList& pixels, const ReaderOf& reader_of = {});
    /// Traces all pixels, each with the samples that body asks for.
    void trace_all(const std::function<void(PixelTrace&)>& body);
    /// Says which sample of a pixel is its first one, where that is not number 0.
    void begin_samples_at(std::function<int(Pixel)> first) { first_samples_ = std::move(first); }
    /// Traces pixels further: body asks for samples, and tells what all so far come to.
    void trace(const PixelList& pixels, const std::function<PixelValues(PixelTrace&)>& body,
               const Progress& progress);

    /// Gives a pixel that is not traced its values. Several threads may, for different pixels.
    void store(std::size_t pixel, const PixelValues& values);
    /// The same from a blend, for the pixel's own albedo.
    void store(std::size_t pixel, const Blend& blend);
    /// Gives a traced pixel the light of a blend, for its own albedo; what it shines itself stays.
    void filter(std::size_t pixel, const Blend& blend);

    /// Of sources, weighted by their distances.
    [[nodiscard]] Blend blend(const std::vector<Source>& sources, Weighting weighting) const;

    /// Runs body for all pixels of a list, or of the frame, in parallel.
    void for_each(const PixelList& pixels, const std::function<void(std::size_t)>& body) const;
    void for_each(const std::function<void(std::size_t)>& body) const;

    /// The frame with the planes that were asked for, times, and what holds for all methods as
    /// facts: traced_share, interpolated_share, passes, mean_spp. Ends this frame's life.
    MethodRender finish(nlohmann::json facts);

  private:
    using SamplesOf = std::function<SampleInterval(std::size_t)>;
    static constexpr std::uint8_t kUntraced = 0, kFinite = 1, kNonFinite = 2;

    void store_traced(PixelTrace& pixel, const PixelValues& values);
    /// Those of a traced pixel, or those that it would have had.
    [[nodiscard]] SampleInterval samples_of(std::size_t pixel) const;
    void add_first_hits(Frame& frame);

    const MethodRequest& request_;
    const Progress& progress_;
    Stopwatch watch_;
    PixelTracer tracer_;
    std::optional<SurfaceGuide> guide_;
    Frame frame_;
    std::vector<std::uint8_t> state_;
    std::function<int(Pixel)> first_samples_ = [](Pixel) { return 0; };
    std::size_t traced_ = 0;
    int passes_ = 0;
};

}  // namespace vecino
