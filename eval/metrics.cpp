// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "eval/pixel_values.h"

namespace vecino {
namespace {

constexpr double kPeak8bit = 255.0;
constexpr int kSsimWindow = 11;
constexpr int kSsimBorder = kSsimWindow / 2;
constexpr double kSsimSigma = 1.5;
constexpr double kRelmseOffset = 0.01;

NonFinite find_non_finite(const Image& test, const Image& reference) {
    NonFinite found;
    const auto scan = [&](const Image& image, int x, int y) {
        for (int c = 0; c < 3; ++c) {
            if (std::isfinite(image(x, y)[c])) continue;
            if (found.count++ == 0) found = {1, &image == &test, x, y, c};
        }
    };
    for (int y = 0; y < test.size().height; ++y) {
        for (int x = 0; x < test.size().width; ++x) {
            scan(test, x, y);
            scan(reference, x, y);
        }
    }
    return found;
}

/// All channel values in double, in one channel: arithmetic of a cv::Mat with a number reaches only
/// the first channel of a multi-channel one.
cv::Mat channel_values(const Image& image) {
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    auto* pixels = const_cast<glm::vec3*>(image.values().data());  // cv::Mat knows no const
    const cv::Mat view(image.size().height, image.size().width, CV_32FC3, pixels);
    cv::Mat values;
    view.reshape(1).convertTo(values, CV_64F);
    return values;
}

template <class Map>
Image map_pixels(const Image& image, const Map& map) {
    Image mapped(image.size());
    std::transform(image.values().begin(), image.values().end(), mapped.values().begin(), map);
    return mapped;
}

glm::vec3 quantised(glm::vec3 display) {
    return {quantise_8bit(display.x), quantise_8bit(display.y), quantise_8bit(display.z)};
}

std::optional<double> psnr(const cv::Mat& test, const cv::Mat& reference, double peak) {
    const double mse =
        cv::norm(test, reference, cv::NORM_L2SQR) / static_cast<double>(test.total());
    if (mse == 0) return std::nullopt;
    return 10 * std::log10(peak * peak / mse);
}

/// Wang et al. 2004. The border, where the window leaves the image, is cropped before the mean.
double ssim_of_channel(const cv::Mat& x, const cv::Mat& y) {
    constexpr double c1 = (0.01 * kPeak8bit) * (0.01 * kPeak8bit);
    constexpr double c2 = (0.03 * kPeak8bit) * (0.03 * kPeak8bit);
    const cv::Rect interior(kSsimBorder, kSsimBorder, x.cols - 2 * kSsimBorder,
                            x.rows - 2 * kSsimBorder);
    const auto local_mean = [&](const cv::Mat& values) {
        cv::Mat blurred;
        cv::GaussianBlur(values, blurred, {kSsimWindow, kSsimWindow}, kSsimSigma);
        return cv::Mat(blurred, interior);
    };
    const cv::Mat mean_x = local_mean(x);
    const cv::Mat mean_y = local_mean(y);
    const cv::Mat mean_product = mean_x.mul(mean_y);
    const cv::Mat mean_squares = mean_x.mul(mean_x) + mean_y.mul(mean_y);
    const cv::Mat covariance = local_mean(x.mul(y)) - mean_product;
    const cv::Mat variances = local_mean(x.mul(x) + y.mul(y)) - mean_squares;
    const cv::Mat numerator = (2 * mean_product + c1).mul(2 * covariance + c2);
    const cv::Mat denominator = (mean_squares + c1).mul(variances + c2);
    return cv::mean(numerator / denominator)[0];
}

void measure_ssim(const cv::Mat& test, const cv::Mat& reference, Metrics& metrics) {
    const cv::Mat x = test.reshape(3);
    const cv::Mat y = reference.reshape(3);
    if (x.cols < kSsimWindow || x.rows < kSsimWindow) {
        metrics.ssim_reason = "image is " + size_text({x.cols, x.rows}) +
                              ", ssim needs at least 11 pixels in both axes";
        return;
    }
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
        cv::Mat x_channel, y_channel;
        cv::extractChannel(x, x_channel, c);
        cv::extractChannel(y, y_channel, c);
        sum += ssim_of_channel(x_channel, y_channel);
    }
    metrics.ssim = sum / 3;
}

void measure_display(const Image& test, const Image& reference, Metrics& metrics) {
    const Image test_display = map_pixels(test, display_value);
    const Image reference_display = map_pixels(reference, display_value);
    metrics.psnr_float_db =
        psnr(channel_values(test_display), channel_values(reference_display), 1.0);

    const cv::Mat test_8bit = channel_values(map_pixels(test_display, quantised));
    const cv::Mat reference_8bit = channel_values(map_pixels(reference_display, quantised));
    metrics.psnr_db = psnr(test_8bit, reference_8bit, kPeak8bit);
    metrics.identical_8bit = !metrics.psnr_db.has_value();
    measure_ssim(test_8bit, reference_8bit, metrics);
}

void measure_linear(const cv::Mat& test, const cv::Mat& reference, Metrics& metrics) {
    cv::Mat error;
    cv::absdiff(test, reference, error);
    const cv::Mat relative = error.mul(error) / (reference.mul(reference) + kRelmseOffset);
    metrics.relmse = cv::mean(relative)[0];
    metrics.mae = cv::mean(error)[0];
    metrics.max_error = cv::norm(error, cv::NORM_INF);
    metrics.p99_error =
        percentile_99(std::vector<double>(error.begin<double>(), error.end<double>()));
}

// clang-format off
constexpr MetricInfo kMetrics[] = {
    {"psnr_float_db", "10 log10(1 / mean (x-r)^2) dB, x and r clipped to [0,1] and sRGB-encoded, not quantised",
     true, [](const Metrics& m) { return m.psnr_float_db; }},
    {"psnr_db", "10 log10(255^2 / mean (x-r)^2) dB, x and r clipped to [0,1], sRGB-encoded, quantised to 8 bit",
     true, [](const Metrics& m) { return m.psnr_db; }},
    {"ssim", "Wang 2004 on the 8-bit images: Gaussian 11x11, sigma 1.5, K1 .01, K2 .03, range 255, border of 5 cropped, "
             "mean over channels",
     true, [](const Metrics& m) { return m.ssim; }},
    {"relmse", "mean (x-r)^2 / (r^2 + 0.01) over pixels and channels, linear",
     false, [](const Metrics& m) { return std::optional(m.relmse); }},
    {"mae", "mean |x-r| over all channel values, linear",
     false, [](const Metrics& m) { return std::optional(m.mae); }},
    {"max_error", "largest |x-r| of all channel values, linear",
     false, [](const Metrics& m) { return std::optional(m.max_error); }},
    {"p99_error", "99th percentile of |x-r| over all channel values (the ceil(0.99 n)-th smallest), linear",
     false, [](const Metrics& m) { return std::optional(m.p99_error); }},
};
// clang-format on

}  // namespace

Comparison compare(const Image& test, const Image& reference) {
    require_comparable(test, reference);
    Comparison comparison{.non_finite = find_non_finite(test, reference), .metrics = {}};
    if (comparison.non_finite.count > 0) return comparison;

    Metrics& metrics = comparison.metrics.emplace();
    measure_linear(channel_values(test), channel_values(reference), metrics);
    measure_display(test, reference, metrics);
    return comparison;
}

std::span<const MetricInfo> all_metrics() {
    return kMetrics;
}

}  // namespace vecino
