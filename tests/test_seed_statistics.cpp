// SPDX-License-Identifier: Apache-2.0
//
// Noise and bias against images that are made with a known amount of both, and against the
// definitions by pairs of seeds.
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/color.h"
#include "eval/metrics.h"
#include "eval/pixel_values.h"
#include "eval/seed_statistics.h"
#include "eval/statistics.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/gauss.h"

using namespace vecino;

namespace {

using Images = std::vector<Image>;

/// What a region's images are made with, in display values.
struct Disturbance {
    double bias, sigma;
};

constexpr PerRegion<Disturbance> kDisturbances = {{{0.04, 0.01}, {0.02, 0.03}, {-0.03, 0.02}}};

/// Stripes of all three regions.
RegionMap stripes(Extent size) {
    RegionMap regions(size);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            regions(x, y) = static_cast<Region>((x / 2 + y) % 4 % 3);
    return regions;
}

/// Display values from 0.3 to 0.7: far from where clipping would bend noise and bias.
double display_at(std::size_t pixel, int channel) {
    return 0.3 +
           0.4 * static_cast<double>((pixel * 37 + static_cast<std::size_t>(channel) * 11) % 101) /
               100;
}

template <class Value>
Image from_display(Extent size, Value value) {
    Image image(size);
    for (std::size_t i = 0; i < image.values().size(); ++i)
        for (int c = 0; c < 3; ++c)
            image.values()[i][c] = srgb_decode(static_cast<float>(value(i, c)));
    return image;
}

Image reference_of(Extent size) {
    return from_display(size, display_at);
}

Images noisy_images(const RegionMap& regions, std::size_t seeds, unsigned first_seed = 1) {
    Images images;
    for (std::size_t s = 0; s < seeds; ++s) {
        Gauss gauss(first_seed + static_cast<unsigned>(s));
        images.push_back(from_display(regions.size(), [&](std::size_t i, int c) {
            const Disturbance& d = kDisturbances[region_index(regions.values()[i])];
            return display_at(i, c) + d.bias + d.sigma * gauss();
        }));
    }
    return images;
}

/// Mean over the region's pixels and channels of squared differences of display values.
double mean_square(const Image& a, const Image& b, const RegionMap& regions, Region region) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < a.values().size(); ++i) {
        if (regions.values()[i] != region) continue;
        const glm::dvec3 d =
            glm::dvec3(display_value(a.values()[i])) - glm::dvec3(display_value(b.values()[i]));
        sum += d.x * d.x + d.y * d.y + d.z * d.z;
        count += 3;
    }
    return sum / static_cast<double>(count);
}

/// Half of the mean over pairs of their squared difference.
double noise_by_pairs(const Images& images, const RegionMap& regions, Region region) {
    double sum = 0, pairs = 0;
    for (std::size_t i = 0; i < images.size(); ++i)
        for (std::size_t j = i + 1; j < images.size(); ++j, ++pairs)
            sum += mean_square(images[i], images[j], regions, region);
    return sum / pairs / 2;
}

double mean_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

auto close_to(double value) {
    return Approx(value).epsilon(1e-12).margin(1e-15);
}

const SeedStatistics& region_of(const SeedStatisticsByRegion& all, Region region) {
    return all.regions.value()[region_index(region)];
}

}  // namespace

TEST_CASE("noise and bias that images were made with are found again", "[seed_statistics]") {
    const RegionMap regions = stripes({96, 64});
    const std::size_t seeds = GENERATE(2u, 4u, 9u);
    const auto found =
        seed_statistics(noisy_images(regions, seeds), reference_of({96, 64}), &regions);
    REQUIRE(found);
    const auto n = static_cast<double>(seeds);
    for (const RegionInfo& info : kRegions) {
        CAPTURE(info.name, seeds);
        const SeedStatistics& s = region_of(*found, info.region);
        const Disturbance& made = kDisturbances[region_index(info.region)];
        const double values = 3 * static_cast<double>(s.pixels);
        const double variance = made.sigma * made.sigma;
        // Five standard errors of the estimators for Gaussian noise.
        const double noise_error = variance * std::sqrt(2 / ((n - 1) * values));
        CHECK(s.noise.value() == Approx(variance).epsilon(0).margin(5 * noise_error));
        const double bias2 = made.bias * made.bias;
        const double spread = 2 * variance * variance / (n * (n - 1)) + 4 * bias2 * variance / n;
        const double bias2_error = std::sqrt(spread / values);
        CHECK(s.bias2.value() == Approx(bias2).epsilon(0).margin(5 * bias2_error));
        CHECK(bias2 > 10 * bias2_error);
    }
}

