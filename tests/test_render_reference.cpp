// SPDX-License-Identifier: Apache-2.0
//
// Renders against images of an independent renderer (tests/data/README.md).
#include <algorithm>
#include <cmath>

#include "core/image_io.h"
#include "tests/catch.h"
#include "tests/scene_text.h"

using namespace vecino;
using namespace vecino::test;

namespace {

struct Case {
    const char* scene;
    int depth;
};

Image reference_of(const Case& c) {
    return load_image(std::string(VECINO_SOURCE_DIR) + "/tests/data/" + c.scene + "_depth" +
                      std::to_string(c.depth) + "_128.exr");
}

/// Means over 8x8 blocks.
Image block_means(const Image& image) {
    Image blocks({image.size().width / 8, image.size().height / 8});
    for (int y = 0; y < image.size().height; ++y) {
        for (int x = 0; x < image.size().width; ++x) blocks(x / 8, y / 8) += image(x, y) / 64.0f;
    }
    return blocks;
}

void check_mean_within(const Image& test, const Image& reference, double share) {
    const glm::dvec3 a = mean_of(test);
    const glm::dvec3 b = mean_of(reference);
    for (int c = 0; c < 3; ++c) CHECK(a[c] == Approx(b[c]).epsilon(share));
}

/// Share of block channel values that are within 2 %, dark ones measured against 0.01.
double share_of_close_blocks(const Image& test, const Image& reference) {
    const Image a = block_means(test);
    const Image b = block_means(reference);
    int close = 0;
    for (std::size_t i = 0; i < a.values().size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const float expected = b.values()[i][c];
            close +=
                std::abs(a.values()[i][c] - expected) < 0.02f * std::max(expected, 0.01f) ? 1 : 0;
        }
    }
    return close / (3.0 * static_cast<double>(a.values().size()));
}

}  // namespace

TEST_CASE("next-event estimation agrees with an independent renderer", "[render][slow]") {
    const Case c =
        GENERATE(Case{"cornell", 1}, Case{"cornell", 2}, Case{"cornell_sphere", 1},
                 Case{"cornell_sphere", 2}, Case{"hard_shadows", 2}, Case{"checker_spheres", 2});
    const Sampler sampler = GENERATE(Sampler::independent, Sampler::sobol);
    CAPTURE(c.scene, c.depth, static_cast<int>(sampler));
    RenderSettings settings = small_settings({128, 128}, 1024);
    settings.max_depth = c.depth;
    settings.sampler = sampler;
    settings.planes = {Plane::radiance};
    const Image image = render(repository_scene(c.scene), settings).frame.radiance;
    const Image reference = reference_of(c);
    check_mean_within(image, reference, 0.003);
    CHECK(share_of_close_blocks(image, reference) >= 0.99);
}

// One pixel of a 16x16 image is the mean over an 8x8 block of a 128x128 one. Light found by chance
// is noisy, so each block is held against its own standard error.
TEST_CASE("light found by chance has the same expectation as an independent renderer's",
          "[render][slow]") {
    const Case c = GENERATE(Case{"cornell", 1}, Case{"cornell", 2}, Case{"cornell_sphere", 1},
                            Case{"cornell_sphere", 2});
    const Sampler sampler = GENERATE(Sampler::independent, Sampler::sobol);
    CAPTURE(c.scene, c.depth, static_cast<int>(sampler));
    RenderSettings settings = small_settings({16, 16}, 1 << 17);
    settings.max_depth = c.depth;
    settings.light_sampling = LightSampling::none;
    settings.sampler = sampler;
    settings.planes = {Plane::radiance, Plane::variance};
    const Frame frame = render(repository_scene(c.scene), settings).frame;
    const Image expected = block_means(reference_of(c));
    check_mean_within(frame.radiance, expected, 0.01);
    // Independent samples: about 1 of 15,000 normal values is beyond 4 sigma. Sobol's variance
    // comes from 4 streams (3 degrees of freedom), whose tails are heavier.
    const double limit = sampler == Sampler::independent ? 4.5 : 12.0;
    double sum_of_squares = 0;
    int counted = 0;
    for (std::size_t i = 0; i < expected.values().size(); ++i) {
        for (int k = 0; k < 3; ++k) {
            const double value = static_cast<double>(expected.values()[i][k]);
            const double error = static_cast<double>(frame.radiance.values()[i][k]) - value;
            const double sigma =
                std::sqrt(static_cast<double>(frame.variance.values()[i][k])) + 2e-4 * value + 1e-7;
            CHECK(std::abs(error) < limit * sigma);
            sum_of_squares += std::min(error * error / (sigma * sigma), 9.0);
            ++counted;
        }
    }
    CHECK(sum_of_squares / counted < 1.7);
}
