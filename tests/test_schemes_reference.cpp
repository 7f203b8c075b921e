// SPDX-License-Identifier: Apache-2.0
//
// The schemes against an independent implementation of the thesis's algorithms, pixel by pixel of
// the large image.
#include <algorithm>

#include "tests/catch.h"
#include "tests/reference_schemes.h"
#include "tests/scheme_frames.h"

using namespace vecino;

namespace {

struct Sizes {
    Extent low, full;
};

// Sums over the same neighbours in the same order differ only by roundings in double (and, for
// gaussian, by an exponential good to 1e-11): at most the last bit of the float, 6e-8.
constexpr double kTolerance = 1.0e-6;

void check_against_reference(const Frame& low, const Scheme& scheme,
                             const SchemeParameters& parameters, Extent size) {
    INFO(cell_name(scheme, parameters) << " to " << size.width << "x" << size.height);
    const Reconstruction ours = rebuild(low, scheme, parameters, size);
    const reference::Result theirs = reference::reconstruct(low, scheme.name, parameters, size);
    CHECK(relative_difference(ours.image, theirs.image) <= kTolerance);
    CHECK(ours.fallback_pixels == theirs.fallbacks.size());
    CHECK(ours.non_finite_pixels == theirs.non_finite.size());
    const auto dropped = std::ranges::count_if(
        low.radiance.values(), [](const glm::vec3& c) { return !reference::finite(c); });
    CHECK(ours.dropped_samples == static_cast<std::size_t>(dropped));
}

void check_all(const Frame& low, int window, Extent size) {
    for (const Scheme& scheme : all_schemes()) {
        if (scheme.uses_guide()) continue;  // not the thesis's
        for (const SchemeParameters& parameters : parameters_of(scheme, window)) {
            check_against_reference(low, scheme, parameters, size);
        }
    }
}

}  // namespace

TEST_CASE("every scheme agrees with the thesis's algorithms at any size", "[schemes]") {
    const Sizes sizes = GENERATE(values<Sizes>({{{8, 8}, {16, 16}},
                                                {{5, 4}, {17, 13}},
                                                {{21, 21}, {64, 64}},
                                                {{64, 22}, {257, 89}},
                                                {{1, 1}, {1, 1}},
                                                {{1, 1}, {3, 2}},
                                                {{1, 9}, {1, 19}},
                                                {{9, 1}, {9, 1}},
                                                {{13, 2}, {29, 7}}}));
    check_all(random_frame(sizes.low, FrameContent::awkward), 3, sizes.full);
}

TEST_CASE("every scheme agrees with the thesis's algorithms at any window", "[schemes]") {
    const int window = GENERATE(1, 3, 5, 7, 9, 15, 31);
    check_all(random_frame({14, 11}, FrameContent::awkward, 2), window, {14, 11});
}

TEST_CASE("every scheme agrees with the thesis's algorithms on broken geometry", "[schemes]") {
    const unsigned seed = GENERATE(3u, 4u, 5u);
    check_all(random_frame({24, 19}, FrameContent::hostile, seed), 5, {24, 19});
}

TEST_CASE("the normal gate agrees with the thesis's at any cosine", "[schemes]") {
    const float cosine = GENERATE(-1.0f, -0.5f, 0.0f, 0.9f, 0.99f, 1.0f);
    const Frame low = random_frame({19, 17}, FrameContent::awkward, 6);
    for (const Scheme& scheme : all_schemes()) {
        if (scheme.uses_guide()) continue;  // not the thesis's
        if (!scheme.reads("min_normal_cosine")) continue;
        for (SchemeParameters parameters : parameters_of(scheme, 7)) {
            parameters.min_normal_cosine = cosine;
            check_against_reference(low, scheme, parameters, low.size());
        }
    }
}

TEST_CASE("values made once per low-res pixel equal those made per pixel, bit for bit",
          "[schemes]") {
    // At powers of two uv differences are exact, so both forms do the same arithmetic; except for
    // the exponential.
    const Frame low = random_frame({32, 16}, FrameContent::awkward, 7);
    const Extent size{75, 41};
    for (const Scheme& scheme : all_schemes()) {
        if (scheme.uses_guide()) continue;  // not the thesis's
        for (const SchemeParameters& parameters : parameters_of(scheme, 7)) {
            if (parameters.weighting == Weighting::gaussian) continue;
            INFO(cell_name(scheme, parameters));
            const Reconstruction ours = rebuild(low, scheme, parameters, size);
            const auto theirs = reference::reconstruct(low, scheme.name, parameters, size);
            CHECK(same_bits(ours.image, theirs.image));
        }
    }
}

TEST_CASE("every full-res pixel holds the very value of its corresponding low-res pixel",
          "[schemes]") {
    const Frame low = random_frame({21, 10}, FrameContent::awkward, 8);
    const Extent size{64, 31};
    for (const Scheme& scheme : all_schemes()) {
        if (scheme.uses_guide()) continue;  // not the thesis's
        for (const SchemeParameters& parameters : parameters_of(scheme, 5)) {
            INFO(cell_name(scheme, parameters));
            const Image values = scheme.run(low, parameters, 1).image;
            Image expected(size);
            for (int y = 0; y < size.height; ++y) {
                for (int x = 0; x < size.width; ++x) {
                    expected(x, y) = values(reference::low_pixel_at(x, size.width, 21),
                                            reference::low_pixel_at(y, size.height, 10));
                }
            }
            CHECK(same_bits(rebuild(low, scheme, parameters, size).image, expected));
        }
    }
}
