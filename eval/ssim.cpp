// SPDX-License-Identifier: Apache-2.0
#include "eval/ssim.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>

namespace vecino {
namespace {

constexpr double kRange = 255.0;
constexpr double kSigma = 1.5;
constexpr std::array kScaleWeights = {0.0448, 0.2856, 0.3001, 0.2363, 0.1333};

/// What one channel of one scale has: contrast and structure alone, and luminance with them.
struct Maps {
    cv::Mat contrast, ssim;
};

Maps ssim_maps(const SsimPair& images) {
    constexpr double c1 = (0.01 * kRange) * (0.01 * kRange);
    constexpr double c2 = (0.03 * kRange) * (0.03 * kRange);
    const auto local_mean = [&](const cv::Mat& values) {
        cv::Mat blurred;
        cv::GaussianBlur(values, blurred, {kSsimWindow, kSsimWindow}, kSigma);
        return cv::Mat(blurred, ssim_interior(values.size()));
    };
    const auto& [x, y] = images;
    const cv::Mat mean_x = local_mean(x);
    const cv::Mat mean_y = local_mean(y);
    const cv::Mat mean_product = mean_x.mul(mean_y);
    const cv::Mat mean_squares = mean_x.mul(mean_x) + mean_y.mul(mean_y);
    const cv::Mat covariance = local_mean(x.mul(y)) - mean_product;
    const cv::Mat variances = local_mean(x.mul(x) + y.mul(y)) - mean_squares;
    const cv::Mat contrast = (2 * covariance + c2) / (variances + c2);
    return {contrast, contrast.mul((2 * mean_product + c1) / (mean_squares + c1))};
}

/// Means of 2x2 pixels; a last row or column without a partner is its own.
cv::Mat halved(const cv::Mat& image) {
    cv::Mat even;
    cv::copyMakeBorder(image, even, 0, image.rows % 2, 0, image.cols % 2, cv::BORDER_REPLICATE);
    cv::Mat half;
    cv::resize(even, half, even.size() / 2, 0, 0, cv::INTER_AREA);
    return half;
}

/// A mean below 0 has no power to a fraction: it counts as 0.
double factor(const cv::Mat& map, std::size_t scale) {
    return std::pow(std::max(0.0, cv::mean(map)[0]), kScaleWeights[scale]);
}

/// Of one channel, whose finest scale has those maps.
double multiscale(const Maps& finest, SsimPair images) {
    double product = factor(finest.contrast, 0);
    for (std::size_t scale = 1; scale < kScaleWeights.size(); ++scale) {
        images = {halved(images.x), halved(images.y)};
        const Maps maps = ssim_maps(images);
        const bool is_coarsest = scale + 1 == kScaleWeights.size();
        product *= factor(is_coarsest ? maps.ssim : maps.contrast, scale);
    }
    return product;
}

}  // namespace

cv::Rect ssim_interior(cv::Size image) {
    return {kSsimBorder, kSsimBorder, image.width - 2 * kSsimBorder,
            image.height - 2 * kSsimBorder};
}

Ssim structural_similarity(const SsimPair& images) {
    Ssim result;
    const int shorter = std::min(images.x.rows, images.x.cols);
    if (shorter < kSsimWindow) return result;
    const int channels = images.x.channels();
    double sum = 0;
    for (int c = 0; c < channels; ++c) {
        SsimPair channel;
        cv::extractChannel(images.x, channel.x, c);
        cv::extractChannel(images.y, channel.y, c);
        const Maps maps = ssim_maps(channel);
        result.maps.push_back(maps.ssim);
        if (shorter >= kMsSsimLeast) sum += multiscale(maps, channel);
    }
    if (shorter >= kMsSsimLeast) result.multiscale = sum / channels;
    return result;
}

}  // namespace vecino
