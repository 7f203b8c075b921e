// SPDX-License-Identifier: Apache-2.0
//
// Parts of a render, joined in any order and in any tree, are the render bit for bit.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "core/accumulate.h"
#include "core/channel_file.h"
#include "core/frame_planes.h"
#include "core/part_file.h"
#include "tests/catch.h"
#include "tests/scene_text.h"
#include "tests/temp_dir.h"

using namespace vecino;
using namespace vecino::test;

namespace {

/// NaN is a bit pattern too.
template <class T>
bool same_bits(const Grid<T>& a, const Grid<T>& b) {
    return a.size() == b.size() &&
           std::equal(reinterpret_cast<const char*>(a.values().data()),
                      reinterpret_cast<const char*>(a.values().data() + a.values().size()),
                      reinterpret_cast<const char*>(b.values().data()));
}

bool same_bits(const Frame& a, const Frame& b) {
    return std::ranges::all_of(all_planes(), [&](const PlaneInfo& info) {
        return std::visit([&](auto member) { return same_bits(a.*member, b.*member); },
                          info.member);
    });
}

std::vector<Part> parts_of(const Scene& scene, const RenderSettings& settings,
                           const std::vector<int>& ends) {
    std::vector<Part> parts;
    int begin = 0;
    RenderSettings others = settings;
    for (const int end : ends) {
        others.threads = 1 + static_cast<int>(parts.size()) % 3 * 3;  // 1, 4, 7
        parts.push_back(render_part(scene, others, {begin, end}).part);
        begin = end;
    }
    return parts;
}

Frame finished(Part&& part) {
    std::uint64_t non_finite = 0;
    const Planes planes = part.planes;
    return finish(std::move(part), planes, non_finite);
}

/// Joins neighbours at random until one part is left.
Part join_at_random(std::vector<Part> parts, std::mt19937& random) {
    while (parts.size() > 1) {
        const std::size_t left = random() % (parts.size() - 1);
        const bool swapped = random() % 2 == 0;
        Part& to = parts[swapped ? left + 1 : left];
        join(to, std::move(parts[swapped ? left : left + 1]));
        parts.erase(parts.begin() + static_cast<std::ptrdiff_t>(swapped ? left : left + 1));
    }
    return std::move(parts.front());
}

/// A box in which one lamp is 1e32 times as bright as the other, and both are small.
Scene firefly_scene() {
    return scene_from(R"({
      "camera": {"position": [0, 0, 3], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 40},
      "materials": {"wall": {"albedo": [0.7, 0.5, 0.3]}, "sun": {"emission": [1e30, 1e30, 3e29]},
                    "glow": {"emission": [0.01, 0.02, 1e-12]}},
      "objects": [
        {"quad": [[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1]], "material": "wall"},
        {"quad": [[-1,-1,-1],[-1,-1,1],[1,-1,1],[1,-1,-1]], "material": "wall"},
        {"sphere": {"center": [0.6, 0.2, 0.3], "radius": 0.05}, "material": "sun"},
        {"sphere": {"center": [-0.4, 0.5, 0], "radius": 0.2}, "material": "glow"}]})");
}

/// The same with light so bright that samples leave the range of float; no scene file may say so.
Scene overflowing_scene() {
    Scene scene = firefly_scene();
    for (Material& material : scene.materials) {
        if (material.name == "sun") material.emission = {3e38f, 2e38f, 1.0f};
    }
    return scene;
}

}  // namespace

TEST_CASE("parts joined in any order are the render bit for bit", "[merge]") {
    const Scene scene = repository_scene("cornell_sphere");
    RenderSettings settings = small_settings({11, 7}, 300);  // 300 ends within a block
    settings.sampler = GENERATE(Sampler::independent, Sampler::sobol);
    settings.light_sampling = GENERATE(LightSampling::none, LightSampling::nee);
    settings.first_hit = GENERATE(FirstHit::first_sample, FirstHit::centre);
    const bool all = GENERATE(true, false);
    settings.planes = all ? Planes::all() : Planes{Plane::radiance, Plane::direct, Plane::normal};
    settings.threads = 2;
    const Frame whole = render(scene, settings).frame;
    std::mt19937 random(5);
    for (int i = 0; i < 3; ++i) {
        std::vector<Part> parts = parts_of(scene, settings, {64, 128, 256, 300});
        CHECK(same_bits(finished(join_at_random(std::move(parts), random)), whole));
    }
    CHECK(same_bits(finished(render_part(scene, settings, {0, 300}).part), whole));
}

TEST_CASE("parts of fireflies and of samples that are not finite join bit for bit", "[merge]") {
    const bool overflows = GENERATE(false, true);
    const Scene scene = overflows ? overflowing_scene() : firefly_scene();
    RenderSettings settings = small_settings({9, 8}, 256);
    settings.sampler = GENERATE(Sampler::independent, Sampler::sobol);
    settings.light_sampling = LightSampling::nee;
    settings.max_depth = 3;
    const Render whole = render(scene, settings);
    CHECK((whole.statistics.dropped_samples > 0) == overflows);
    std::uint64_t dropped = 0;
    std::uint64_t rays = 0;
    for (const int begin : {0, 64, 192}) {
        const int end = begin == 0 ? 64 : begin == 64 ? 192 : 256;
        const RenderStatistics s = render_part(scene, settings, {begin, end}).statistics;
        dropped += s.dropped_samples;
        rays += s.rays;
    }
    CHECK(dropped == whole.statistics.dropped_samples);
    CHECK(rays == whole.statistics.rays);
    std::mt19937 random(6);
    Part part = join_at_random(parts_of(scene, settings, {64, 192, 256}), random);
    std::uint64_t non_finite = 0;
    const Frame joined = finish(std::move(part), Planes::all(), non_finite);
    CHECK(same_bits(joined, whole.frame));
    CHECK(non_finite == whole.statistics.non_finite_pixels);
}

