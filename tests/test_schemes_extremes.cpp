// SPDX-License-Identifier: Apache-2.0
//
// What holds for every scheme at the edges: of sizes, of the numbers that float has, of ids. Each
// test goes over the table, so a new row is tested at once.
#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/catch.h"
#include "tests/scheme_cells.h"

using namespace vecino;

namespace {

/// A frame, and a size that it is rebuilt at.
struct Sizes {
    Extent low, full;
};

// One pixel, one row, one column, primes; factors that do and do not divide, another one per axis.
constexpr Sizes kSizes[] = {
    {{1, 1}, {1, 1}},      {{1, 1}, {5, 3}},       {{1, 7}, {1, 7}},      {{1, 7}, {3, 16}},
    {{7, 1}, {23, 1}},     {{2, 1}, {2, 9}},       {{64, 22}, {257, 89}}, {{128, 44}, {257, 89}},
    {{85, 29}, {257, 89}}, {{257, 89}, {257, 89}},
};

using Limits = std::numeric_limits<float>;

constexpr float kExtremes[] = {Limits::max(),  Limits::lowest(),
                               Limits::min(),  Limits::denorm_min(),
                               -Limits::min(), 0.0f,
                               -0.0f,          1.0f,
                               0x1p-75f,       0x1p64f};

float extreme(Random& random) {
    constexpr auto count = static_cast<float>(std::size(kExtremes));
    return kExtremes[static_cast<std::size_t>(random.unit() * count)];
}

glm::vec3 extreme_vector(Random& random) {
    const float x = extreme(random);
    const float y = extreme(random);
    return {x, y, extreme(random)};
}

double largest(const Image& image) {
    double value = 0;
    for (const glm::vec3& color : image.values())
        for (int c = 0; c < 3; ++c) value = std::max(value, double{std::abs(color[c])});
    return value;
}

std::size_t broken_pixels(const Image& image) {
    return static_cast<std::size_t>(std::ranges::count_if(
        image.values(), [](const glm::vec3& color) { return !is_finite(color); }));
}

}  // namespace

TEST_CASE("every size has a finite image, and constants stay constant in it", "[schemes]") {
    const int window = GENERATE(1, 3, 5);
    for (const Sizes& sizes : kSizes) {
        const Frame low = random_frame(sizes.low, FrameContent::awkward);
        Frame constant = low;
        constant.radiance = Image(sizes.low, {0.1f, 0.7f, 13.3f});
        INFO(size_text(sizes.low) << " to " << size_text(sizes.full));
        for_each_cell(window, [&](const Scheme& scheme, const SchemeParameters& p) {
            const Reconstruction result = rebuild(low, scheme, p, sizes.full);
            CHECK(result.image.size() == sizes.full);
            CHECK(all_finite(result.image));
            CHECK(result.dropped_samples == broken_pixels(low.radiance));
            CHECK(result.non_finite_pixels <= sizes.full.area());
            CHECK(same_bits(rebuild(constant, scheme, p, sizes.full).image,
                            Image(sizes.full, {0.1f, 0.7f, 13.3f})));
        });
    }
}

TEST_CASE("colours scaled by any factor scale the result", "[schemes]") {
    const float factor = GENERATE(3.7f, 1.0e-20f, 1.0e20f);
    const Frame low = random_frame({23, 17}, FrameContent::awkward);
    Frame scaled = low;
    for (glm::vec3& color : scaled.radiance.values()) color *= factor;
    for_each_cell(5, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        Reconstruction expected = rebuild(low, scheme, parameters, {47, 35});
        const Reconstruction result = rebuild(scaled, scheme, parameters, {47, 35});
        for (glm::vec3& color : expected.image.values()) color *= factor;
        CHECK(relative_difference(result.image, expected.image) <= 2e-6);
        CHECK(result.fallback_pixels == expected.fallback_pixels);
        CHECK(result.dropped_samples == expected.dropped_samples);
    });
}

TEST_CASE("extremes of float in every plane give finite images", "[schemes]") {
    Random random(GENERATE(1u, 2u, 3u, 4u));
    Frame low = random_frame({13, 11}, FrameContent::benign);
    for (glm::vec3& color : low.radiance.values()) color = extreme_vector(random);
    for (glm::vec3& position : low.position_world.values()) position = extreme_vector(random);
    for (glm::vec3& normal : low.normal_world.values())
        if (random.chance(0.3f)) normal = extreme_vector(random);
    for_each_cell(GENERATE(1, 3, 7), [&](const Scheme& scheme, const SchemeParameters& parameters) {
        const Reconstruction result = rebuild(low, scheme, parameters, {29, 31});
        CHECK(all_finite(result.image));
        CHECK(result.dropped_samples == 0);
        CHECK(result.non_finite_pixels == 0);
        CHECK(largest(result.image) <= double{Limits::max()});
    });
}

TEST_CASE("where no colour is finite the image is black and every pixel counted", "[schemes]") {
    const float bad = GENERATE(values({kNaN, kInfinity, -kInfinity}));
    Frame low = random_frame({6, 5}, FrameContent::benign);
    low.radiance = Image(low.size(), glm::vec3(bad));
    for_each_cell(3, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        const Extent full{12, 10};
        const Reconstruction result = rebuild(low, scheme, parameters, full);
        CHECK(same_bits(result.image, Image(full)));
        CHECK(result.dropped_samples == low.size().area());
        CHECK(result.non_finite_pixels >= low.size().area());
    });
}

TEST_CASE("a colour that is not finite in a corner stays within its window", "[schemes]") {
    const Frame low = random_frame({17, 13}, FrameContent::benign);
    Frame broken = low;
    broken.radiance(16, 12).x = kNaN;
    const int window = GENERATE(3, 5);
    for_each_cell(window, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        const Image expected = rebuild(low, scheme, parameters, {34, 26}).image;
        const Reconstruction result = rebuild(broken, scheme, parameters, {34, 26});
        CHECK(result.dropped_samples == 1);
        // Schemes with a guide interpolate between low-res pixels: one more on either side.
        const int reach = window / 2 + 1;
        int changed_beyond = 0;
        for (int y = 0; y < 26; ++y) {
            for (int x = 0; x < 34; ++x) {
                const bool beyond = x / 2 < 16 - reach || y / 2 < 12 - reach;
                changed_beyond += beyond && result.image(x, y) != expected(x, y) ? 1 : 0;
            }
        }
        CHECK(changed_beyond == 0);
    });
}

TEST_CASE("ids of any value are objects, all but that of a miss", "[schemes]") {
    using Ids = std::numeric_limits<std::int32_t>;
    const std::int32_t id = GENERATE(Ids::min(), Ids::max(), -2, 123456789);
    Frame low = random_frame({15, 9}, FrameContent::benign);
    for_each_cell(5, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        low.object_id = Grid<std::int32_t>(low.size(), 0);
        const Reconstruction expected = rebuild(low, scheme, parameters, {31, 20});
        low.object_id = Grid<std::int32_t>(low.size(), id);
        const Reconstruction result = rebuild(low, scheme, parameters, {31, 20});
        CHECK(same_bits(result.image, expected.image));
        CHECK(result.fallback_pixels == expected.fallback_pixels);
    });
}
