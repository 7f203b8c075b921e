// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "core/color.h"
#include "core/error.h"
#include "eval/colour_map.h"
#include "eval/error_map.h"
#include "eval/metrics.h"
#include "tests/catch.h"

using namespace vecino;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// Linear values within and beyond [0,1].
Image random_image(Extent size, unsigned seed) {
    std::mt19937 generator(seed);
    Image image(size);
    for (glm::vec3& pixel : image.values())
        for (int c = 0; c < 3; ++c)
            pixel[c] = static_cast<float>(generator() % 4096) / 2400.0f - 0.2f;
    return image;
}

Grid<float> row(const std::vector<float>& values) {
    Grid<float> grid({static_cast<int>(values.size()), 1});
    grid.values() = values;
    return grid;
}

std::vector<glm::u8vec3> colours_of(const std::vector<float>& values,
                                    const ErrorPictureStyle& style) {
    return error_colours(row(values), style).values();
}

/// Equal but for the rounding of the library's maps.
bool alike(glm::u8vec3 a, glm::u8vec3 b) {
    const glm::ivec3 difference = glm::ivec3(a) - glm::ivec3(b);
    return std::abs(difference.x) <= 1 && std::abs(difference.y) <= 1 &&
           std::abs(difference.z) <= 1;
}

/// What eyes without colour vision see of a colour, 0..1.
double luminance(glm::u8vec3 c) {
    const auto linear = [](std::uint8_t v) {
        return double(srgb_decode(static_cast<float>(v) / 255.0f));
    };
    return 0.2126 * linear(c.r) + 0.7152 * linear(c.g) + 0.0722 * linear(c.b);
}

/// CIE lightness, 0..100.
double lightness(glm::u8vec3 c) {
    return 116 * std::cbrt(luminance(c)) - 16;
}

}  // namespace

TEST_CASE("the mean of magnitude^2 is the mean squared error behind psnr_float_db", "[error_map]") {
    const Image test = random_image({37, 21}, 1), reference = random_image({37, 21}, 2);
    const Grid<float> magnitude = error_values(test, reference, ErrorKind::magnitude);
    double sum = 0;
    for (const float value : magnitude.values()) sum += double(value) * double(value);
    const double psnr = compare(test, reference).metrics.value().psnr_float_db.value();
    CHECK(sum / 777 == Approx(std::pow(10.0, -psnr / 10)).epsilon(1e-6));
}

TEST_CASE("error values of single pixels match values worked out by hand", "[error_map]") {
    struct Case {
        glm::vec3 test, reference;
        float magnitude, sign;
    };
    const auto c = GENERATE(Case{{1, 0, 0}, {0, 0, 0}, std::sqrt(1.0f / 3), 1.0f / 3},
                            Case{{0, 0, 1}, {1, 1, 1}, std::sqrt(2.0f / 3), -2.0f / 3},
                            Case{{1, 0, 0}, {0, 1, 0}, std::sqrt(2.0f / 3), 0},
                            Case{{9, -3, 1}, {1, 0, 2}, 0, 0},  // beyond [0,1] nothing differs
                            Case{{.5f, .5f, .5f}, {.25f, .25f, .25f}, .1982583f, .1982583f});
    const Image test({1, 1}, c.test), reference({1, 1}, c.reference);
    CHECK(error_values(test, reference, ErrorKind::magnitude)(0, 0) ==
          Approx(c.magnitude).epsilon(1e-5).margin(1e-9));
    CHECK(error_values(test, reference, ErrorKind::sign)(0, 0) ==
          Approx(c.sign).epsilon(1e-5).margin(1e-9));
}

TEST_CASE("error values are NaN exactly where either image is not finite", "[error_map]") {
    const auto kind = GENERATE(ErrorKind::magnitude, ErrorKind::sign);
    Image test = random_image({5, 4}, 3), reference = random_image({5, 4}, 4);
    test(1, 2).z = kNaN;
    reference(4, 0).x = -kInf;
    test(0, 3).y = reference(0, 3).y = kInf;
    const Grid<float> values = error_values(test, reference, kind);
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 5; ++x) {
            CAPTURE(x, y);
            const bool spoilt = (x == 1 && y == 2) || (x == 4 && y == 0) || (x == 0 && y == 3);
            CHECK(std::isnan(values(x, y)) == spoilt);
        }
}

TEST_CASE("images of different sizes have no error map", "[error_map]") {
    try {
        error_values(Image({2, 7}), Image({7, 2}), ErrorKind::sign);
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::mismatch);
    }
}

