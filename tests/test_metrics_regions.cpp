// SPDX-License-Identifier: Apache-2.0
//
// Metrics of regions: against brute force, and against those of the whole image.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/color.h"
#include "eval/metrics.h"
#include "eval/metrics_json.h"
#include "tests/catch.h"
#include "tests/error_of.h"

using namespace vecino;

namespace {

constexpr Extent kSize{37, 26};

Image random_image(Extent size, unsigned seed) {
    std::mt19937 engine(seed);
    Image image(size);
    for (glm::vec3& value : image.values())
        for (int c = 0; c < 3; ++c) value[c] = 1.1f * static_cast<float>(engine() % 4096) / 4096.0f;
    return image;
}

/// A smooth image and a little noise: unlike of two noise images, its ssim is far from 0.
Image noisy_ramp(Extent size, unsigned seed) {
    Image image = random_image(size, seed);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            image(x, y) = 0.1f * image(x, y) + 0.02f * static_cast<float>(x + y % 5);
    return image;
}

/// Blobs of all three regions.
RegionMap blobs(Extent size) {
    RegionMap regions(size);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            regions(x, y) = static_cast<Region>((x / 3 + 2 * (y / 4) + x * y % 2) % 3);
    return regions;
}

const RegionMetrics& region_of(const Comparison& comparison, Region region) {
    return comparison.regions.value()[region_index(region)];
}

const Metrics& metrics_of(const Comparison& comparison, Region region) {
    return region_of(comparison, region).metrics.value();
}

/// The mean squared error behind decibels.
double mse_of(const std::optional<double>& psnr_db) {
    return psnr_db ? std::pow(10.0, -0.1 * *psnr_db) : 0.0;
}

double value_8bit(float linear) {
    return quantise_8bit(srgb_encode(linear));
}

/// Sums over one window of Wang et al., in the order of their definition.
double ssim_at(const Image& test, const Image& reference, int x, int y, int c) {
    double weights = 0, mean_x = 0, mean_y = 0, xx = 0, yy = 0, xy = 0;
    for (int v = -5; v <= 5; ++v) {
        for (int u = -5; u <= 5; ++u) {
            const double weight = std::exp(-(u * u + v * v) / (2 * 1.5 * 1.5));
            const double a = value_8bit(test(x + u, y + v)[c]);
            const double b = value_8bit(reference(x + u, y + v)[c]);
            weights += weight;
            mean_x += weight * a;
            mean_y += weight * b;
            xx += weight * a * a;
            yy += weight * b * b;
            xy += weight * a * b;
        }
    }
    mean_x /= weights;
    mean_y /= weights;
    const double variances = (xx + yy) / weights - mean_x * mean_x - mean_y * mean_y;
    const double covariance = xy / weights - mean_x * mean_y;
    const double c1 = 2.55 * 2.55, c2 = 7.65 * 7.65;
    return (2 * mean_x * mean_y + c1) * (2 * covariance + c2) /
           ((mean_x * mean_x + mean_y * mean_y + c1) * (variances + c2));
}

double mean_ssim(const Image& test, const Image& reference, const RegionMap& regions,
                 Region region) {
    double sum = 0;
    int count = 0;
    for (int y = 5; y < test.size().height - 5; ++y)
        for (int x = 5; x < test.size().width - 5; ++x)
            for (int c = 0; c < 3; ++c) {
                if (regions(x, y) != region) continue;
                sum += ssim_at(test, reference, x, y, c);
                ++count;
            }
    return sum / count;
}

std::vector<double> errors_in(const Image& test, const Image& reference, const RegionMap& regions,
                              Region region) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < test.values().size(); ++i)
        for (int c = 0; c < 3; ++c)
            if (regions.values()[i] == region)
                errors.push_back(std::abs(static_cast<double>(test.values()[i][c]) -
                                          static_cast<double>(reference.values()[i][c])));
    std::ranges::sort(errors);
    return errors;
}

auto near(double value, double tolerance) {
    return Approx(value).epsilon(0).margin(tolerance);
}

}  // namespace

