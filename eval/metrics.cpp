// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
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
constexpr int kTilePixels = 16;

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

/// Both images in one space: a row per row of pixels, a column per channel value.
struct Values {
    cv::Mat test, reference;
};

/// What is measured in one go: all pixels, or those of a region.
struct Part {
    cv::Mat mask;  ///< 8 bit, one value per pixel; empty: all pixels
    Metrics* metrics;
};

/// The values of the mask's pixels, in one row. A map with one value per pixel will do, too.
cv::Mat select(const cv::Mat& values, const cv::Mat& mask) {
    if (mask.empty()) return values;
    const int per_pixel = values.cols / mask.cols;
    cv::Mat selected(1, per_pixel * cv::countNonZero(mask), CV_64F);
    double* to = selected.ptr<double>();
    for (int y = 0; y < mask.rows; ++y) {
        const double* from = values.ptr<double>(y);
        const std::uint8_t* wanted = mask.ptr<std::uint8_t>(y);
        for (int x = 0; x < mask.cols; ++x, from += per_pixel)
            if (wanted[x] != 0) to = std::copy_n(from, per_pixel, to);
    }
    return selected;
}

Values select(const Values& values, const cv::Mat& mask) {
    return {select(values.test, mask), select(values.reference, mask)};
}

std::optional<double> psnr(const Values& values, double peak) {
    const double mse = cv::norm(values.test, values.reference, cv::NORM_L2SQR) /
                       static_cast<double>(values.test.total());
    if (mse == 0) return std::nullopt;
    return 10 * std::log10(peak * peak / mse);
}

/// Where no window leaves the image.
cv::Rect ssim_interior(cv::Size image) {
    return {kSsimBorder, kSsimBorder, image.width - 2 * kSsimBorder,
            image.height - 2 * kSsimBorder};
}

/// Wang et al. 2004, without the border where the window leaves the image.
cv::Mat ssim_map(const cv::Mat& x, const cv::Mat& y) {
    constexpr double c1 = (0.01 * kPeak8bit) * (0.01 * kPeak8bit);
    constexpr double c2 = (0.03 * kPeak8bit) * (0.03 * kPeak8bit);
    const auto local_mean = [&](const cv::Mat& values) {
        cv::Mat blurred;
        cv::GaussianBlur(values, blurred, {kSsimWindow, kSsimWindow}, kSsimSigma);
        return cv::Mat(blurred, ssim_interior(x.size()));
    };
    const cv::Mat mean_x = local_mean(x);
    const cv::Mat mean_y = local_mean(y);
    const cv::Mat mean_product = mean_x.mul(mean_y);
    const cv::Mat mean_squares = mean_x.mul(mean_x) + mean_y.mul(mean_y);
    const cv::Mat covariance = local_mean(x.mul(y)) - mean_product;
    const cv::Mat variances = local_mean(x.mul(x) + y.mul(y)) - mean_squares;
    const cv::Mat numerator = (2 * mean_product + c1).mul(2 * covariance + c2);
    const cv::Mat denominator = (mean_squares + c1).mul(variances + c2);
    return numerator / denominator;
}

/// One map per channel; none if the image is smaller than the window.
std::vector<cv::Mat> ssim_maps(const Values& values) {
    const cv::Mat x = values.test.reshape(3);
    const cv::Mat y = values.reference.reshape(3);
    if (x.cols < kSsimWindow || x.rows < kSsimWindow) return {};
    std::vector<cv::Mat> maps;
    for (int c = 0; c < 3; ++c) {
        cv::Mat x_channel, y_channel;
        cv::extractChannel(x, x_channel, c);
        cv::extractChannel(y, y_channel, c);
        maps.push_back(ssim_map(x_channel, y_channel));
    }
    return maps;
}

void measure_ssim(const std::vector<cv::Mat>& maps, Extent image, const Part& part) {
    if (maps.empty()) {
        part.metrics->ssim_reason =
            "image is " + size_text(image) + ", ssim needs at least 11 pixels in both axes";
        return;
    }
    const cv::Mat mask = part.mask.empty() ? cv::Mat() : part.mask(ssim_interior(part.mask.size()));
    if (!mask.empty() && cv::countNonZero(mask) == 0) {
        part.metrics->ssim_reason = "no pixel is inside of the border of 5 that ssim crops";
        return;
    }
    double sum = 0;
    for (const cv::Mat& map : maps) sum += cv::mean(select(map, mask))[0];
    part.metrics->ssim = sum / 3;
}

