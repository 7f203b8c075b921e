// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "core/error.h"
#include "eval/metrics.h"
#include "tests/catch.h"
#include "tests/metric_patterns.h"

using namespace vecino;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

Metrics metrics_of(const Image& test, const Image& reference) {
    const Comparison comparison = compare(test, reference);
    REQUIRE(comparison.metrics.has_value());
    return *comparison.metrics;
}

Image single_pixel(glm::vec3 value) {
    return Image({1, 1}, value);
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

auto near(double value, double tolerance) {
    return Approx(value).epsilon(0).margin(tolerance);
}

}  // namespace

// The pinned numbers are scikit-image 0.26's:
//
//   import numpy as np
//   from skimage.metrics import peak_signal_noise_ratio as psnr, structural_similarity as ssim
//   def hash8(x, y, c, seed):
//       h = (x * 73856093 ^ y * 19349663 ^ c * 83492791 ^ seed * 2654435761) & 0xffffffff
//       h = (h ^ h >> 13) * 0x5bd1e995 & 0xffffffff
//       return (h ^ h >> 15) & 255
//   noise = hash8
//   def ramp(x, y, c, seed): return (5 * x + 3 * y + 40 * c) % 200 + hash8(x, y, c, seed) % 16
//   for f, w, h in (noise, 40, 30), (ramp, 33, 20), (ramp, 11, 11), (ramp, 12, 64):
//       r, t = (np.uint8([[[f(x, y, c, s) for c in range(3)] for x in range(w)] for y in range(h)])
//               for s in (1, 2))
//       print(psnr(r, t, data_range=255), ssim(r, t, gaussian_weights=True, sigma=1.5,
//             use_sample_covariance=False, data_range=255, channel_axis=-1))
TEST_CASE("psnr and ssim agree with scikit-image on the 8-bit images", "[metrics]") {
    struct Pin {
        Pattern pattern;
        Extent size;
        double psnr_db, ssim;
    };
    const auto pin = GENERATE(Pin{noise, {40, 30}, 7.745713363669617, 0.003075728893544937},
                              Pin{ramp, {33, 20}, 31.79397718411589, 0.8749455861428403},
                              Pin{ramp, {11, 11}, 31.86115371539488, 0.862168188886803},
                              Pin{ramp, {12, 64}, 31.938755782361493, 0.8760985350463418});
    CAPTURE(pin.size.width, pin.size.height);
    const Metrics metrics =
        metrics_of(linear_image(pin.pattern, pin.size, 2), linear_image(pin.pattern, pin.size, 1));
    CHECK(metrics.psnr_db.value() == near(pin.psnr_db, 1e-6));
    CHECK(metrics.ssim.value() == near(pin.ssim, 1e-4));
    CHECK_FALSE(metrics.identical_8bit);
    // Nothing is lost by quantising these images, so both forms of psnr must meet.
    CHECK(metrics.psnr_float_db.value() == near(pin.psnr_db, 1e-3));
}

TEST_CASE("two independent noise images have an ssim near 0", "[metrics]") {
    // Constants meant for 0..255 applied to values in [0,1] would give 0.99 here.
    const Extent size{64, 48};
    const Metrics metrics = metrics_of(linear_image(noise, size, 7), linear_image(noise, size, 8));
    CHECK(std::abs(metrics.ssim.value()) < 0.03);
}

TEST_CASE("ssim is null with a reason when an axis is shorter than its window", "[metrics]") {
    const auto size = GENERATE(Extent{10, 20}, Extent{20, 10}, Extent{1, 1});
    const std::string text = std::to_string(size.width) + "x" + std::to_string(size.height);
    const Metrics metrics = metrics_of(linear_image(ramp, size, 2), linear_image(ramp, size, 1));
    CHECK_FALSE(metrics.ssim.has_value());
    CAPTURE(metrics.ssim_reason);
    CHECK(contains(metrics.ssim_reason, text));
    CHECK(contains(metrics.ssim_reason, "at least 11 pixels"));
    CHECK(metrics.psnr_db.has_value());
}