TEST_CASE("a part is the same file, however it was made", "[merge]") {
    const TempDir dir;
    const Scene scene = repository_scene("cornell_sphere");
    RenderSettings settings = small_settings({12, 5}, 320);
    settings.sampler = GENERATE(Sampler::independent, Sampler::sobol);
    const Metadata metadata = {
        {"spp", 320}, {"sampler", settings.sampler == Sampler::sobol ? "sobol" : "independent"}};
    const auto save = [&](const Part& part, const char* name) {
        save_part(part, dir.path(name), metadata);
        return dir.read(name);
    };
    const std::string direct = save(render_part(scene, settings, {64, 256}).part, "direct.exr");
    save(render_part(scene, settings, {64, 128}).part, "a.exr");
    save(render_part(scene, settings, {128, 256}).part, "b.exr");
    Part joined = load_part(load_part_header(dir.path("b.exr")));
    join(joined, load_part(load_part_header(dir.path("a.exr"))));
    CHECK(save(joined, "joined.exr") == direct);
}

TEST_CASE("only the part with sample 0 has first hits", "[merge]") {
    const Scene scene = repository_scene("cornell");
    RenderSettings settings = small_settings({4, 4}, 128);
    settings.first_hit = GENERATE(FirstHit::first_sample, FirstHit::centre);
    const PartRender second = render_part(scene, settings, {64, 128});
    CHECK(planes_of(second.part.first_hits) == Planes{});
    CHECK(planes_of(render_part(scene, settings, {0, 64}).part.first_hits) == kFirstHitPlanes);
}

TEST_CASE("sums take memory for the digits that a scene has", "[merge]") {
    const Part part =
        render_part(repository_scene("cornell"), small_settings({8, 8}, 64), {0, 64}).part;
    std::size_t planes = 0;
    for (std::size_t sum = 0; sum < part.sums.sums_per_pixel(); ++sum) {
        for (std::size_t digit = 0; digit < ExactSum::kDigits; ++digit) {
            planes += part.sums.plane(sum, digit).empty() ? 0 : 1;
        }
    }
    CHECK(planes <= 4 * part.sums.sums_per_pixel());
}

TEST_CASE("samples and rays grow in proportion to pixels and spp", "[render]") {
    const Scene scene = scene_from(closed_cube(R"({"albedo": [0.5, 0.5, 0.5]})"));
    const auto traced = [&](Extent size, int spp) {
        RenderSettings settings = small_settings(size, spp);
        settings.light_sampling = LightSampling::none;
        return render(scene, settings).statistics;
    };
    const RenderStatistics one = traced({8, 8}, 64);
    CHECK(one.samples == 64 * 64);
    CHECK(one.rays == 3 * one.samples);  // a closed cube loses no path before depth 2
    for (const int factor : {2, 5, 16}) {
        const auto times = static_cast<std::uint64_t>(factor);
        CHECK(traced({8, 8 * factor}, 64).samples == times * one.samples);
        CHECK(traced({8, 8 * factor}, 64).rays == times * one.rays);
        CHECK(traced({8, 8}, 64 * factor).samples == times * one.samples);
        CHECK(traced({8, 8}, 64 * factor).rays == times * one.rays);
    }
}

TEST_CASE("a furnace of four million samples is as exact as one of 64", "[render][slow]") {
    const Scene scene =
        scene_from(closed_cube(R"({"albedo": [0.5, 0.25, 0.75], "emission": [2, 2, 2]})"));
    RenderSettings settings = small_settings({1, 1}, 4000000);
    settings.light_sampling = LightSampling::none;
    settings.sampler = Sampler::independent;
    settings.planes = {Plane::radiance, Plane::count};
    const Frame frame = render(scene, settings).frame;
    CHECK(frame.radiance(0, 0).x == Approx(3.5).epsilon(3e-7));
    CHECK(frame.radiance(0, 0).y == Approx(2.625).epsilon(3e-7));
    CHECK(frame.radiance(0, 0).z == Approx(4.625).epsilon(3e-7));
    CHECK(frame.sample_count(0, 0) == 4e6f);
}

namespace {

/// The mean of what an accumulator got, for blocks of equal samples.
double mean_of_blocks(double bright, int blocks) {
    PixelAccumulator pixel(VarianceOf::nothing);
    for (int b = 0; b < blocks; ++b) {
        SampleBlock block{};
        for (float& value : block.direct[0]) value = b == 0 ? static_cast<float>(bright) : 1e-3f;
        pixel.add(block, kBlockSamples);
    }
    std::vector<ExactSum::Digits> sums(sum_count(VarianceOf::nothing));
    pixel.sums(sums);
    return static_cast<double>(pixel_values(sums, VarianceOf::nothing).direct.x);
}

}  // namespace

TEST_CASE("tiny samples after a bright one are not lost", "[merge]") {
    // A float sum of 2^26 would not grow by 0.064 even once.
    const int blocks = 62500;
    const double samples = 64.0 * blocks;
    const double expected = (64 * 0x1p20 + static_cast<double>(1e-3f) * (samples - 64)) / samples;
    CHECK(mean_of_blocks(0x1p20, blocks) == Approx(expected).epsilon(1e-7));
    CHECK(mean_of_blocks(0, blocks) ==
          Approx(static_cast<double>(1e-3f) * (samples - 64) / samples).epsilon(1e-7));
}