TEST_CASE("an error in one region is seen in that region alone", "[metrics][regions]") {
    const RegionMap regions = blobs(kSize);
    const Region bad = GENERATE(Region::emitter, Region::edge, Region::interior);
    const Image reference(kSize, glm::vec3(0.25f));
    Image test = reference;
    for (std::size_t i = 0; i < test.values().size(); ++i)
        if (regions.values()[i] == bad) test.values()[i] = glm::vec3(0.5f);
    const Comparison comparison = compare(test, reference, &regions);
    for (const RegionInfo& info : kRegions) {
        CAPTURE(info.name);
        const Metrics& metrics = metrics_of(comparison, info.region);
        CHECK(metrics.identical_8bit == (info.region != bad));
        CHECK(metrics.psnr_db.has_value() == (info.region == bad));
        CHECK(metrics.mae == (info.region == bad ? 0.25 : 0.0));
        CHECK(metrics.max_error == (info.region == bad ? 0.25 : 0.0));
        CHECK(metrics.p99_error == (info.region == bad ? 0.25 : 0.0));
    }
    // sRGB of 0.5 and 0.25, from the standard's formula; as 8-bit values 188 and 137.
    const double error = 0.7353569830524495 - 0.5370987304831942;
    const Metrics& metrics = metrics_of(comparison, bad);
    CHECK(metrics.psnr_float_db.value() == near(-20 * std::log10(error), 1e-4));
    CHECK(metrics.psnr_db.value() == near(20 * std::log10(255.0 / 51), 1e-9));
    CHECK(metrics.relmse == near(0.0625 / 0.0725, 1e-9));
}

TEST_CASE("means over regions, weighted by their pixels, are those of the whole image",
          "[metrics][regions]") {
    const RegionMap regions = blobs(kSize);
    const Comparison comparison = compare(random_image(kSize, 1), random_image(kSize, 2), &regions);
    double mse_float = 0, mse_8bit = 0, relmse = 0, mae = 0, largest = 0;
    std::size_t pixels = 0;
    for (const RegionMetrics& region : *comparison.regions) {
        const double share = static_cast<double>(region.pixels) / static_cast<double>(kSize.area());
        pixels += region.pixels;
        mse_float += share * mse_of(region.metrics->psnr_float_db);
        mse_8bit += share * mse_of(region.metrics->psnr_db);
        relmse += share * region.metrics->relmse;
        mae += share * region.metrics->mae;
        largest = std::max(largest, region.metrics->max_error);
    }
    const Metrics& whole = comparison.metrics.value();
    CHECK(pixels == kSize.area());
    CHECK(mse_float == near(mse_of(whole.psnr_float_db), 1e-12));
    CHECK(mse_8bit == near(mse_of(whole.psnr_db), 1e-12));
    CHECK(relmse == near(whole.relmse, 1e-12 * whole.relmse));
    CHECK(mae == near(whole.mae, 1e-12));
    CHECK(largest == whole.max_error);
}

TEST_CASE("a region's ssim is the mean of the map over its pixels off the border",
          "[metrics][regions]") {
    const RegionMap regions = blobs(kSize);
    const Region region = GENERATE(Region::emitter, Region::edge, Region::interior);
    const Image test = noisy_ramp(kSize, 3), reference = noisy_ramp(kSize, 4);
    const Comparison comparison = compare(test, reference, &regions);
    const double expected = mean_ssim(test, reference, regions, region);
    CHECK(metrics_of(comparison, region).ssim.value() == near(expected, 1e-9));
    CHECK(std::abs(expected - comparison.metrics->ssim.value()) > 1e-6);
}

TEST_CASE("a region's largest and 99th percentile errors are of its own values",
          "[metrics][regions]") {
    const RegionMap regions = blobs(kSize);
    const Region region = GENERATE(Region::emitter, Region::edge, Region::interior);
    const Image test = random_image(kSize, 5), reference = random_image(kSize, 6);
    const std::vector<double> errors = errors_in(test, reference, regions, region);
    const Comparison comparison = compare(test, reference, &regions);
    CHECK(region_of(comparison, region).pixels * 3 == errors.size());
    CHECK(metrics_of(comparison, region).max_error == errors.back());
    const std::size_t rank = (99 * errors.size() + 99) / 100;
    CHECK(metrics_of(comparison, region).p99_error == errors[rank - 1]);
}

TEST_CASE("a region that is the whole image has the whole image's metrics", "[metrics][regions]") {
    const RegionMap regions(kSize, Region::edge);
    const Comparison comparison =
        compare(noisy_ramp(kSize, 7), noisy_ramp(kSize, 8), &regions, metrics_on_request());
    for (const MetricInfo& info : all_metrics()) {
        CAPTURE(info.name);
        if (info.name == "ms_ssim" || info.name == "worst_tile_psnr_db") continue;  // of the whole
        CHECK(info.value(metrics_of(comparison, Region::edge)).value() ==
              Approx(info.value(*comparison.metrics).value()).epsilon(1e-13));
    }
}