TEST_CASE("identical images have null psnr, ssim 1 and no error", "[metrics]") {
    const Image image = linear_image(ramp, {30, 17}, 1);
    const Metrics metrics = metrics_of(image, image);
    CHECK_FALSE(metrics.psnr_float_db.has_value());
    CHECK_FALSE(metrics.psnr_db.has_value());
    CHECK(metrics.identical_8bit);
    CHECK(metrics.ssim.value() == 1.0);
    CHECK(metrics.ssim_reason.empty());
    CHECK(metrics.flip == 0.0);
    CHECK(metrics.relmse == 0.0);
    CHECK(metrics.smape == 0.0);
    CHECK(metrics.mae == 0.0);
    CHECK(metrics.max_error == 0.0);
    CHECK(metrics.p99_error == 0.0);
}

TEST_CASE("a difference beyond [0,1] counts in the linear metrics only", "[metrics]") {
    Image reference = linear_image(ramp, {16, 16}, 1);
    Image test = reference;
    reference(3, 4) = {1.0f, 0.0f, 2.0f};
    test(3, 4) = {4.0f, -0.5f, 15.0f};
    const Metrics metrics = metrics_of(test, reference);
    CHECK_FALSE(metrics.psnr_float_db.has_value());
    CHECK_FALSE(metrics.psnr_db.has_value());
    CHECK(metrics.identical_8bit);
    CHECK(metrics.ssim.value() == 1.0);
    CHECK(metrics.max_error == 13.0);
    CHECK(metrics.mae == near((3.0 + 0.5 + 13.0) / (3 * 16 * 16), 1e-12));
}

TEST_CASE("a difference below one 8-bit step counts in psnr_float_db but not in psnr_db",
          "[metrics]") {
    const Extent size{19, 12};
    const Metrics metrics =
        metrics_of(linear_image(ramp, size, 1, 0.2f), linear_image(ramp, size, 1));
    CHECK(metrics.identical_8bit);
    CHECK_FALSE(metrics.psnr_db.has_value());
    CHECK(metrics.ssim.value() == 1.0);
    CHECK(metrics.psnr_float_db.value() == near(20 * std::log10(255 / 0.2), 1e-2));
}

TEST_CASE("psnr_float_db is that of the encoded values", "[metrics]") {
    // sRGB of 0.5 and 0.25, from the standard's formula.
    const double error = 0.7353569830524495 - 0.5370987304831942;
    const Metrics metrics =
        metrics_of(single_pixel(glm::vec3(0.25f)), single_pixel(glm::vec3(0.5f)));
    CHECK(metrics.psnr_float_db.value() == near(-20 * std::log10(error), 1e-4));
    // As 8-bit values these are 188 and 137.
    CHECK(metrics.psnr_db.value() == near(20 * std::log10(255.0 / (188 - 137)), 1e-9));
}

TEST_CASE("linear metrics match values worked out by hand", "[metrics]") {
    const Metrics metrics = metrics_of(single_pixel({1, 2, 3}), single_pixel({0, 1, 5}));
    CHECK(metrics.relmse == near((1 / 0.01 + 1 / 1.01 + 4 / 25.01) / 3, 1e-12));
    CHECK(metrics.mae == near(4.0 / 3, 1e-12));
    CHECK(metrics.max_error == 2.0);
}

TEST_CASE("p99_error is the ceil(0.99 n)-th smallest error", "[metrics]") {
    const int pixels = GENERATE(1, 33, 50, 100);
    const int n = 3 * pixels;
    Image test({pixels, 1});
    // The errors 1..n, in units of 1/1024, in a scrambled order and with both signs.
    for (int i = 0; i < n; ++i) {
        const int rank = 1 + static_cast<int>((static_cast<long>(i) * 7919 + 5) % n);
        test(i / 3, 0)[i % 3] = static_cast<float>(i % 2 == 0 ? rank : -rank) / 1024.0f;
    }
    const double rank = std::ceil(static_cast<double>(99 * n) / 100);
    CHECK(metrics_of(test, Image({pixels, 1})).p99_error == rank / 1024);
}

