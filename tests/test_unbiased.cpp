// SPDX-License-Identifier: Apache-2.0
//
// Renders of the same expectation pass as often as stated; biased ones fail, each at the level that
// is made for it. How often, from many renders: vecino_tests "[rates]".
#include <algorithm>
#include <cstdio>
#include <random>

#include "core/render.h"
#include "core/scene.h"
#include "eval/unbiased.h"
#include "eval/unbiased_compare.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/temp_dir.h"

#include "core/image_io.h"

using namespace vecino;

namespace {

Frame rendered(std::uint32_t seed, int spp = 256) {
    static const Scene scene = load_scene(VECINO_SOURCE_DIR "/scenes/cornell_sphere.json");
    RenderSettings settings;
    settings.size = {32, 32};
    settings.spp = spp;
    settings.seed = seed;
    settings.sampler = Sampler::independent;
    settings.planes = {Plane::radiance, Plane::variance, Plane::count};
    return render(scene, settings).frame;
}

std::vector<UnbiasedRule> test(const Frame& a, const Frame& b) {
    return test_unbiased({a.radiance, a.variance, a.sample_count},
                         {b.radiance, b.variance, b.sample_count});
}

bool holds(const std::vector<UnbiasedRule>& rules) {
    return std::ranges::all_of(rules, &UnbiasedRule::holds);
}

Frame blank(Extent size) {
    Frame frame;
    frame.radiance = frame.variance = Image(size);
    frame.sample_count = Grid<float>(size);
    return frame;
}

/// Normal noise of known variance around a gradient.
Frame drawn(std::mt19937& generator, Extent size) {
    std::normal_distribution<float> normal;
    Frame frame = blank(size);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            const float deviation = 0.01f + 0.001f * static_cast<float>(x);
            for (int c = 0; c < 3; ++c)
                frame.radiance(x, y)[c] = 0.5f + deviation * normal(generator);
            frame.variance(x, y) = glm::vec3(deviation * deviation);
            frame.sample_count(x, y) = 1e6f;
        }
    }
    return frame;
}

}  // namespace

TEST_CASE("normal noise fails as often as the level says", "[unbiased]") {
    std::mt19937 generator(3);
    constexpr int kTrials = 400;
    int failed = 0;
    for (int i = 0; i < kTrials; ++i) {
        const Frame a = drawn(generator, {20, 18});
        const Frame b = drawn(generator, {20, 18});
        failed += holds(test_unbiased({a.radiance, a.variance, a.sample_count},
                                      {b.radiance, b.variance, b.sample_count}, 0.2))
                      ? 0
                      : 1;
    }
    // 20 % of 400, and four standard errors to each side.
    CHECK(failed > 48);
    CHECK(failed < 112);
}

TEST_CASE("renders with other seeds pass", "[unbiased]") {
    const auto rules = test(rendered(1), rendered(2));
    for (const UnbiasedRule& rule : rules) {
        CAPTURE(rule.name, rule.least_p, rule.limit_p);
        CHECK(rule.holds());
    }
    REQUIRE(rules.size() == 3);
    CHECK(rules[0].tests == 3 * 32 * 32);
    CHECK(rules[1].tests == 3 * 4);
    CHECK(rules[2].tests == 3);
}

TEST_CASE("a global bias of 1 % is seen by the mean of all, not by pixels", "[unbiased]") {
    std::mt19937 generator(5);
    const Frame a = drawn(generator, {64, 48});
    Frame b = drawn(generator, {64, 48});
    for (glm::vec3& value : b.radiance.values()) value *= 1.01f;
    const auto rules = test(a, b);
    CHECK(rules[0].holds());
    CHECK_FALSE(rules[2].holds());
    CHECK(rules[2].difference == Approx(-0.005).margin(0.004));
}

