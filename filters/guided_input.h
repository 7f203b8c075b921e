// SPDX-License-Identifier: Apache-2.0
//
// What both schemes with a guide read: the low-resolution frame without its emission, the surfels
// in its pixels, and how neighbours are weighed by their place in the image.
#pragma once

#include <atomic>
#include <glm/common.hpp>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "filters/schemes.h"
#include "filters/surfels.h"

namespace vecino {

/// Weights of neighbours along one axis: (1 - t^2)^2 with t = distance / reach, which ends without
/// a step, so that no seam shows where the window moves on.
double screen_weight(double distance, double reach);

/// The neighbours of a pixel along one axis, clipped to the image.
struct AxisWindow {
    int begin = 0;
    std::vector<double> weights;
};

/// Of every pixel of an axis: windows of low-resolution pixels around the corresponding one,
/// weighed by their distance from the pixel's own centre.
std::vector<AxisWindow> axis_windows(int full, int low, int window);

/// The mean over a pixel's surfels, by coverage: of a constant, that constant.
template <class ValueOf>
glm::dvec3 mean_over(std::span<const Surfel> surfels, const ValueOf& value_of) {
    glm::dvec3 sum(0.0);
    double whole = 0;
    for (const Surfel& surfel : surfels) {
        const auto coverage = static_cast<double>(surfel.coverage);
        sum += coverage * glm::dvec3(value_of(surfel));
        whole += coverage;
    }
    return sum / whole;
}

class GuidedInput {
  public:
    explicit GuidedInput(const GuidedTask& task);

    [[nodiscard]] Extent low_size() const { return low_.size(); }
    [[nodiscard]] int threads() const { return threads_; }
    [[nodiscard]] const GuideView& guide() const { return view_; }
    [[nodiscard]] const SurfelGrid& surfels() const { return surfels_; }
    /// Whether the guide is of the size of the result.
    [[nodiscard]] bool is_plain() const { return fine_.count() == 0; }
    /// Those of the pixels of the result, where the guide has several samples for each.
    [[nodiscard]] const SurfelGrid& fine() const { return fine_; }
    /// Radiance less emission; NaN where either is not finite.
    [[nodiscard]] const glm::dvec3& reflected(int x, int y) const { return reflected_(x, y); }
    [[nodiscard]] std::size_t dropped() const { return dropped_; }

  private:
    [[nodiscard]] glm::dvec3 emission(int x, int y) const;

    const Frame& low_;
    int threads_;
    GuideView view_;
    SurfelGrid fine_;
    SurfelGrid surfels_;
    Grid<glm::dvec3> reflected_;
    std::size_t dropped_ = 0;
};

inline bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x + v.y + v.z);
}

/// Of less than this nothing is left that could be told from rounding.
constexpr double kLeastWeight = 1e-30;

/// The plain mean of the finite values in the 3x3 pixels around one, within the window; none if
/// there are none.
template <class ValueAt>
std::optional<glm::dvec3> mean_around(int x, int y, Extent size, int window,
                                      const ValueAt& value_at) {
    const int radius = std::min(window / 2, 1);
    glm::dvec3 sum(0.0);
    int count = 0;
    for (int v = std::max(y - radius, 0); v <= std::min(y + radius, size.height - 1); ++v) {
        for (int u = std::max(x - radius, 0); u <= std::min(x + radius, size.width - 1); ++u) {
            const glm::dvec3 value = value_at(u, v);
            if (!is_finite(value)) continue;
            sum += value;
            ++count;
        }
    }
    if (count == 0) return std::nullopt;
    return sum / static_cast<double>(count);
}

/// What became of a pixel of the result.
struct GuidedOutcome {
    bool fell_back = false;   ///< no neighbour is of its surface
    bool non_finite = false;  ///< nothing finite was left
};

/// As floats, none of them infinite.
inline glm::vec3 in_range(const glm::dvec3& v) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return glm::vec3(glm::clamp(v, -kMost, kMost));
}

/// The radiance of a pixel: that of its surfels, by coverage.
template <class Resolve>
glm::vec3 resolve_pixel(const GuidedInput& input, int x, int y, const Resolve& resolve) {
    if (input.is_plain()) return in_range(resolve(input.guide().pixel(x, y)));
    return in_range(mean_over(input.fine().at(x, y), resolve));
}

/// The whole image, of which light_of(surfel, x, y, outcome) tells the radiance of each surfel.
template <class LightOf>
Reconstruction resolve_pixels(const GuidedTask& task, const GuidedInput& input,
                              const LightOf& light_of) {
    constexpr std::size_t kRowsPerBlock = 4;
    const Extent size = task.request.size;
    Reconstruction result;
    result.image = Image(size);
    result.dropped_samples = input.dropped();
    std::atomic<std::size_t> fallbacks = 0;
    std::atomic<std::size_t> non_finite = 0;
    const auto resolve_row = [&](int y) {
        for (int x = 0; x < size.width; ++x) {
            GuidedOutcome outcome;
            result.image(x, y) = resolve_pixel(
                input, x, y, [&](const Surfel& surfel) { return light_of(surfel, x, y, outcome); });
            if (outcome.fell_back) ++fallbacks;
            if (outcome.non_finite) ++non_finite;
        }
    };
    for_each_block(static_cast<std::size_t>(size.height), kRowsPerBlock, input.threads(),
                   [&](BlockRange rows) {
                       for (std::size_t y = rows.begin; y < rows.end; ++y)
                           resolve_row(static_cast<int>(y));
                   });
    result.fallback_pixels = fallbacks;
    result.non_finite_pixels = non_finite;
    return result;
}

}  // namespace vecino