TEST_CASE("noise is half of the mean squared difference of two seeds", "[seed_statistics]") {
    const RegionMap regions = stripes({17, 12});
    const std::size_t seeds = GENERATE(2u, 3u, 4u, 7u);
    const Images images = noisy_images(regions, seeds);
    const auto found = seed_statistics(images, reference_of({17, 12}), &regions);
    for (const RegionInfo& info : kRegions) {
        CAPTURE(info.name, seeds);
        CHECK(region_of(found.value(), info.region).noise.value() ==
              close_to(noise_by_pairs(images, regions, info.region)));
    }
    const RegionMap whole({17, 12}, Region::edge);
    CHECK(found->whole.noise.value() == close_to(noise_by_pairs(images, whole, Region::edge)));
}

TEST_CASE("pseudo-values are those of leaving one seed out", "[seed_statistics]") {
    const RegionMap regions = stripes({17, 12});
    const std::size_t seeds = GENERATE(3u, 4u, 7u);
    const Images images = noisy_images(regions, seeds);
    const Image reference = reference_of({17, 12});
    const auto found = seed_statistics(images, reference, &regions);
    const auto n = static_cast<double>(seeds);
    for (const RegionInfo& info : kRegions) {
        CAPTURE(info.name, seeds);
        const SeedStatistics& s = region_of(found.value(), info.region);
        REQUIRE(s.noise_by_seed.size() == seeds);
        REQUIRE(s.bias2_by_seed.size() == seeds);
        for (std::size_t i = 0; i < seeds; ++i) {
            Images others = images;
            others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
            const double without = noise_by_pairs(others, regions, info.region);
            const double mse = mean_square(images[i], reference, regions, info.region);
            CHECK(s.mse[i] == close_to(mse));
            CHECK(s.noise_by_seed[i] == close_to(n * *s.noise - (n - 1) * without));
            CHECK(s.bias2_by_seed[i] == close_to(mse - s.noise_by_seed[i]));
        }
    }
}

TEST_CASE("the mean error is bias squared and noise, and pseudo-values have their means",
          "[seed_statistics]") {
    const RegionMap regions = stripes({30, 20});
    const std::size_t seeds = GENERATE(3u, 4u, 8u);
    const auto found =
        seed_statistics(noisy_images(regions, seeds), reference_of({30, 20}), &regions);
    std::vector<SeedStatistics> all(found->regions->begin(), found->regions->end());
    all.push_back(found->whole);
    for (const SeedStatistics& s : all) {
        CAPTURE(s.pixels, seeds);
        CHECK(mean_of(s.mse) == close_to(*s.bias2 + *s.noise));
        CHECK(mean_of(s.noise_by_seed) == close_to(*s.noise));
        CHECK(mean_of(s.bias2_by_seed) == close_to(*s.bias2));
    }
}

TEST_CASE("the whole image's numbers are the means of its regions'", "[seed_statistics]") {
    const RegionMap regions = stripes({30, 20});
    const Images images = noisy_images(regions, 4);
    const auto found = seed_statistics(images, reference_of({30, 20}), &regions);
    double noise = 0, bias2 = 0;
    for (const SeedStatistics& s : *found->regions) {
        const double share = static_cast<double>(s.pixels) / (30 * 20);
        noise += share * *s.noise;
        bias2 += share * *s.bias2;
    }
    CHECK(*found->whole.noise == close_to(noise));
    CHECK(*found->whole.bias2 == close_to(bias2));
    CHECK(found->whole.pixels == 30 * 20);
    const auto without = seed_statistics(images, reference_of({30, 20}));
    CHECK(without->whole == found->whole);
    CHECK_FALSE(without->regions);
}