TEST_CASE("a render with 1 % more light fails", "[unbiased]") {
    const Frame a = rendered(1, 1024);
    Frame b = rendered(2, 1024);
    for (glm::vec3& value : b.radiance.values()) value *= 1.01f;
    CHECK_FALSE(holds(test(a, b)));
}

TEST_CASE("one wrong pixel is seen and named", "[unbiased]") {
    const Frame a = rendered(1);
    Frame b = rendered(2);
    b.radiance(20, 11).g += 0.5f;
    const auto rules = test(a, b);
    CHECK_FALSE(rules[0].holds());
    CHECK(rules[0].where == glm::ivec2(20, 11));
    CHECK(rules[0].channel == 1);
    CHECK(rules[0].difference == Approx(-0.5).margin(0.1));
}

TEST_CASE("pixels without noise may differ by rounding alone", "[unbiased]") {
    const Extent size{3, 2};
    Frame a = blank(size);
    for (int x = 0; x < 3; ++x) a.radiance(x, 0) = a.radiance(x, 1) = glm::vec3(15.0f);
    for (float& count : a.sample_count.values()) count = 64;
    Frame b = a;
    b.radiance(1, 1).r = 15.000001f;
    CHECK(holds(test(a, b)));
    b.radiance(1, 1).r = 15.01f;
    CHECK_FALSE(holds(test(a, b)));
}

TEST_CASE("files are tested with what they know of their noise", "[unbiased]") {
    const TempDir dir;
    save_frame(rendered(1), dir.path("a.exr"));
    save_frame(rendered(2), dir.path("b.exr"));
    CHECK(holds(compare_unbiased(dir.path("a.exr"), dir.path("b.exr"))));
    const auto json = unbiased_json(compare_unbiased(dir.path("a.exr"), dir.path("b.exr")));
    CHECK(json["holds"] == true);
    CHECK(json["rules"][1]["rule"] == "block");

    // Four scramblings say less of the noise than 256 samples.
    save_frame(rendered(2), dir.path("sobol.exr"), {{"sampler", std::string("sobol")}});
    Frame biased = rendered(1);
    biased.radiance(5, 5).r += 0.3f;
    save_frame(biased, dir.path("biased.exr"));
    const auto least_p = [&](const char* file) {
        return compare_unbiased(dir.path("biased.exr"), dir.path(file)).front().least_p;
    };
    CHECK(least_p("sobol.exr") > 10 * least_p("b.exr"));

    Frame bare = rendered(3);
    bare.variance = {};
    save_frame(bare, dir.path("bare.exr"));
    const Error error =
        error_of([&] { compare_unbiased(dir.path("a.exr"), dir.path("bare.exr")); });
    CHECK(error.code() == ExitCode::mismatch);
    CHECK(std::string(error.what()).find("bare.exr: found no plane variance") != std::string::npos);
}

TEST_CASE("rates of the test for unbiased renders", "[.][benchmark][rates]") {
    constexpr int kPairs = 300;
    for (const int spp : {16, 64, 256, 1024}) {
        int failed = 0, scaled = 0, wrong = 0;
        for (std::uint32_t i = 0; i < kPairs; ++i) {
            const Frame a = rendered(2 * i + 1, spp);
            Frame b = rendered(2 * i + 2, spp);
            failed += holds(test(a, b)) ? 0 : 1;
            Frame pixel = b;
            pixel.radiance(20, 11).g += 0.5f;
            wrong += holds(test(a, pixel)) ? 0 : 1;
            for (glm::vec3& value : b.radiance.values()) value *= 1.01f;
            scaled += holds(test(a, b)) ? 0 : 1;
        }
        std::printf(
            "unbiased, %4d spp, %d pairs: %.1f %% of true pairs fail (stated: 1 %%), %.1f %% "
            "of those with 1 %% more light, %.1f %% with a wrong pixel\n",
            spp, kPairs, 100.0 * failed / kPairs, 100.0 * scaled / kPairs, 100.0 * wrong / kPairs);
        CHECK(failed * 20 < kPairs);
    }
}