TEST_CASE("the suggested range is the least round number not below the values", "[error_map]") {
    struct Case {
        float value, range;
    };
    const auto c = GENERATE(Case{0, .001f}, Case{.0009f, .001f}, Case{.001f, .001f},
                            Case{.0011f, .002f}, Case{.021f, .05f}, Case{.05f, .05f},
                            Case{.051f, .1f}, Case{.2f, .2f}, Case{.201f, .5f}, Case{-.3f, .5f},
                            Case{.6f, 1.0f}, Case{1.0f, 1.0f}, Case{30.0f, 50.0f});
    CAPTURE(c.value);
    CHECK(suggested_range(row({c.value})) == c.range);
}

TEST_CASE("the suggested range leaves out the largest hundredth and non-finite values",
          "[error_map]") {
    std::vector<float> values(200, 0.04f);
    values[17] = values[150] = -0.9f;
    CHECK(suggested_range(row(values)) == 0.05f);
    values[3] = 0.9f;  // three of 200 are more than a hundredth
    CHECK(suggested_range(row(values)) == 1.0f);
    values[3] = kInf;
    values[17] = kNaN;
    CHECK(suggested_range(row(values)) == 0.05f);
    CHECK(suggested_range(row({kNaN, kInf})) == 0.001f);
}

TEST_CASE("magnitude runs from black at 0 to pale yellow at the range and stays there",
          "[error_map]") {
    const auto colours = colours_of({0.0f, 0.02f, 0.5f}, {ErrorKind::magnitude, 0.02f, ""});
    CHECK(alike(colours[0], {0, 0, 4}));
    CHECK(alike(colours[1], {252, 253, 191}));
    CHECK(colours[2] == colours[1]);
}

TEST_CASE("a larger magnitude never looks darker, even without colour vision", "[error_map]") {
    double previous = -1;
    for (int i = 0; i <= 1000; ++i) {
        const float value = static_cast<float>(i) / 1000.0f;
        const double now = luminance(colours_of({value}, {ErrorKind::magnitude, 1.0f, ""})[0]);
        CHECK(now >= previous - 1e-3);  // one 8-bit step of the map's rounding
        previous = now;
    }
    CHECK(previous > 0.9);
}

TEST_CASE("sign runs from blue over a neutral grey at 0 to red and stays there", "[error_map]") {
    const auto colours = colours_of({-0.3f, -0.1f, 0.0f, 0.1f, 0.3f}, {ErrorKind::sign, 0.1f, ""});
    CHECK(colours[0] == colours[1]);
    CHECK(alike(colours[1], {59, 76, 192}));
    CHECK(alike(colours[2], {221, 221, 221}));
    CHECK(colours[2].r == colours[2].g);
    CHECK(colours[2].g == colours[2].b);
    CHECK(alike(colours[3], {180, 4, 38}));
    CHECK(colours[4] == colours[3]);
}

TEST_CASE("positive and negative errors of one size look equally strong", "[error_map]") {
    const ErrorPictureStyle style{ErrorKind::sign, 1.0f, ""};
    const double grey = lightness(colours_of({0.0f}, style)[0]);
    for (int i = 1; i <= 100; ++i) {
        const float value = static_cast<float>(i) / 100.0f;
        const auto colours = colours_of({-value, value}, style);
        CAPTURE(value);
        const double cool = grey - lightness(colours[0]), warm = grey - lightness(colours[1]);
        CHECK(std::abs(cool - warm) < 2.0 * double(value) + 0.5);
        CHECK(warm > 45.0 * double(value) - 0.5);
        CHECK(colours[0].b > colours[0].r);
        CHECK(colours[1].r > colours[1].b);
    }
}

TEST_CASE("the non-finite colour stands where there is no number and nowhere else", "[error_map]") {
    const auto kind = GENERATE(ErrorKind::magnitude, ErrorKind::sign);
    std::vector<float> values;
    for (int i = -3000; i <= 3000; ++i) values.push_back(static_cast<float>(i) / 2000.0f);
    const std::size_t finite = values.size();
    values.insert(values.end(), {kNaN, kInf, -kInf});
    const auto colours = colours_of(values, {kind, 1.0f, ""});
    for (std::size_t i = 0; i < colours.size(); ++i)
        CHECK((colours[i] == kNonFiniteColour) == (i >= finite));
}

TEST_CASE("a range that is not a positive number is refused", "[error_map]") {
    const float range = GENERATE(values({0.0f, -0.1f, kNaN, kInf}));
    try {
        error_picture(row({0.0f}), {ErrorKind::magnitude, range, ""});
        FAIL("no error");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::usage);
    }
}
