// SPDX-License-Identifier: Apache-2.0
#include "filters/window.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/parallel.h"

namespace vecino {
namespace {

constexpr double kYes = std::bit_cast<double>(~std::uint64_t{0});

SumWindows kernel_of_this_machine() {
#ifdef VECINO_WIDE_KERNELS
    __builtin_cpu_init();
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl")) {
        return sum_windows_avx512;
    }
    if (__builtin_cpu_supports("avx2")) return sum_windows_avx2;
#endif
    return sum_windows_baseline;
}

/// How wide a window is, and how its planes lie in memory: all planes of a row, then those of the
/// next.
struct Layout {
    WindowDistance distance;
    Extent size;
    int reach_x, reach_y;  ///< of a window, never past the far side of the image
    int planes;
    std::size_t plane_pitch;

    Layout(Extent image, WindowDistance kind, int radius)
        : distance(kind),
          size(image),
          reach_x(std::min(radius, image.width - 1)),
          reach_y(std::min(radius, image.height - 1)),
          planes(!in_world() ? kPositionPlanes
                 : gated()   ? kNormalPlanes + 3
                             : kNormalPlanes),
          plane_pitch(padded(image.width + 2 * reach_x + kMostLanes)) {}

    [[nodiscard]] bool gated() const { return distance == WindowDistance::gated_world; }
    [[nodiscard]] bool in_world() const { return gated() || distance == WindowDistance::world; }
    [[nodiscard]] std::size_t row_pitch() const {
        return plane_pitch * static_cast<std::size_t>(planes);
    }

  private:
    /// An odd number of cache lines: planes and rows then spread over all sets of the cache.
    static std::size_t padded(int values) {
        constexpr int kPerLine = 8;
        const int lines = (values + kPerLine - 1) / kPerLine;
        return static_cast<std::size_t>(lines | 1) * kPerLine;
    }
};

/// Rows [first, last) of a frame, and all rows that their windows reach.
class Band {
  public:
    Band(const Frame& low, const Layout& layout, BlockRange rows) : layout_(layout) {
        const auto reach = static_cast<std::size_t>(layout.reach_y);
        top_ = rows.begin > reach ? rows.begin - reach : 0;
        const std::size_t bottom =
            std::min(rows.end + reach, static_cast<std::size_t>(layout.size.height));
        values_.resize((bottom - top_) * layout.row_pitch());
        for (std::size_t y = top_; y < bottom; ++y) fill_row(low, static_cast<int>(y));
    }

    /// The pixel (0, y) in plane 0.
    [[nodiscard]] const double* row(int y) const { return values_.data() + index(0, y); }

  private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return (static_cast<std::size_t>(y) - top_) * layout_.row_pitch() +
               static_cast<std::size_t>(layout_.reach_x + x);
    }

    void fill_row(const Frame& low, int y) {
        const bool may_miss = layout_.in_world() && !low.object_id.empty();
        for (int x = 0; x < layout_.size.width; ++x) {
            double* const pixel = values_.data() + index(x, y);
            const glm::vec3 color = low.radiance(x, y);
            if (is_finite(color)) {
                set(pixel, kColorPlanes, color);
                pixel[kFinitePlane * layout_.plane_pitch] = kYes;
            }
            const bool missed = may_miss && low.object_id(x, y) == kMiss;
            if (!missed) pixel[kPresentPlane * layout_.plane_pitch] = kYes;
            if (layout_.in_world())
                set(pixel, kPositionPlanes, nan_if_broken(low.position_world(x, y)));
            if (layout_.gated()) set(pixel, kNormalPlanes, low.normal_world(x, y));
        }
    }

    /// Infinity is as little of a place as NaN; with it the spread could be infinite.
    static glm::vec3 nan_if_broken(const glm::vec3& position) {
        return is_finite(position) ? position : glm::vec3(std::numeric_limits<float>::quiet_NaN());
    }

    void set(double* pixel, std::size_t plane, const glm::vec3& value) const {
        pixel[plane * layout_.plane_pitch] = double{value.x};
        pixel[(plane + 1) * layout_.plane_pitch] = double{value.y};
        pixel[(plane + 2) * layout_.plane_pitch] = double{value.z};
    }

    const Layout& layout_;
    std::size_t top_ = 0;
    std::vector<double> values_;
};

/// What the kernel writes for one row.
struct RowSums {
    std::vector<double> weight, red, green, blue, scratch;