void measure_display(const Values& values, Metrics& metrics) {
    metrics.psnr_float_db = psnr(values, 1.0);
}

/// Where tiles begin along an axis: they fill it, and none is smaller than the others.
std::vector<int> tile_starts(int pixels) {
    std::vector<int> starts;
    for (int start = 0; start < pixels; start += kTilePixels)
        starts.push_back(std::max(0, std::min(start, pixels - kTilePixels)));
    return starts;
}

/// Of the whole image: a row of values per row of pixels.
void measure_tiles(const Values& values, Metrics& metrics) {
    const cv::Rect image(0, 0, values.test.cols, values.test.rows);
    for (const int y : tile_starts(values.test.rows)) {
        for (const int x : tile_starts(values.test.cols / 3)) {
            const cv::Rect tile = cv::Rect(3 * x, y, 3 * kTilePixels, kTilePixels) & image;
            const auto found = psnr({values.test(tile), values.reference(tile)}, 1.0);
            if (!found) continue;
            metrics.worst_tile_psnr_db =
                std::min(*found, metrics.worst_tile_psnr_db.value_or(*found));
        }
    }
}

void measure_8bit(const Values& values, Metrics& metrics) {
    metrics.psnr_db = psnr(values, kPeak8bit);
    metrics.identical_8bit = !metrics.psnr_db.has_value();
}

void measure_linear(const Values& values, Metrics& metrics) {
    cv::Mat error;
    cv::absdiff(values.test, values.reference, error);
    const cv::Mat relative =
        error.mul(error) / (values.reference.mul(values.reference) + kRelmseOffset);
    metrics.relmse = cv::mean(relative)[0];
    metrics.mae = cv::mean(error)[0];
    metrics.max_error = cv::norm(error, cv::NORM_INF);
    metrics.p99_error =
        percentile_99(std::vector<double>(error.begin<double>(), error.end<double>()));
}

void measure_parts(const Values& values, std::span<const Part> parts,
                   void (*measure)(const Values&, Metrics&)) {
    for (const Part& part : parts) measure(select(values, part.mask), *part.metrics);
}

/// One space after the other: of large images, no more values are held at once than need be.
void measure(const Image& test, const Image& reference, std::span<const Part> parts) {
    measure_parts({channel_values(test), channel_values(reference)}, parts, measure_linear);
    const Image test_display = map_pixels(test, display_value);
    const Image reference_display = map_pixels(reference, display_value);
    {
        const Values display{channel_values(test_display), channel_values(reference_display)};
        measure_parts(display, parts, measure_display);
        measure_tiles(display, *parts.front().metrics);
    }
    const Values values_8bit{channel_values(map_pixels(test_display, quantised)),
                             channel_values(map_pixels(reference_display, quantised))};
    measure_parts(values_8bit, parts, measure_8bit);
    const std::vector<cv::Mat> maps = ssim_maps(values_8bit);
    for (const Part& part : parts) measure_ssim(maps, test.size(), part);
}

/// The whole image and every region that has a pixel, each with metrics to fill.
std::vector<Part> parts_of(Comparison& comparison, const RegionMap* regions) {
    std::vector<Part> parts = {{{}, &comparison.metrics.emplace()}};
    if (!regions) return parts;
    const auto [width, height] = regions->size();
    auto* labels = const_cast<Region*>(regions->values().data());  // cv::Mat knows no const
    const cv::Mat view(height, width, CV_8U, labels);
    for (const RegionInfo& info : kRegions) {
        RegionMetrics& region = (*comparison.regions)[region_index(info.region)];
        if (region.pixels == 0) continue;
        const cv::Mat mask = view == static_cast<double>(region_index(info.region));
        parts.push_back({mask, &region.metrics.emplace()});
    }
    return parts;
}