TEST_CASE("an image's error is the one behind psnr_float_db", "[seed_statistics]") {
    const RegionMap regions = stripes({30, 20});
    const Images images = noisy_images(regions, 2);
    const Image reference = reference_of({30, 20});
    const auto found = seed_statistics(images, reference, &regions);
    for (std::size_t i = 0; i < images.size(); ++i) {
        const Comparison comparison = compare(images[i], reference, &regions);
        CHECK(-10 * std::log10(found->whole.mse[i]) ==
              close_to(*comparison.metrics->psnr_float_db));
        for (std::size_t r = 0; r < kRegions.size(); ++r)
            CHECK(-10 * std::log10((*found->regions)[r].mse[i]) ==
                  close_to(*(*comparison.regions)[r].metrics->psnr_float_db));
    }
}

// Of n images the mean relMSE is that of their mean image, and (n - 1) / n of the variance.
TEST_CASE("the relative variance is the part of relMSE that noise makes", "[seed_statistics]") {
    const RegionMap regions = stripes({30, 20});
    const Images images = noisy_images(regions, 4);
    const Image reference = reference_of({30, 20});
    const auto found = seed_statistics(images, reference, &regions);
    Image mean_image({30, 20});
    double relmse = 0;
    for (const Image& image : images) {
        relmse += compare(image, reference).metrics->relmse / 4;
        for (std::size_t i = 0; i < mean_image.values().size(); ++i)
            mean_image.values()[i] += image.values()[i] / 4.0f;
    }
    const double of_mean = compare(mean_image, reference).metrics->relmse;
    CHECK(of_mean < 0.9 * relmse);
    CHECK(*found->whole.relative.noise * 0.75 == Approx(relmse - of_mean).epsilon(1e-4));
    double by_region = 0;
    for (const SeedStatistics& s : *found->regions)
        by_region += static_cast<double>(s.pixels) / (30 * 20) * *s.relative.noise;
    CHECK(*found->whole.relative.noise == close_to(by_region));
}

TEST_CASE("intervals from pseudo-values hold the truth about 19 times in 20", "[seed_statistics]") {
    const Extent size{8, 6};
    const RegionMap regions(size, Region::edge);
    const auto [bias, sigma] = kDisturbances[region_index(Region::edge)];
    int noise_held = 0, bias2_held = 0;
    constexpr int trials = 400;
    for (unsigned trial = 0; trial < trials; ++trial) {
        const auto found =
            seed_statistics(noisy_images(regions, 6, 100 + 6 * trial), reference_of(size));
        const Estimate noise = estimate(found->whole.noise_by_seed);
        const Estimate bias2 = estimate(found->whole.bias2_by_seed);
        noise_held += *noise.low <= sigma * sigma && sigma * sigma <= *noise.high;
        bias2_held += *bias2.low <= bias * bias && bias * bias <= *bias2.high;
    }
    CAPTURE(noise_held, bias2_held);
    CHECK(noise_held > 0.91 * trials);
    CHECK(noise_held < 0.99 * trials);
    CHECK(bias2_held > 0.91 * trials);
    CHECK(bias2_held < 0.99 * trials);
}

TEST_CASE("few seeds say less", "[seed_statistics]") {
    const RegionMap regions = stripes({9, 8});
    const Images images = noisy_images(regions, 3);
    const auto with = [&](std::size_t seeds) {
        return seed_statistics(std::span(images).first(seeds), reference_of({9, 8})).value().whole;
    };
    CHECK(with(1).mse.size() == 1);
    CHECK_FALSE(with(1).noise);
    CHECK_FALSE(with(1).bias2);
    CHECK_FALSE(with(1).relative.noise);
    CHECK(with(1).noise_by_seed.empty());
    CHECK(with(2).noise);
    CHECK(with(2).bias2);
    CHECK(with(2).noise_by_seed.empty());
    CHECK(with(2).bias2_by_seed.empty());
    CHECK(with(3).noise_by_seed.size() == 3);
}