TEST_CASE("a non-finite value anywhere leaves no metrics", "[metrics]") {
    const float bad = GENERATE(values({kNaN, kInf, -kInf}));
    const bool in_test = GENERATE(true, false);
    const Image good = linear_image(ramp, {12, 13}, 1);
    Image spoilt = good;
    spoilt(7, 9).y = bad;
    const Comparison comparison = in_test ? compare(spoilt, good) : compare(good, spoilt);
    CHECK_FALSE(comparison.metrics.has_value());
    CHECK(comparison.non_finite.count == 1);
    CHECK(comparison.non_finite.in_test == in_test);
    CHECK(comparison.non_finite.x == 7);
    CHECK(comparison.non_finite.y == 9);
    CHECK(comparison.non_finite.channel == 1);
}

TEST_CASE("non-finite values are counted in both images and the first is by row, then column",
          "[metrics]") {
    Image test({5, 4}, glm::vec3(0.5f));
    Image reference = test;
    test(0, 3) = {kNaN, kInf, 0.0f};
    test(4, 1).x = kNaN;
    reference(2, 1) = {0.0f, -kInf, kNaN};
    reference(0, 3).z = kNaN;
    const NonFinite found = compare(test, reference).non_finite;
    CHECK(found.count == 6);
    CHECK_FALSE(found.in_test);
    CHECK(found.x == 2);
    CHECK(found.y == 1);
    CHECK(found.channel == 1);
}

TEST_CASE("of two non-finite values in one pixel the test image's is named first", "[metrics]") {
    Image test({2, 2});
    Image reference = test;
    test(1, 0).z = kInf;
    reference(1, 0).x = kNaN;
    const NonFinite found = compare(test, reference).non_finite;
    CHECK(found.count == 2);
    CHECK(found.in_test);
    CHECK(found.channel == 2);
}

TEST_CASE("images of different sizes are not compared and the error names both", "[metrics]") {
    try {
        compare(Image({4, 3}), Image({3, 4}));
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::mismatch);
        CAPTURE(error.what());
        CHECK(contains(error.what(), "4x3"));
        CHECK(contains(error.what(), "3x4"));
    }
    CHECK_THROWS_AS(compare(Image{}, Image{}), Error);
}

TEST_CASE("every metric is better for the smaller disturbance", "[metrics]") {
    const Image reference = linear_image(ramp, {161, 161}, 1);
    Image slight = reference, strong = reference;
    for (int y = 0; y < 161; ++y)
        for (int x = 0; x < 161; ++x) {
            const float sign = (x + y) % 2 == 0 ? 1.0f : -1.0f;
            slight(x, y) += sign * 0.01f;
            strong(x, y) += sign * 0.05f;
        }
    const auto info = GENERATE(from_range(all_metrics()));
    CAPTURE(info.name);
    const auto measured = [&](const Image& test) {
        return info.value(compare(test, reference, nullptr, metrics_on_request()).metrics.value());
    };
    const double with_slight = measured(slight).value();
    const double with_strong = measured(strong).value();
    CHECK((info.higher_is_better ? with_slight > with_strong : with_slight < with_strong));
}

TEST_CASE("the table of metrics names each value of the result once", "[metrics]") {
    Metrics metrics;
    metrics.psnr_float_db = 1;
    metrics.psnr_db = 2;
    metrics.ssim = 3;
    metrics.ms_ssim = 4;
    metrics.flip = 5;
    metrics.hdr_flip = 6;
    metrics.relmse = 7;
    metrics.smape = 8;
    metrics.mae = 9;
    metrics.max_error = 10;
    metrics.p99_error = 11;
    metrics.worst_tile_psnr_db = 12;
    std::set<std::string> names;
    double expected = 0;
    for (const MetricInfo& info : all_metrics()) {
        CAPTURE(info.name);
        names.emplace(info.name);
        CHECK(info.value(metrics).value() == ++expected);
        CHECK(info.formula.find('\n') == std::string_view::npos);
    }
    CHECK(names == std::set<std::string>{"psnr_float_db", "psnr_db", "ssim", "ms_ssim", "flip",
                                         "hdr_flip", "relmse", "smape", "mae", "max_error",
                                         "p99_error", "worst_tile_psnr_db"});
}