PerRegion<RegionMetrics> unmeasured(const RegionMap& regions) {
    const PerRegion<std::size_t> pixels = region_pixels(regions);
    PerRegion<RegionMetrics> result;
    for (std::size_t i = 0; i < result.size(); ++i) result[i].pixels = pixels[i];
    return result;
}

// clang-format off
constexpr MetricInfo kMetrics[] = {
    {"psnr_float_db", "10 log10(1 / mean (x-r)^2) dB, x and r clipped to [0,1] and sRGB-encoded, not quantised",
     true, [](const Metrics& m) { return m.psnr_float_db; }, ErrorScale::decibel},
    {"psnr_db", "10 log10(255^2 / mean (x-r)^2) dB, x and r clipped to [0,1], sRGB-encoded, quantised to 8 bit",
     true, [](const Metrics& m) { return m.psnr_db; }, ErrorScale::decibel},
    {"ssim", "Wang 2004 on the 8-bit images: Gaussian 11x11, sigma 1.5, K1 .01, K2 .03, range 255, border of 5 cropped, "
             "mean over channels",
     true, [](const Metrics& m) { return m.ssim; }, ErrorScale::similarity},
    {"relmse", "mean (x-r)^2 / (r^2 + 0.01) over pixels and channels, linear",
     false, [](const Metrics& m) { return std::optional(m.relmse); }, ErrorScale::power},
    {"mae", "mean |x-r| over all channel values, linear",
     false, [](const Metrics& m) { return std::optional(m.mae); }, ErrorScale::amplitude},
    {"max_error", "largest |x-r| of all channel values, linear",
     false, [](const Metrics& m) { return std::optional(m.max_error); }, ErrorScale::amplitude},
    {"p99_error", "99th percentile of |x-r| over all channel values (the ceil(0.99 n)-th smallest), linear",
     false, [](const Metrics& m) { return std::optional(m.p99_error); }, ErrorScale::amplitude},
    {"worst_tile_psnr_db", "psnr_float_db of the worst tile of 16x16 pixels; the last of a row or column ends at the border",
     true, [](const Metrics& m) { return m.worst_tile_psnr_db; }, ErrorScale::decibel},
};
// clang-format on

/// A new row whose scale was left out would be taken for an amplitude.
static_assert(std::ranges::all_of(kMetrics, [](const MetricInfo& metric) {
    const bool is_similarity =
        metric.scale == ErrorScale::decibel || metric.scale == ErrorScale::similarity;
    return metric.higher_is_better == is_similarity;
}));

}  // namespace

Comparison compare(const Image& test, const Image& reference, const RegionMap* regions) {
    require_comparable(test, reference);
    Comparison comparison{
        .non_finite = find_non_finite(test, reference), .metrics = {}, .regions = {}};
    if (regions) {
        require_size(*regions, test.size());
        comparison.regions = unmeasured(*regions);
    }
    if (comparison.non_finite.count == 0) measure(test, reference, parts_of(comparison, regions));
    return comparison;
}

std::span<const MetricInfo> all_metrics() {
    return kMetrics;
}

Grid<float> ssim_values(const Image& test, const Image& reference) {
    require_comparable(test, reference);
    // A NaN spreads through the sums of every window that it is in.
    const auto to_8bit = [](glm::vec3 linear) {
        const glm::vec3 none(std::numeric_limits<float>::quiet_NaN());
        return is_finite(linear) ? quantised(display_value(linear)) : none;
    };
    const std::vector<cv::Mat> maps = ssim_maps({channel_values(map_pixels(test, to_8bit)),
                                                 channel_values(map_pixels(reference, to_8bit))});
    Grid<float> values(test.size(), std::numeric_limits<float>::quiet_NaN());
    if (maps.empty()) return values;
    const cv::Mat mean = (maps[0] + maps[1] + maps[2]) / 3;
    for (int y = 0; y < mean.rows; ++y) {
        for (int x = 0; x < mean.cols; ++x) {
            values(x + kSsimBorder, y + kSsimBorder) = static_cast<float>(mean.at<double>(y, x));
        }
    }
    return values;
}

}  // namespace vecino
