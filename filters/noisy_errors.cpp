// SPDX-License-Identifier: Apache-2.0
#include "filters/noisy_errors.h"

#include <algorithm>
#include <cmath>

#include "core/color.h"

namespace vecino {
namespace {

template <class Value>
MeanError mean_over(const Image& image, const Value& value) {
    double sum = 0, squares = 0;
    const Extent size = image.size();
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            const double each = value(x, y);
            if (!std::isfinite(each)) continue;
            sum += each;
            squares += each * each;
        }
    }
    const auto count = static_cast<double>(size.area());
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(squares / count - mean * mean, 0.0) / count)};
}

/// Not at all where they are clipped.
double clipped_slope(float linear) {
    return linear > 1.0f ? 0.0 : static_cast<double>(srgb_slope(linear));
}

}  // namespace

MeanError squared_difference(const Image& a, const Image& b) {
    return mean_over(a, [&](int x, int y) {
        double sum = 0;
        for (int c = 0; c < 3; ++c) {
            const double d = static_cast<double>(srgb_encode(a(x, y)[c]) - srgb_encode(b(x, y)[c]));
            sum += d * d;
        }
        return sum / 3;
    });
}

MeanError error_against(const Image& image, const Image& a, const Image& b) {
    return mean_over(image, [&](int x, int y) {
        double sum = 0;
        for (int c = 0; c < 3; ++c) {
            const double slope = clipped_slope(image(x, y)[c]);
            const auto value = static_cast<double>(image(x, y)[c]);
            sum += slope * slope * (value - static_cast<double>(a(x, y)[c])) *
                   (value - static_cast<double>(b(x, y)[c]));
        }
        return sum / 3;
    });
}

}  // namespace vecino