TEST_CASE("a region without a pixel has no metrics", "[metrics][regions]") {
    const RegionMap regions(kSize, Region::interior);
    const Comparison comparison = compare(random_image(kSize, 1), random_image(kSize, 2), &regions);
    CHECK(region_of(comparison, Region::edge).pixels == 0);
    CHECK_FALSE(region_of(comparison, Region::edge).metrics);
    CHECK(region_of(comparison, Region::interior).pixels == kSize.area());
    CHECK(region_of(comparison, Region::interior).metrics);
}

TEST_CASE("a region on the border alone has no ssim, and says why", "[metrics][regions]") {
    RegionMap regions(kSize, Region::interior);
    for (int y = 0; y < kSize.height; ++y) regions(4, y) = Region::edge;
    regions(5, 4) = Region::edge;
    const Image test = random_image(kSize, 1), reference = random_image(kSize, 2);
    const Metrics border = metrics_of(compare(test, reference, &regions), Region::edge);
    CHECK_FALSE(border.ssim);
    CHECK(border.ssim_reason == "no pixel is inside of the border of 5 that ssim crops");
    CHECK(border.psnr_db);
    regions(5, 5) = Region::edge;
    const Metrics inside = metrics_of(compare(test, reference, &regions), Region::edge);
    const double expected = mean_ssim(test, reference, regions, Region::edge);
    CHECK(inside.ssim.value() == near(expected, 1e-9));
}

TEST_CASE("in an image too small for ssim no region has one", "[metrics][regions]") {
    const RegionMap regions({10, 20}, Region::emitter);
    const Comparison comparison =
        compare(random_image({10, 20}, 1), random_image({10, 20}, 2), &regions);
    CHECK_FALSE(metrics_of(comparison, Region::emitter).ssim);
    CHECK(metrics_of(comparison, Region::emitter).ssim_reason == comparison.metrics->ssim_reason);
}

TEST_CASE("regions change no bit of the whole image's metrics", "[metrics][regions]") {
    const RegionMap regions = blobs(kSize);
    const Image test = noisy_ramp(kSize, 9), reference = noisy_ramp(kSize, 10);
    const Comparison with = compare(test, reference, &regions);
    const Comparison without = compare(test, reference);
    CHECK_FALSE(without.regions);
    for (const MetricInfo& info : all_metrics()) {
        CAPTURE(info.name);
        CHECK(info.value(*with.metrics) == info.value(*without.metrics));
    }
}

TEST_CASE("a non-finite value leaves no region with metrics", "[metrics][regions]") {
    const RegionMap regions = blobs(kSize);
    Image test = random_image(kSize, 1);
    test(3, 3).x = std::numeric_limits<float>::quiet_NaN();
    const Comparison comparison = compare(test, random_image(kSize, 2), &regions);
    for (const RegionMetrics& region : comparison.regions.value()) {
        CHECK(region.pixels > 0);
        CHECK_FALSE(region.metrics);
    }
}

TEST_CASE("regions of another size are a mismatch", "[metrics][regions]") {
    const RegionMap regions({26, 37});
    const Error error = error_of([&] { compare(Image(kSize), Image(kSize), &regions); });
    CHECK(error.code() == ExitCode::mismatch);
}

TEST_CASE("a comparison's JSON has regions only if they were given", "[metrics][regions]") {
    RegionMap regions = blobs(kSize);
    for (Region& region : regions.values())
        if (region == Region::edge) region = Region::interior;
    const Image test = random_image(kSize, 1), reference = random_image(kSize, 2);
    CHECK_FALSE(comparison_json(compare(test, reference)).contains("regions"));
    const auto json = comparison_json(compare(test, reference, &regions, metrics_on_request()));
    REQUIRE(json["regions"].size() == kRegions.size());
    const auto pixels = region_pixels(regions);
    for (const RegionInfo& info : kRegions) {
        CAPTURE(info.name);
        const auto& region = json["regions"][std::string(info.name)];
        CHECK(region["pixels"] == pixels[region_index(info.region)]);
        for (const MetricInfo& metric : all_metrics()) {
            CAPTURE(metric.name);
            const bool is_measured = info.region != Region::edge;
            const bool is_of_whole =
                metric.name == "ms_ssim" || metric.name == "worst_tile_psnr_db";
            REQUIRE(region.contains(metric.name) == (is_measured || !metric.is_on_request));
            if (is_of_whole || !region.contains(metric.name)) continue;
            CHECK(region[std::string(metric.name)].is_null() == !is_measured);
        }
        CHECK(region["identical_8bit"] == false);
    }
}
