// SPDX-License-Identifier: Apache-2.0
#include "eval/pixel_maps.h"

#include <cmath>
#include <limits>

#include "eval/error_map.h"
#include "eval/metrics.h"
#include "eval/pixel_values.h"

namespace vecino {
namespace {

/// The mean over channels of what a pair of channel values makes.
template <class Value>
Grid<float> channel_means(const Image& test, const Image& reference, const Value& value) {
    require_comparable(test, reference);
    Grid<float> means(test.size(), std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < means.values().size(); ++i) {
        const glm::vec3& x = test.values()[i];
        const glm::vec3& r = reference.values()[i];
        if (!is_finite(x) || !is_finite(r)) continue;
        double sum = 0;
        for (int c = 0; c < 3; ++c) sum += value(double(x[c]), double(r[c]));
        means.values()[i] = static_cast<float>(sum / 3);
    }
    return means;
}

Grid<float> absolute_error(const Image& test, const Image& reference) {
    return channel_means(test, reference, [](double x, double r) { return std::abs(x - r); });
}

Grid<float> relative_squared_error(const Image& test, const Image& reference) {
    return channel_means(test, reference, [](double x, double r) {
        return (x - r) * (x - r) / (r * r + kRelmseOffset);
    });
}

Grid<float> error_magnitude(const Image& test, const Image& reference) {
    return error_values(test, reference, ErrorKind::magnitude);
}

Grid<float> error_signed(const Image& test, const Image& reference) {
    return error_values(test, reference, ErrorKind::sign);
}

// clang-format off
constexpr PixelMap kPixelMaps[] = {
    {"error_magnitude", "sqrt(mean over channels of (x-r)^2), x and r clipped to [0,1] and sRGB-encoded; the mean of its "
                        "square is the error behind psnr_float_db", error_magnitude},
    {"error_signed", "mean over channels of x-r, x and r clipped to [0,1] and sRGB-encoded", error_signed},
    {"absolute_error", "mean over channels of |x-r|, linear; its mean is mae", absolute_error},
    {"relative_squared_error", "mean over channels of (x-r)^2 / (r^2 + 0.01), linear; its mean is relmse",
     relative_squared_error},
    {"ssim", "ssim of the window around the pixel, mean over channels; NaN within 5 of the border; its mean is ssim",
     ssim_values},
};
// clang-format on

}  // namespace

std::span<const PixelMap> all_pixel_maps() {
    return kPixelMaps;
}

}  // namespace vecino
