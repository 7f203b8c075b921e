// SPDX-License-Identifier: Apache-2.0
//
// ms_ssim, flip, hdr_flip and smape against values of other programs, which metric_pins.py prints.
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "core/color.h"
#include "eval/flip.h"
#include "eval/metrics.h"
#include "tests/catch.h"
#include "tests/metric_patterns.h"

using namespace vecino;

namespace {

const std::vector<std::string> kHdrFlip = {"hdr_flip"};

/// The linear image of up to 15.9 whose values metric_pins.py calls hdr.
Image hdr_image(Pattern pattern, Extent size, std::uint32_t seed) {
    Image image(size);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            for (int c = 0; c < 3; ++c) {
                const auto value = static_cast<float>(pattern(x, y, c, seed));
                image(x, y)[c] = value * value / 4096;
            }
    return image;
}

Metrics metrics_of(const Image& test, const Image& reference) {
    const Comparison comparison = compare(test, reference, nullptr, kHdrFlip);
    REQUIRE(comparison.metrics.has_value());
    return *comparison.metrics;
}

auto near(double value, double tolerance) {
    return Approx(value).epsilon(0).margin(tolerance);
}

/// Where all pixels are alike, features are differences of equal sums, whose rounding in 32 bits
/// the authors' program takes the square root of.
constexpr double kFlat = 1e-5;

struct FlipPin {
    Pattern pattern;
    Extent size;
    double mean;
    double tolerance;
    std::array<double, 3> corner_centre_corner;  ///< of the map
};

void check_map(const Grid<float>& map, const FlipPin& pin) {
    const auto [width, height] = pin.size;
    const std::array found = {map(0, 0), map(width / 2, height / 2), map(width - 1, height - 1)};
    for (std::size_t i = 0; i < found.size(); ++i) {
        CAPTURE(i);
        CHECK(static_cast<double>(found[i]) == near(pin.corner_centre_corner[i], 2e-5));
    }
}

}  // namespace

TEST_CASE("ms_ssim agrees with pytorch-msssim and TensorFlow", "[metrics]") {
    struct Pin {
        Pattern pattern;
        Extent size;
        double ms_ssim, tolerance;
    };
    // TensorFlow computes in 32 bits; pytorch-msssim knows no odd sizes.
    const auto pin = GENERATE(Pin{patches, {176, 192}, 0.9346920219446715, 1e-9},
                              Pin{noise, {192, 176}, 0.06882507169139045, 1e-9},
                              Pin{patches, {161, 163}, 0.93474555, 1e-6});
    CAPTURE(pin.size.width, pin.size.height);
    const Metrics metrics =
        metrics_of(linear_image(pin.pattern, pin.size, 2), linear_image(pin.pattern, pin.size, 1));
    CHECK(metrics.ms_ssim.value() == near(pin.ms_ssim, pin.tolerance));
    CHECK(metrics.ms_ssim_reason.empty());
}

TEST_CASE("ms_ssim is null with a reason below 161 pixels", "[metrics]") {
    const auto size = GENERATE(Extent{160, 200}, Extent{200, 160}, Extent{3, 3});
    const std::string text = std::to_string(size.width) + "x" + std::to_string(size.height);
    const Metrics metrics = metrics_of(linear_image(noise, size, 2), linear_image(noise, size, 1));
    CHECK_FALSE(metrics.ms_ssim.has_value());
    CHECK(metrics.ms_ssim_reason ==
          "image is " + text + ", ms_ssim needs at least 161 pixels in both axes");
}

TEST_CASE("ms_ssim counts a scale that opposes the reference as 0", "[metrics]") {
    // Mirrored contrast: negative covariance, of which no power of a fraction exists.
    Image test({161, 161}), reference({161, 161});
    for (int y = 0; y < 161; ++y)
        for (int x = 0; x < 161; ++x) {
            const bool is_light = (x + y) % 2 == 0;
            test(x, y) = glm::vec3(is_light ? 0.6f : 0.2f);
            reference(x, y) = glm::vec3(is_light ? 0.2f : 0.6f);
        }
    CHECK(metrics_of(test, reference).ms_ssim == 0.0);
}

