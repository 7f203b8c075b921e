// SPDX-License-Identifier: Apache-2.0
//
// What holds for every scheme, whatever its weights: each test goes over the table, so a new row is
// tested at once.
#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>
#include <utility>

#include "tests/catch.h"
#include "tests/scheme_cells.h"

using namespace vecino;

namespace {

/// A frame with its pixels elsewhere: what was at from(x, y) is then at (x, y).
template <class From>
Frame rearranged(const Frame& frame, From from) {
    Frame result = frame;
    for (int y = 0; y < frame.size().height; ++y) {
        for (int x = 0; x < frame.size().width; ++x) {
            const auto [u, v] = from(x, y);
            result.radiance(x, y) = frame.radiance(u, v);
            result.position_world(x, y) = frame.position_world(u, v);
            result.normal_world(x, y) = frame.normal_world(u, v);
            result.object_id(x, y) = frame.object_id(u, v);
        }
    }
    return result;
}

template <class From>
Image rearranged(const Image& image, From from) {
    Image result(image.size());
    for (int y = 0; y < image.size().height; ++y) {
        for (int x = 0; x < image.size().width; ++x) {
            const auto [u, v] = from(x, y);
            result(x, y) = image(u, v);
        }
    }
    return result;
}

void scale(Grid<glm::vec3>& plane, float factor) {
    for (glm::vec3& value : plane.values()) value *= factor;
}

bool same_counts(const Reconstruction& a, const Reconstruction& b) {
    return a.fallback_pixels == b.fallback_pixels && a.dropped_samples == b.dropped_samples &&
           a.non_finite_pixels == b.non_finite_pixels;
}

struct ColorRange {
    glm::vec3 least, most;

    [[nodiscard]] bool holds(const glm::vec3& value) const {
        return glm::all(glm::greaterThanEqual(value, least)) &&
               glm::all(glm::lessThanEqual(value, most));
    }
};

/// The least and the largest values of the colours in the window around a pixel.
ColorRange range_around(int x, int y, const Image& colors, int window) {
    const Extent size = colors.size();
    const int k = window / 2;
    ColorRange range{colors(x, y), colors(x, y)};
    for (int v = std::max(0, y - k); v <= std::min(size.height - 1, y + k); ++v) {
        for (int u = std::max(0, x - k); u <= std::min(size.width - 1, x + k); ++u) {
            range.least = glm::min(range.least, colors(u, v));
            range.most = glm::max(range.most, colors(u, v));
        }
    }
    return range;
}

}  // namespace

TEST_CASE("a constant image stays constant", "[schemes]") {
    Frame low = random_frame({31, 14}, FrameContent::awkward);
    low.radiance = Image(low.size(), {0.1f, 0.7f, 13.3f});
    const Image constant({71, 43}, {0.1f, 0.7f, 13.3f});
    for_each_cell(GENERATE(3, 7, 99),
                  [&](const Scheme& scheme, const SchemeParameters& parameters) {
                      CHECK(same_bits(rebuild(low, scheme, parameters, {71, 43}).image, constant));
                  });
}

TEST_CASE("at its own size and a window of one pixel an image stays as it is", "[schemes]") {
    const Frame low = random_frame({23, 17}, FrameContent::benign);
    for_each_cell(1, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        CHECK(same_bits(rebuild(low, scheme, parameters, low.size()).image, low.radiance));
    });
}

TEST_CASE("a window can be no larger than the image", "[schemes]") {
    const Frame low = random_frame({9, 6}, FrameContent::awkward);
    for_each_cell(17, [&](const Scheme& scheme, SchemeParameters parameters) {
        const Image whole = rebuild(low, scheme, parameters, {20, 20}).image;
        parameters.window = 9999;
        CHECK(same_bits(rebuild(low, scheme, parameters, {20, 20}).image, whole));
    });
}

TEST_CASE("colours scaled by a power of two scale the result exactly", "[schemes]") {
    const float factor = GENERATE(16.0f, 0.125f);
    const Frame low = random_frame({23, 17}, FrameContent::awkward);
    Frame scaled = low;
    scale(scaled.radiance, factor);
    for_each_cell(5, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        Reconstruction expected = rebuild(low, scheme, parameters, {47, 35});
        const Reconstruction result = rebuild(scaled, scheme, parameters, {47, 35});
        scale(expected.image, factor);
        CHECK(same_bits(result.image, expected.image));
        CHECK(same_counts(result, expected));
    });
}

TEST_CASE("world units do not matter", "[schemes]") {
    const Frame low = random_frame({23, 17}, FrameContent::awkward);
    Frame scaled = low;
    scale(scaled.position_world, 1024.0f);
    for_each_cell(5, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        const Reconstruction expected = rebuild(low, scheme, parameters, {47, 35});
        const Reconstruction result = rebuild(scaled, scheme, parameters, {47, 35});
        CHECK(same_bits(result.image, expected.image));
        CHECK(same_counts(result, expected));
    });
}