TEST_CASE("equal seeds have no noise, and what differs beyond [0,1] does not count",
          "[seed_statistics]") {
    const Image reference = reference_of({9, 8});
    Images images(3, from_display({9, 8}, [](std::size_t, int) { return 0.9; }));
    images[0](1, 1) = glm::vec3(1.0f);
    images[1](1, 1) = glm::vec3(2.0f);
    images[2](1, 1) = glm::vec3(300.0f);
    const SeedStatistics s = seed_statistics(images, reference)->whole;
    CHECK(*s.noise == 0.0);
    CHECK(*s.bias2 == close_to(s.mse[0]));
    CHECK(s.mse[0] == s.mse[2]);
    CHECK(s.noise_by_seed == std::vector<double>(3, 0.0));
}

TEST_CASE("a region without a pixel has no numbers", "[seed_statistics]") {
    const RegionMap regions({9, 8}, Region::interior);
    const auto found = seed_statistics(noisy_images(regions, 3), reference_of({9, 8}), &regions);
    CHECK(region_of(*found, Region::emitter) == SeedStatistics{});
    CHECK(region_of(*found, Region::interior) == found->whole);
}

TEST_CASE("a group with a non-finite value is never scored", "[seed_statistics]") {
    const RegionMap regions = stripes({9, 8});
    Images images = noisy_images(regions, 3);
    Image reference = reference_of({9, 8});
    const float bad = GENERATE(
        values({std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}));
    SECTION("in an image") {
        images[2](8, 7).z = bad;
    }
    SECTION("in the reference") {
        reference(0, 0).x = bad;
    }
    CHECK_FALSE(seed_statistics(images, reference, &regions));
    CHECK_FALSE(seed_statistics({}, reference_of({9, 8})));
}

TEST_CASE("images and regions of other sizes are a mismatch", "[seed_statistics]") {
    const RegionMap regions = stripes({9, 8});
    const Images images = noisy_images(regions, 2);
    const RegionMap others = stripes({8, 9});
    CHECK(error_of([&] {
              seed_statistics(images, reference_of({8, 9}));
          }).code() == ExitCode::mismatch);
    CHECK(error_of([&] {
              seed_statistics(images, reference_of({9, 8}), &others);
          }).code() == ExitCode::mismatch);
}

TEST_CASE("statistics over seeds survive JSON, every bit of them", "[seed_statistics]") {
    RegionMap regions = stripes({9, 8});
    for (Region& region : regions.values())
        if (region == Region::edge) region = Region::interior;
    const std::size_t seeds = GENERATE(1u, 2u, 4u);
    const RegionMap* const given = GENERATE(false, true) ? &regions : nullptr;
    const auto found = seed_statistics(noisy_images(regions, seeds), reference_of({9, 8}), given);
    const std::string text = seed_statistics_json(*found).dump();
    const nlohmann::json json = parse_json_text(text, "statistics");
    CHECK(json.contains("regions") == (given != nullptr));
    CHECK(json["noise"].is_null() == (seeds == 1));
    CHECK(read_seed_statistics(JsonValue(json, "statistics")) == *found);
}

TEST_CASE("JSON that is no statistics over seeds is an error", "[seed_statistics]") {
    const RegionMap regions = stripes({9, 8});
    const auto found = seed_statistics(noisy_images(regions, 3), reference_of({9, 8}), &regions);
    nlohmann::json json = seed_statistics_json(*found);
    const auto message = [&] {
        return std::string(
            error_of([&] { read_seed_statistics(JsonValue(json, "s.json")); }).what());
    };
    json["regions"]["edge"]["mse"][1] = "large";
    CHECK(message().find("s.json: /regions/edge/mse/1: found \"large\"") == 0);
    json["regions"].erase("edge");
    CHECK(message().find("edge") != std::string::npos);
    json["noise"] = "loud";
    CHECK(message().find("s.json: /noise: found \"loud\"") == 0);
}
