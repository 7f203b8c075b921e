// SPDX-License-Identifier: Apache-2.0
//
// How far an image is from its reference. Built from OpenCV primitives in double. A pair with a
// non-finite value is never scored. Definitions: the table in metrics.cpp, printed by `vecino list
// metrics`.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/grid.h"
#include "eval/regions.h"

namespace vecino {

struct Metrics {
    std::optional<double> psnr_float_db;  ///< none: the clipped, encoded images are identical
    std::optional<double> psnr_db;        ///< none: the 8-bit images are identical
    bool identical_8bit = false;
    std::optional<double> ssim;  ///< none: see ssim_reason
    std::string ssim_reason;
    std::optional<double> ms_ssim;  ///< none: of a region, or see ms_ssim_reason
    std::string ms_ssim_reason;
    double relmse = 0;
    double smape = 0;
    double mae = 0;
    double max_error = 0;
    double p99_error = 0;
    std::optional<double> worst_tile_psnr_db;  ///< none: identical there, or of a region
    double flip = 0;
    std::optional<double> hdr_flip;  ///< none: not asked for
};

/// Where values are NaN or infinite, in either image.
struct NonFinite {
    std::size_t count = 0;  ///< channel values, both images together
    bool in_test = false;   ///< the first one stands in the test image (else in the reference)
    int x = 0, y = 0, channel = 0;
};

/// Over the pixels of a region alone. The windows of ssim reach beyond it: its ssim is the mean of
/// the whole image's ssim map over those pixels of the region that the crop of the border leaves.
/// flip and hdr_flip likewise are means of the whole image's maps.
struct RegionMetrics {
    std::size_t pixels = 0;
    std::optional<Metrics> metrics;  ///< none without pixels, or when non_finite.count > 0
};

struct Comparison {
    NonFinite non_finite;
    std::optional<Metrics> metrics;                   ///< none when non_finite.count > 0
    std::optional<PerRegion<RegionMetrics>> regions;  ///< none: no regions were given
};

/// Compares linear RGB images, whole and, if regions are given, region by region. Of the metrics on
/// request only those named are measured. Throws Error(mismatch) when the sizes differ, naming
/// both.
Comparison compare(const Image& test, const Image& reference, const RegionMap* regions = nullptr,
                   std::span<const std::string> on_request = {});

/// What error a metric stands for, and what a decibel of it is. With it, a tolerance in dB means
/// the same for every metric: 20 dB are a tenth of the deviation.
enum class ErrorScale {
    amplitude,   ///< the value is an error like |x-r|: 20 log10
    power,       ///< the value is an error like (x-r)^2: 10 log10
    similarity,  ///< 1 - value is an error like (x-r)^2
    decibel,     ///< the value is -10 log10 of an error like (x-r)^2
};

struct MetricInfo {
    std::string_view name;     ///< key in results and --json
    std::string_view formula;  ///< one line
    bool higher_is_better;
    std::optional<double> (*value)(const Metrics&);
    ErrorScale scale;
    /// Why there is no value, empty otherwise; null: a missing value needs no words.
    const std::string& (*reason)(const Metrics&) = nullptr;
    bool is_on_request = false;  ///< costs too much to be measured unless it is asked for
};

/// The 0.01 of relmse.
constexpr double kRelmseOffset = 0.01;

/// The mean over channels of the ssim map: of the window around each pixel. NaN where the window
/// leaves the image or holds a value that is not finite; else its mean is ssim. Throws
/// Error(mismatch) when the sizes differ.
Grid<float> ssim_values(const Image& test, const Image& reference);

/// All metrics, in the order in which they are shown.
std::span<const MetricInfo> all_metrics();

/// Names of the metrics that are measured on request only.
std::vector<std::string> metrics_on_request();

}  // namespace vecino