TEST_CASE("no value leaves the range of its window", "[schemes]") {
    Frame low = random_frame({40, 21}, FrameContent::benign);
    for (glm::vec3& color : low.radiance.values()) color = 1.0e3f * (color - 0.5f);
    const int window = GENERATE(3, 7, 9);
    for_each_cell(window, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        // A polynomial may go on beyond its samples, see test_guided.cpp.
        if (scheme.reads("order") && parameters.order > 0) return;
        const Image values = rebuild(low, scheme, parameters, low.size()).image;
        int outside = 0;
        for (int y = 0; y < low.size().height; ++y) {
            for (int x = 0; x < low.size().width; ++x) {
                outside += !range_around(x, y, low.radiance, window).holds(values(x, y));
            }
        }
        CHECK(outside == 0);
    });
}

TEST_CASE("a non-finite colour is counted once and changes nothing beyond its window",
          "[schemes]") {
    const float bad = GENERATE(values({kNaN, kInfinity, -kInfinity}));
    const Frame low = random_frame({21, 21}, FrameContent::benign);
    Frame broken = low;
    broken.radiance(10, 8).y = bad;
    for_each_cell(5, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        const Image expected = rebuild(low, scheme, parameters, low.size()).image;
        const Reconstruction result = rebuild(broken, scheme, parameters, low.size());
        CHECK(result.dropped_samples == 1);
        CHECK(result.non_finite_pixels == (scheme.name == "nearest" ? 1 : 0));
        CHECK(all_finite(result.image));
        bool changed_beyond = false;
        for (int y = 0; y < 21; ++y) {
            for (int x = 0; x < 21; ++x) {
                const bool beyond = std::abs(x - 10) > 2 || std::abs(y - 8) > 2;
                changed_beyond |= beyond && result.image(x, y) != expected(x, y);
            }
        }
        CHECK_FALSE(changed_beyond);
    });
}

TEST_CASE("the result is finite for every finite input", "[schemes]") {
    const float colors = GENERATE(1.0f, 3.0e38f, -3.0e38f, 1.0e-42f);
    const float positions = GENERATE(1.0f, 3.0e38f, 1.0e-42f);
    Frame low = random_frame({19, 15}, FrameContent::benign);
    scale(low.radiance, colors);
    scale(low.position_world, positions);
    for_each_cell(7, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        const Reconstruction result = rebuild(low, scheme, parameters, {38, 30});
        CHECK(all_finite(result.image));
        CHECK(result.non_finite_pixels == 0);
        CHECK(result.fallback_pixels == 0);
    });
}

TEST_CASE("the result is finite for the most broken input", "[schemes]") {
    const Frame low = random_frame({40, 33}, FrameContent::hostile, GENERATE(11u, 12u, 13u));
    for_each_cell(GENERATE(1, 3, 7), [&](const Scheme& scheme, const SchemeParameters& parameters) {
        CHECK(all_finite(rebuild(low, scheme, parameters, {99, 66}).image));
    });
}

TEST_CASE("the number of threads does not change a bit", "[schemes]") {
    const Frame low = random_frame({50, 61}, FrameContent::awkward);
    for_each_cell(5, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        const auto with = [&](int threads) {
            return rebuild(low, scheme, parameters, {128, 140}, threads);
        };
        const Reconstruction one = with(1);
        for (const int threads : {2, 7}) {
            const Reconstruction many = with(threads);
            CHECK(same_bits(many.image, one.image));
            CHECK(same_counts(many, one));
        }
    });
}

TEST_CASE("a mirrored or transposed frame gives the mirrored or transposed image", "[schemes]") {
    // A third of 72: no full-res pixel has its centre on a border of low-res pixels.
    const Frame low = random_frame({24, 24}, FrameContent::awkward);
    for_each_cell(5, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        const auto commutes = [&](auto from_low, auto from_full) {
            const Frame moved = rearranged(low, from_low);
            const Reconstruction result = rebuild(moved, scheme, parameters, {72, 72});
            const Reconstruction expected = rebuild(low, scheme, parameters, {72, 72});
            // Neighbours are added up in another order.
            CHECK(relative_difference(result.image, rearranged(expected.image, from_full)) <= 1e-6);
            CHECK(same_counts(result, expected));
        };
        const auto mirrored = [](int side) {
            return [side](int x, int y) { return std::pair(side - 1 - x, y); };
        };
        const auto transposed = [](int x, int y) { return std::pair(y, x); };
        commutes(mirrored(24), mirrored(72));
        commutes(transposed, transposed);
    });
}