TEST_CASE("flip agrees with the authors' program", "[metrics]") {
    const auto pin =
        GENERATE(FlipPin{patches,
                         {48, 40},
                         0.19072055304422975,
                         2e-6,
                         {0.05242530629038811, 0.12624000012874603, 0.16254203021526337}},
                 FlipPin{noise,
                         {33, 21},
                         0.5049078094666827,
                         2e-6,
                         {0.7535175681114197, 0.20174042880535126, 0.9704515337944031}},
                 FlipPin{patches,
                         {5, 7},
                         0.09696048870682716,
                         2e-6,
                         {0.04740974307060242, 0.0655011534690857, 0.1483711451292038}},
                 FlipPin{patches,
                         {1, 1},
                         0.1546049565076828,
                         kFlat,
                         {0.1546049565076828, 0.1546049565076828, 0.1546049565076828}});
    CAPTURE(pin.size.width, pin.size.height);
    const Image test = linear_image(pin.pattern, pin.size, 2);
    const Image reference = linear_image(pin.pattern, pin.size, 1);
    CHECK(metrics_of(test, reference).flip == near(pin.mean, pin.tolerance));
    check_map(flip_map(test, reference), pin);
}

TEST_CASE("hdr_flip agrees with the authors' program at the same exposures", "[metrics]") {
    const auto pin =
        GENERATE(FlipPin{patches,
                         {48, 40},
                         0.29782968677269916,
                         2e-6,
                         {0.19223687052726746, 0.2027968019247055, 0.27850422263145447}},
                 FlipPin{noise,
                         {33, 21},
                         0.5098837461607453,
                         2e-6,
                         {0.7721496820449829, 0.4626810550689697, 0.9632543921470642}},
                 FlipPin{patches,
                         {5, 7},
                         0.17761491292289325,
                         2e-6,
                         {0.17354507744312286, 0.10952345281839371, 0.23883302509784698}},
                 FlipPin{patches,
                         {1, 1},
                         0.21199648082256317,
                         kFlat,
                         {0.21199648082256317, 0.21199648082256317, 0.21199648082256317}});
    CAPTURE(pin.size.width, pin.size.height);
    const Image test = hdr_image(pin.pattern, pin.size, 2);
    const Image reference = hdr_image(pin.pattern, pin.size, 1);
    CHECK(metrics_of(test, reference).hdr_flip.value() == near(pin.mean, pin.tolerance));
    check_map(hdr_flip_map(test, reference), pin);
}

TEST_CASE("smape agrees with NumPy and values worked out by hand", "[metrics]") {
    const auto of = [](Pattern pattern, Extent size) {
        return metrics_of(hdr_image(pattern, size, 2), hdr_image(pattern, size, 1)).smape;
    };
    CHECK(of(patches, {48, 40}) == near(0.17939301876168223, 1e-9));
    CHECK(of(noise, {33, 21}) == near(0.5696690556309651, 1e-9));
    // A sign that differs is no smaller error.
    const Image test({1, 1}, {-1, 0, 3}), reference({1, 1}, {1, 0, 1});
    CHECK(metrics_of(test, reference).smape == near((2 / 2.01 + 0 + 2 / 4.01) / 3, 1e-12));
}

TEST_CASE("hdr_flip is measured on request alone", "[metrics]") {
    const Image a({4, 4}, glm::vec3(0.5f)), b({4, 4}, glm::vec3(0.75f));
    CHECK_FALSE(compare(a, b).metrics.value().hdr_flip);
    CHECK(compare(a, b, nullptr, kHdrFlip).metrics.value().hdr_flip.value() > 0);
    CHECK(metrics_on_request() == kHdrFlip);
}

TEST_CASE("hdr_flip sees what a screen clips and keeps finite", "[metrics]") {
    const Extent size{12, 12};
    const Image lamp(size, glm::vec3(15)), dim_lamp(size, glm::vec3(2));
    const Metrics metrics = metrics_of(dim_lamp, lamp);
    CHECK(metrics.flip == 0);
    CHECK(metrics.hdr_flip.value() > 0.1);
    const Image sun(size, glm::vec3(3e38f)), negative(size, glm::vec3(-3e38f));
    CHECK(metrics_of(sun, negative).hdr_flip.value() > 0.5);
    CHECK(metrics_of(negative, Image(size)).hdr_flip == 0.0);
}

TEST_CASE("flip of a region is the mean of the map there", "[metrics]") {
    const Extent size{30, 20};
    RegionMap regions(size, Region::interior);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < 10; ++x) regions(x, y) = Region::edge;
    const Image test = linear_image(patches, size, 2), reference = linear_image(patches, size, 1);
    const Grid<float> map = flip_map(test, reference);
    double sum = 0;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < 10; ++x) sum += static_cast<double>(map(x, y));
    const auto edge =
        compare(test, reference, &regions).regions.value()[region_index(Region::edge)];
    CHECK(edge.metrics.value().flip == near(sum / 200, 1e-9));
    CHECK_FALSE(edge.metrics->ms_ssim);
}
