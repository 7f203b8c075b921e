// SPDX-License-Identifier: Apache-2.0
//
// Sampling until samples vary little: the readings of the thesis's rule, and the sound one.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "filters/variation_rules.h"
#include "tests/method_frames.h"

using namespace vecino;
using namespace vecino::test;

namespace {

std::vector<glm::vec3> uniform_samples(std::size_t count) {
    std::vector<glm::vec3> samples;
    std::uint32_t state = 7;
    for (std::size_t i = 0; i < count; ++i) {
        state = state * 1664525u + 1013904223u;
        samples.emplace_back(static_cast<float>(state >> 8) * 0x1p-24f);
    }
    return samples;
}

MethodRequest variation_request(const Scene& scene, VariationRule rule, float bound) {
    MethodRequest request = request_of(scene, {32, 32}, 256);
    request.parameters.variation_rule = rule;
    request.parameters.variation_bound = bound;
    return request;
}

}  // namespace

TEST_CASE("the statistics of a few samples, by hand", "[methods]") {
    const std::vector<glm::vec3> samples{{1, 0, 0}, {3, 0, 0}, {8, 0, 0}};
    // Pairs differ by 2, 7 and 5; green and blue by nothing.
    CHECK(sample_difference(samples) == Approx(14.0 / 3 / 3));
    // The mean goes from 2 to 4.
    CHECK(mean_change(samples) == Approx(2.0 / 3));
    // Squared deviations from 4: 9 + 1 + 16.
    CHECK(standard_error(samples) == Approx(std::sqrt(26.0 / 2 / 3) / 3));
    for (const auto statistic : {sample_difference, mean_change, standard_error})
        CHECK(statistic(std::span(samples).first(1)) == 0);
}

TEST_CASE("the mean difference of samples does not fall with their number", "[methods]") {
    const std::vector<glm::vec3> samples = uniform_samples(65536);
    const auto at = [&](auto statistic, std::size_t n) {
        return statistic(std::span(samples).first(n));
    };
    // Of uniform numbers, pairs differ by 1/3.
    CHECK(at(sample_difference, 256) == Approx(1.0 / 3).epsilon(0.1));
    CHECK(at(sample_difference, 65536) == Approx(1.0 / 3).epsilon(0.01));
    CHECK(at(standard_error, 256) / at(standard_error, 65536) == Approx(16).epsilon(0.1));
    CHECK(at(mean_change, 65536) < 1.0 / 65536);
}

TEST_CASE("sampling in proportion to need gains nothing where all need the same", "[methods]") {
    CHECK(neyman_gain(std::vector<double>{4, 4, 4}) == Approx(1));
    CHECK(neyman_gain(std::vector<double>{0, 0}) == 1);
    CHECK(neyman_gain(std::vector<double>{1, 9}) == Approx(5.0 / 4));
}

TEST_CASE("by the mean difference a pixel stops at once or never", "[methods]") {
    const Scene scene = repository_scene("cornell_sphere");
    const MethodRender result =
        render_by("variation", variation_request(scene, VariationRule::sample_difference, 0.02f));
    const auto& counts = result.render.frame.sample_count.values();
    const auto at_once = std::ranges::count(counts, 16.0f);
    const auto never = std::ranges::count(counts, 256.0f);
    CHECK(at_once > 32);
    CHECK(never > 32);
    // In between are pixels that vary just so much as the bound allows.
    CHECK(at_once + never > 32 * 32 * 9 / 10);
}

TEST_CASE("by the change of the mean pixels stop earlier than by its error", "[methods]") {
    const Scene scene = repository_scene("cornell_sphere");
    const auto mean_spp = [&](VariationRule rule) {
        return render_by("variation", variation_request(scene, rule, 0.004f))
            .facts["mean_spp"]
            .get<double>();
    };
    CHECK(mean_spp(VariationRule::mean_change) < 0.5 * mean_spp(VariationRule::standard_error));
}

TEST_CASE("independent scramblings keep their bound", "[methods]") {
    const Scene scene = repository_scene("cornell_sphere");
    MethodRequest request = variation_request(scene, VariationRule::scramblings, 0.05f);
    request.settings.spp = 1024;
    const MethodRender result = render_by("variation", request);
    CHECK(result.facts["mean_spp"] < 600);
    CHECK(result.facts["neyman_gain"] > 1);
    MethodRequest truth = request;
    truth.settings.spp = 16384;
    truth.settings.seed = 99;
    const Image reference = render(scene, truth.settings).frame.radiance;
    // 95 % of the pixels that stopped are within the bound in all channels, or nearly so many:
    // the interval is pooled over pixels of which some vary more than others.
    std::size_t stopped = 0, within = 0;
    for (std::size_t i = 0; i < reference.values().size(); ++i) {
        if (result.render.frame.sample_count.values()[i] == 1024) continue;
        ++stopped;
        bool all = true;
        for (int c = 0; c < 3; ++c) {
            const float value = result.render.frame.radiance.values()[i][c];
            const float error = std::abs(value - reference.values()[i][c]);
            all = all && error <= 0.05f * std::sqrt(std::max(value, 1e-3f));
        }
        within += all ? 1 : 0;
    }
    CHECK(stopped > 400);
    CHECK(static_cast<double>(within) > 0.9 * static_cast<double>(stopped));
}

TEST_CASE("a bound of nothing makes variation path tracing, bit for bit", "[methods]") {
    const Scene scene = repository_scene("cornell_sphere");
    for (const auto rule : {VariationRule::scramblings, VariationRule::sample_difference}) {
        MethodRequest request = variation_request(scene, rule, 0);
        request.parameters.min_spp = 64;  // blocks of samples as in one go
        request.settings.size = {9, 7};
        const Frame frame = render_by("variation", request).render.frame;
        const Frame path = render(scene, request.settings).frame;  // with its variance
        // What no light reaches varies by nothing, and may stop.
        for (std::size_t i = 0; i < path.radiance.values().size(); ++i) {
            if (frame.sample_count.values()[i] != 256) continue;
            CHECK(frame.radiance.values()[i] == path.radiance.values()[i]);
            CHECK(frame.variance.values()[i] == path.variance.values()[i]);
        }
        CHECK(std::ranges::count(frame.sample_count.values(), 256.0f) > 50);
    }
}

TEST_CASE("where light is found by chance, few samples decide nothing", "[methods]") {
    const Scene scene = repository_scene("cornell");
    MethodRequest request = variation_request(scene, VariationRule::standard_error, 1e6f);
    request.settings.spp = 1024;
    request.settings.size = {8, 8};
    CHECK(render_by("variation", request).facts["mean_spp"] == 16.0);
    request.settings.light_sampling = LightSampling::none;
    CHECK(render_by("variation", request).facts["mean_spp"] == 512.0);
    request.parameters.min_spp = 30;  // a multiple of 4 is made of it
    CHECK(render_by("variation", request).facts["mean_spp"] == 32.0);
}
