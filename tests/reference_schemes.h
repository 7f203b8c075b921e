// SPDX-License-Identifier: Apache-2.0
//
// The five schemes once more, as the thesis writes them down (Algorithms 3, 4, 5, 7, 8): for each
// pixel of the large image, through uv, with plain loops and no thought of speed. Shares nothing
// with filters/ but the types.
#pragma once

#include <cmath>
#include <set>
#include <string_view>
#include <utility>

#include "core/frame.h"
#include "filters/schemes.h"

namespace vecino::reference {

using Pixel = std::pair<int, int>;

struct Result {
    Image image;
    std::set<Pixel> fallbacks, non_finite;  ///< low-res
};

inline bool finite(const glm::vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// The low-res pixel whose interval [k / low_count, (k + 1) / low_count) holds u = (x + 0.5) /
/// full_count; compared as fractions, since u in floating point may fall on the wrong side of a
/// border.
inline int low_pixel_at(int x, int full_count, int low_count) {
    int k = 0;
    while ((k + 1) * 2LL * full_count <= (2LL * x + 1) * low_count) ++k;
    return k;
}

class Window {
  public:
    Window(const Frame& low, std::string_view scheme, const SchemeParameters& parameters,
           Pixel centre)
        : low_(low), scheme_(scheme), parameters_(parameters), centre_(centre) {}

    /// The weighted average; false where the pixel has to fall back.
    bool average(glm::vec3& color) const {
        if (in_world() && missed(centre_)) return false;
        const double s = mean_distance();
        double sum[3] = {0, 0, 0};
        double weights = 0;
        bool sound = true;
        for_each_pixel([&](Pixel i) {
            if (i == centre_ && !parameters_.use_centre) return;
            const glm::vec3 c = low_.radiance(i.first, i.second);
            if (!finite(c) || gated(i)) return;
            const double w = weight(distance(i), s);
            if (!std::isfinite(w)) sound = false;
            weights += w;
            for (int k = 0; k < 3; ++k) sum[k] += w * static_cast<double>(c[k]);
        });
        if (!sound || weights == 0 || !std::isfinite(weights)) return false;
        for (int k = 0; k < 3; ++k) color[k] = static_cast<float>(sum[k] / weights);
        return true;
    }

  private:
    template <class Visit>
    void for_each_pixel(Visit visit) const {
        const int k = parameters_.window / 2;
        for (int y = centre_.second - k; y <= centre_.second + k; ++y) {
            for (int x = centre_.first - k; x <= centre_.first + k; ++x) {
                if (x < 0 || y < 0 || x >= low_.size().width || y >= low_.size().height) continue;
                visit(Pixel{x, y});
            }
        }
    }

    [[nodiscard]] bool in_world() const { return scheme_.substr(0, 10) == "distance3d"; }

    [[nodiscard]] bool missed(Pixel i) const {
        return !low_.object_id.empty() && low_.object_id(i.first, i.second) == -1;
    }

    [[nodiscard]] bool gated(Pixel i) const {
        if (!in_world()) return false;
        if (missed(i)) return true;
        if (scheme_ != "distance3d_normal") return false;
        const glm::dvec3 a(low_.normal_world(i.first, i.second));
        const glm::dvec3 b(low_.normal_world(centre_.first, centre_.second));
        return !(a.x * b.x + a.y * b.y + a.z * b.z >
                 static_cast<double>(parameters_.min_normal_cosine));
    }

    [[nodiscard]] double distance(Pixel i) const {
        if (in_world()) {
            const glm::dvec3 a(low_.position_world(i.first, i.second));
            const glm::dvec3 b(low_.position_world(centre_.first, centre_.second));
            const glm::dvec3 d = a - b;
            // An infinite position is none: everything that it takes part in is undefined.
            if (!std::isfinite(d.x + d.y + d.z)) return std::nan("");
            return std::sqrt(d.x * d.x + d.y * d.y + d.z * d.z);
        }
        const double w = low_.size().width;
        const double h = low_.size().height;
        const double du = (i.first + 0.5) / w - (centre_.first + 0.5) / w;
        const double dv = (i.second + 0.5) / h - (centre_.second + 0.5) / h;
        if (parameters_.metric == Metric::manhattan) return std::abs(du) + std::abs(dv);
        return std::sqrt(du * du + dv * dv);
    }

    [[nodiscard]] double mean_distance() const {
        double sum = 0;
        int count = 0;
        for_each_pixel([&](Pixel i) {
            if (i == centre_ || gated(i)) return;
            sum += distance(i);
            ++count;
        });
        return sum / count;
    }

    [[nodiscard]] double weight(double d, double s) const {
        if (scheme_ == "mean") return 1.0;
        if (parameters_.weighting == Weighting::inverse) return 1.0 / (d + 0.01 * s);
        if (parameters_.weighting == Weighting::gaussian) return std::exp(-d * d / (2.0 * s * s));
        return d;
    }

    const Frame& low_;
    std::string_view scheme_;
    const SchemeParameters& parameters_;
    Pixel centre_;
};

inline Result reconstruct(const Frame& low, std::string_view scheme,
                          const SchemeParameters& parameters, Extent size) {
    Result result;
    result.image = Image(size);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            const Pixel c{low_pixel_at(x, size.width, low.size().width),
                          low_pixel_at(y, size.height, low.size().height)};
            glm::vec3& color = result.image(x, y);
            if (scheme != "nearest") {
                if (Window(low, scheme, parameters, c).average(color)) continue;
                result.fallbacks.insert(c);
            }
            color = low.radiance(c.first, c.second);
            if (finite(color)) continue;
            color = glm::vec3(0.0f);
            result.non_finite.insert(c);
        }
    }
    return result;
}

}  // namespace vecino::reference
