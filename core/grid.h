// SPDX-License-Identifier: Apache-2.0

/// @file
/// Two-dimensional arrays of values. Row 0 is on top, rows are contiguous. The centre of pixel (x,
/// y) has uv = ((x + 0.5) / width, (y + 0.5) / height).
#pragma once

#include <cmath>
#include <cstddef>
#include <glm/vec3.hpp>
#include <string>
#include <utility>
#include <vector>

namespace vecino {

/// Width and height in pixels.
struct Extent {
    int width = 0;   ///< columns, >= 0
    int height = 0;  ///< rows, >= 0

    /// Number of pixels.
    [[nodiscard]] std::size_t area() const {
        return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    }
    /// Whether both sides are equal.
    friend bool operator==(const Extent&, const Extent&) = default;
};

/// Whether no component is NaN or infinite.
inline bool is_finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// "512x256"
inline std::string size_text(Extent size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

/// Low-resolution size for a reduction factor f >= 1: max(1, floor(size / f)), per axis.
constexpr Extent reduced(Extent full, int factor) {
    const auto side = [factor](int n) { return n / factor > 1 ? n / factor : 1; };
    return {side(full.width), side(full.height)};
}

/// One value per pixel. An empty grid (0 x 0) stands for a plane that was not made.
template <class T>
class Grid {
  public:
    /// 0 x 0.
    Grid() = default;
    /// Every pixel has the value fill. Precondition: width and height are at least 0.
    explicit Grid(Extent size, T fill = T{}) : size_(size), values_(size.area(), fill) {}

    /// Width and height in pixels.
    [[nodiscard]] Extent size() const { return size_; }
    /// Whether there is no pixel.
    [[nodiscard]] bool empty() const { return values_.empty(); }

    /// The value of a pixel, to change. Precondition: 0 <= x < width and 0 <= y < height.
    T& operator()(int x, int y) { return values_[index(x, y)]; }
    /// The value of a pixel. Precondition: 0 <= x < width and 0 <= y < height.
    const T& operator()(int x, int y) const { return values_[index(x, y)]; }

    /// All values, row by row from the top: pixel (x, y) is number y * width + x. To change, but
    /// not to resize.
    std::vector<T>& values() { return values_; }
    /// All values, row by row from the top: pixel (x, y) is number y * width + x.
    [[nodiscard]] const std::vector<T>& values() const { return values_; }

    /// Whether sizes and values are equal; a NaN equals nothing.
    friend bool operator==(const Grid&, const Grid&) = default;

  private:
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.width) +
               static_cast<std::size_t>(x);
    }

    Extent size_;
    std::vector<T> values_;
};

/// Linear RGB. A radiance has no upper bound; what a screen shows lies in [0, 1].
using Image = Grid<glm::vec3>;

}  // namespace vecino