    explicit RowSums(const Layout& layout)
        : weight(static_cast<std::size_t>(layout.size.width + kMostLanes)),
          red(weight.size()),
          green(weight.size()),
          blue(weight.size()),
          scratch(static_cast<std::size_t>(2 * layout.reach_x + 1) *
                  static_cast<std::size_t>(std::min(2 * layout.reach_y + 1, layout.size.height)) *
                  kMostLanes) {}
};

struct Counts {
    std::size_t fallbacks = 0;
    std::size_t non_finite = 0;
};

class WindowAverage {
  public:
    WindowAverage(const Frame& low, WindowKind kind, const SchemeParameters& parameters)
        : low_(low),
          kind_(kind),
          parameters_(parameters),
          layout_(low.size(), kind.distance, parameters.window / 2),
          sum_windows_(kernel_of_this_machine()) {}

    Counts run(BlockRange rows, Image& image) const {
        const Band band(low_, layout_, rows);
        RowSums sums(layout_);
        Counts counts;
        for (auto y = static_cast<int>(rows.begin); y < static_cast<int>(rows.end); ++y) {
            sum_windows_(window_row(band, y, sums));
            for (int x = 0; x < layout_.size.width; ++x) {
                image(x, y) = resolve(x, y, sums, counts);
            }
        }
        return counts;
    }

  private:
    [[nodiscard]] WindowRow window_row(const Band& band, int y, RowSums& sums) const {
        return {.pixels = band.row(y),
                .row_pitch = static_cast<std::int64_t>(layout_.row_pitch()),
                .plane_pitch = static_cast<std::int64_t>(layout_.plane_pitch),
                .width = layout_.size.width,
                .reach = layout_.reach_x,
                .above = std::min(layout_.reach_y, y),
                .below = std::min(layout_.reach_y, layout_.size.height - 1 - y),
                .distance = kind_.distance,
                .weight = kind_.weight,
                .use_centre = parameters_.use_centre,
                .du = 1.0 / layout_.size.width,
                .dv = 1.0 / layout_.size.height,
                .min_normal_cosine = double{parameters_.min_normal_cosine},
                .weight_sum = sums.weight.data(),
                .color_sum = {sums.red.data(), sums.green.data(), sums.blue.data()},
                .weights = sums.scratch.data()};
    }

    /// The average; the pixel's own colour where the weights are unsound or it is a miss; 0 where
    /// that is not finite either.
    [[nodiscard]] glm::vec3 resolve(int x, int y, const RowSums& sums, Counts& counts) const {
        const auto i = static_cast<std::size_t>(x);
        const glm::dvec3 color(sums.red[i], sums.green[i], sums.blue[i]);
        const double weight = sums.weight[i];
        const bool missed =
            layout_.in_world() && !low_.object_id.empty() && low_.object_id(x, y) == kMiss;
        const bool sound = weight > 0.0 && std::isfinite(weight + color.x + color.y + color.z);
        if (sound && !missed) return glm::vec3(color / weight);
        ++counts.fallbacks;
        const glm::vec3 own = low_.radiance(x, y);
        if (is_finite(own)) return own;
        ++counts.non_finite;
        return glm::vec3(0.0f);
    }

    const Frame& low_;
    WindowKind kind_;
    const SchemeParameters& parameters_;
    Layout layout_;
    SumWindows sum_windows_;
};

std::size_t dropped_samples(const Image& image) {
    return static_cast<std::size_t>(
        std::ranges::count_if(image.values(), [](const glm::vec3& c) { return !is_finite(c); }));
}

}  // namespace

Reconstruction average_windows(const Frame& low, WindowKind kind,
                               const SchemeParameters& parameters, int threads) {
    constexpr std::size_t kRowsPerBand = 8;
    const WindowAverage average(low, kind, parameters);
    Reconstruction result;
    result.image = Image(low.size());
    result.dropped_samples = dropped_samples(low.radiance);
    std::atomic<std::size_t> fallbacks = 0;
    std::atomic<std::size_t> non_finite = 0;
    const auto rows = static_cast<std::size_t>(low.size().height);
    for_each_block(rows, kRowsPerBand, threads, [&](BlockRange band) {
        const Counts counts = average.run(band, result.image);
        fallbacks += counts.fallbacks;
        non_finite += counts.non_finite;
    });
    result.fallback_pixels = fallbacks;
    result.non_finite_pixels = non_finite;
    return result;
}

}  // namespace vecino
