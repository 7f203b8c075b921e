// SPDX-License-Identifier: Apache-2.0
//
// The method surface_records where few samples, or few records, mislead.
#include <algorithm>

#include "tests/record_renders.h"
#include "tests/scene_text.h"

using namespace vecino;
using namespace vecino::test;

TEST_CASE("a wide half-shadow is found by one sample a pixel", "[surface_records]") {
    const Scene scene = repository_scene("failures/f16_soft_shadow");
    RenderSettings settings = small_settings({128, 128}, 1);
    settings.max_depth = 1;
    const Render made = records(scene, settings, {1, 128, 16, 0, 64, 64, 1.0, 0.15});
    CHECK(db(made.frame.radiance, paths(scene, settings, 1024)) > 42);
}

TEST_CASE("records right beside something else do not darken all that is around them",
          "[surface_records]") {
    // A bar a tenth of a pixel above a wall: four pixels off, its shadow is gone.
    const Scene scene = repository_scene("failures/f09_thin_bar");
    RenderSettings settings = small_settings({192, 192}, 1);
    settings.max_depth = GENERATE(1, 3);
    const Render made = records(scene, settings, {4, 64, 4, 0, 256, 128, 1.0, 0.15});
    double darkest = 0, sum = 0;
    for (int y = 10; y < 182; ++y) {
        const double missing = 1 - static_cast<double>(made.frame.radiance(100, y).x) / 0.2;
        darkest = std::max(darkest, missing);
        sum += missing / 172;
    }
    CHECK(darkest < 0.04);
    CHECK(sum < 0.012);
}
