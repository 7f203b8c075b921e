// SPDX-License-Identifier: Apache-2.0
//
// The method surface_records against plain paths, closed forms and itself.
#include "filters/surface_records.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>

#include "core/error.h"
#include "eval/metrics.h"
#include "filters/methods.h"
#include "filters/surface_records_stages.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/record_renders.h"
#include "tests/scene_text.h"

using namespace vecino;
using namespace vecino::test;

namespace {

/// A box with a lamp, with more or other things in it.
Scene box_with(const std::string& materials, const std::string& objects,
               const std::string& rest = "") {
    return scene_from(
        R"({"camera": {"position": [0, 1, 4.2], "look_at": [0, 1, 0], "up": [0, 1, 0], "vertical_fov_degrees": 34.5},
        "materials": {"white": {"albedo": [0.7, 0.7, 0.7]}, "red": {"albedo": [0.6, 0.1, 0.1]},
                      "lamp": {"emission": [15, 15, 15]})" +
        materials + R"(},
        "objects": [
          {"quad": [[-1,0,1],[1,0,1],[1,0,-1],[-1,0,-1]], "material": "white"},
          {"quad": [[-1,2,-1],[1,2,-1],[1,2,1],[-1,2,1]], "material": "white"},
          {"quad": [[-1,0,-1],[1,0,-1],[1,2,-1],[-1,2,-1]], "material": "white"},
          {"quad": [[-1,0,1],[-1,0,-1],[-1,2,-1],[-1,2,1]], "material": "red"})" +
        objects + "]" + rest + "}");
}

constexpr const char* kLamp =
    R"(, {"quad": [[-0.25,1.999,-0.25],[0.25,1.999,-0.25],[0.25,1.999,0.25],[-0.25,1.999,0.25]], "material": "lamp"})";
constexpr const char* kBall =
    R"(, {"sphere": {"center": [0.3,0.4,0.2], "radius": 0.4}, "material": "white"})";

}  // namespace

TEST_CASE("surface records come close to many paths, on every kind of scene", "[surface_records]") {
    struct Case {
        const char* scene;
        double least_db;
    };
    const Case c =
        GENERATE(Case{"cornell", 46}, Case{"cornell_sphere", 45}, Case{"hard_shadows", 40},
                 Case{"illustration_16", 48}, Case{"corridor", 39}, Case{"near_lamp", 42},
                 Case{"near_lamp_mesh", 40});
    CAPTURE(c.scene);
    const Scene scene = repository_scene(c.scene);
    const RenderSettings settings = small_settings({64, 64}, 1);
    const Image reference = paths(scene, settings, 1024);
    const Render result = records(scene, settings);
    CHECK(db(result.frame.radiance, reference) > c.least_db);
    CHECK(result.statistics.non_finite_pixels == 0);
    CHECK(result.statistics.dropped_samples == 0);
    // As paths of so many samples per pixel would not.
    const auto spp = static_cast<int>(result.statistics.rays / (4 * 64 * 64) + 1);
    CHECK(db(result.frame.radiance, reference) > db(paths(scene, settings, spp), reference));
}

TEST_CASE("all that a box can hold: lamps of every shape, mirrors, a background, more bounces",
          "[surface_records]") {
    struct Case {
        const char* name;
        std::string materials, objects, rest;
        int depth;
        double least_db;
    };
    const std::string mirror = R"(, "mirror": {"albedo": [0.9,0.8,0.7], "mirror": true})";
    const Case c = GENERATE_COPY(
        Case{"ball", "", std::string(kLamp) + kBall, "", 2, 44},
        Case{"deep", "", std::string(kLamp) + kBall, "", 5, 43},
        Case{"direct alone", "", std::string(kLamp) + kBall, "", 1, 44},
        Case{"spheres", "",
             std::string(kBall) +
                 R"(, {"sphere": {"center": [-0.4,1.4,0], "radius": 0.15}, "material": "lamp"},
                      {"sphere": {"center": [0.6,0.1,0.7], "radius": 0.05}, "material": "lamp"})",
             "", 2, 40},
        Case{
            "triangle and slanted quad", R"(, "warm": {"emission": [9,4,1]})",
            std::string(kBall) +
                R"(, {"triangles": {"positions": [[-0.6,1.99,-0.4],[-0.2,1.99,-0.4],[-0.4,1.99,0]], "indices": [[0,1,2]]}, "material": "warm"},
                      {"quad": [[0.3,1.9,-0.2],[0.7,1.9,-0.2],[0.6,1.8,0.2],[0.2,1.8,0.2]], "material": "lamp"})",
            "", 2, 40},
        Case{"mirrors", mirror,
             std::string(kLamp) +
                 R"(, {"sphere": {"center": [0.3,0.4,0.2], "radius": 0.4}, "material": "mirror"},
                      {"quad": [[1,0,-1],[1,0,1],[1,2,1],[1,2,-1]], "material": "mirror"})",
             "", 3, 27},
        Case{"background", "", std::string(kLamp) + kBall, R"(, "background": [0.3, 0.5, 0.8])", 2,
             42},
        Case{"background alone", "", kBall, R"(, "background": [0.3, 0.5, 0.8])", 1, 42});
    CAPTURE(c.name);
    const Scene scene = box_with(c.materials, c.objects, c.rest);
    RenderSettings settings = small_settings({64, 64}, 1);
    settings.max_depth = c.depth;
    const Render result = records(scene, settings);
    const Image reference = paths(scene, settings, 1024);
    CHECK(db(result.frame.radiance, reference) > c.least_db);
    // A mirror's paths are noisy: the mean of one image is up to a percent off.
    glm::dvec3 mean(0);
    constexpr std::uint32_t kSeeds = 4;
    for (std::uint32_t seed = 1; seed <= kSeeds; ++seed) {
        settings.seed = seed;
        mean += mean_of(records(scene, settings).frame.radiance) / double{kSeeds};
    }
    CHECK(glm::length(mean - mean_of(reference)) < 5e-3 * glm::length(mean_of(reference)));
}

TEST_CASE("the error of surface records goes on falling as their plan grows", "[surface_records]") {
    const Scene scene = repository_scene("cornell_sphere");
    const RenderSettings settings = small_settings({64, 64}, 1);
    const Image reference = paths(scene, settings, 8192);
    double last = 0;
    for (const int spp : {2, 8, 32, 256}) {
        const double now =
            db(records(scene, settings, surface_records_plan(spp)).frame.radiance, reference);
        CAPTURE(spp, last);
        CHECK(now > last + 2);
        last = now;
    }
    CHECK(last > 58);
}

TEST_CASE("every ingredient of surface records carries some of its accuracy", "[surface_records]") {
    const Scene scene = repository_scene("cornell_sphere");
    const RenderSettings settings = small_settings({96, 96}, 1);
    const Image reference = paths(scene, settings, 2048);
    const double whole = db(records(scene, settings).frame.radiance, reference);
    const auto without = [&](auto change) {
        SurfaceRecordsPlan plan = kSmallPlan;
        change(plan);
        return db(records(scene, settings, plan).frame.radiance, reference);
    };
    CHECK(whole > without([](SurfaceRecordsPlan& p) { p.edge_spp = 0; }) + 3);
    CHECK(whole > without([](SurfaceRecordsPlan& p) { p.levels = 0; }) + 0.2);
    CHECK(whole >
          without([](SurfaceRecordsPlan& p) { p.record_paths = p.refined_record_paths = 8; }) + 2);
    CHECK(whole > without([](SurfaceRecordsPlan& p) { p.fit_sigma = 10; }) + 0.2);
    CHECK(whole > without([](SurfaceRecordsPlan& p) { p.fit_order = 1; }) + 0.2);
    CHECK(without([](SurfaceRecordsPlan& p) { p.fit_order = 1; }) >
          without([](SurfaceRecordsPlan& p) { p.fit_order = 0; }));
}

TEST_CASE("in a furnace surface records are as bright as the series says", "[surface_records]") {
    const Scene scene =
        scene_from(closed_cube(R"({"albedo": [0.5, 0.25, 0.75], "emission": [1, 2, 3]})"));
    RenderSettings settings = small_settings({24, 16}, 1);
    settings.max_depth = GENERATE(0, 1, 2, 4);
    const Frame frame = records(scene, settings).frame;
    glm::dvec3 expected(0.0), term(1.0, 2.0, 3.0);
    for (int bounce = 0; bounce <= settings.max_depth; ++bounce) {
        expected += term;
        term *= glm::dvec3(0.5, 0.25, 0.75);
    }
    const glm::dvec3 mean = mean_of(frame.radiance);
    for (int c = 0; c < 3; ++c) CHECK(mean[c] == Approx(expected[c]).epsilon(0.01));
    const glm::dvec3 emission = mean_of(frame.emission);
    CHECK(emission.x == Approx(1.0));
    CHECK(emission.z == Approx(3.0));
}

TEST_CASE("under an even sky an open plane is exactly as bright as its albedo says",
          "[surface_records]") {
    const Scene scene = scene_from(
        R"({"camera": {"position": [0, 0, 2], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 60},
            "background": [1, 2, 4], "materials": {"m": {"albedo": [0.5, 0.5, 0.25]}},
            "objects": [{"quad": [[-0.5,-9,0],[9,-9,0],[9,9,0],[-0.5,9,0]], "material": "m"}]})");
    const Frame frame = records(scene, small_settings({33, 17}, 1)).frame;
    CHECK(frame.radiance(30, 8).x == Approx(0.5f));
    CHECK(frame.direct(30, 8).z == Approx(1.0f));
    CHECK(frame.indirect(30, 8).x == Approx(0.0f).margin(1e-6));
    CHECK(frame.emission(0, 8).y == Approx(2.0f));
    CHECK(frame.radiance(0, 8).y == Approx(2.0f));
    CHECK(frame.object_id(0, 8) == kMiss);
}

TEST_CASE("surface records have the same bits for any number of threads", "[surface_records]") {
    const Scene scene = GENERATE(repository_scene("hard_shadows"), repository_scene("corridor"));
    RenderSettings settings = small_settings({61, 47}, 1);
    settings.threads = 1;
    const Frame one = records(scene, settings).frame;
    for (const int threads : {2, 7}) {
        settings.threads = threads;
        const Frame many = records(scene, settings).frame;
        CHECK(many.radiance == one.radiance);
        CHECK(many.indirect == one.indirect);
        CHECK(many.sample_count == one.sample_count);
        CHECK(many.position_world == one.position_world);
    }
}

TEST_CASE("surface records agree across packet widths but for noise", "[surface_records]") {
    const Scene scene = box_with("", std::string(kLamp) + kBall);
    RenderSettings settings = small_settings({48, 48}, 1);
    const Image reference = paths(scene, settings, 1024);
    settings.simd_width = GENERATE(from_range(simd_widths()));
    CAPTURE(settings.simd_width);
    const Render result = records(scene, settings);
    CHECK(result.statistics.simd_width == settings.simd_width);
    CHECK(db(result.frame.radiance, reference) > 41);
}

TEST_CASE("surface records fit frames of any size", "[surface_records]") {
    const Scene scene = repository_scene("cornell_sphere");
    const Extent size =
        GENERATE(Extent{1, 1}, Extent{1, 37}, Extent{53, 1}, Extent{17, 33}, Extent{3, 2});
    const int cell = GENERATE(1, 8, 16, 256);
    CAPTURE(size.width, size.height, cell);
    SurfaceRecordsPlan plan{16, 64, cell, 2, 64, 64, 0.85, 0.15};
    const RenderSettings settings = small_settings(size, 1);
    const Render result = records(scene, settings, plan);
    CHECK(result.frame.size() == size);
    CHECK(result.statistics.non_finite_pixels == 0);
    const glm::dvec3 mean = mean_of(result.frame.radiance);
    const glm::dvec3 expected = mean_of(paths(scene, settings, 1024));
    // A pixel that holds the lamp among much else is as noisy as paths.
    const double tolerance = size.area() < 10 ? 0.4 : 0.15;
    CHECK(glm::length(mean - expected) < tolerance * glm::length(expected));
}

TEST_CASE("bands of rows leave no trace in a frame", "[surface_records]") {
    // Wide and so low that one band is less than the frame.
    const Scene scene = repository_scene("cornell_sphere");
    RenderSettings settings = small_settings({8200, 330}, 1);
    settings.planes = {Plane::radiance};
    const SurfaceRecordsPlan plan{1, 0, 16, 0, 16, 16, 0.85, 0.15};
    const StagedRender banded = render_in_stages(scene, settings, {plan}, {});
    CHECK(banded.counts.bands > 1);
    const Image& image = banded.render.frame.radiance;
    // Within a band and across its border, rows differ alike.
    const auto step = [&](int y) {
        double sum = 0;
        for (int x = 0; x < 8200; ++x)
            sum += static_cast<double>(std::abs(image(x, y).y - image(x, y - 1).y));
        return sum / 8200;
    };
    const int border = banded.counts.band_rows;
    CHECK(step(border) < 1.5 * (step(border - 2) + step(border + 2)) / 2);
}

TEST_CASE("planes of surface records: what is asked for, and sums that agree",
          "[surface_records]") {
    const Scene scene = repository_scene("cornell_sphere");
    RenderSettings settings = small_settings({40, 30}, 1);
    settings.first_hit = GENERATE(FirstHit::first_sample, FirstHit::centre);
    const Frame frame = records(scene, settings).frame;
    CHECK(frame.variance.empty());
    const Frame traced = render(scene,
                                [&] {
                                    RenderSettings plain = settings;
                                    plain.planes = {Plane::radiance, Plane::position, Plane::normal,
                                                    Plane::albedo,   Plane::distance, Plane::id};
                                    return plain;
                                }())
                             .frame;
    // Where two surfaces meet, either may be hit first.
    int others = 0;
    for (std::size_t i = 0; i < frame.object_id.values().size(); ++i) {
        if (frame.object_id.values()[i] != traced.object_id.values()[i]) {
            ++others;
            continue;
        }
        CHECK(frame.position_world.values()[i] == traced.position_world.values()[i]);
        CHECK(frame.normal_world.values()[i] == traced.normal_world.values()[i]);
        CHECK(frame.albedo.values()[i] == traced.albedo.values()[i]);
        CHECK(frame.distance_world.values()[i] == traced.distance_world.values()[i]);
    }
    CHECK(others < 10);
    float least = 1e9f, most = 0;
    for (std::size_t i = 0; i < frame.radiance.values().size(); ++i) {
        const glm::vec3 sum =
            frame.emission.values()[i] + frame.direct.values()[i] + frame.indirect.values()[i];
        CHECK(frame.radiance.values()[i] == sum);
        least = std::min(least, frame.sample_count.values()[i]);
        most = std::max(most, frame.sample_count.values()[i]);
    }
    CHECK(least == 4.0f);
    CHECK(most >= 64.0f);
    settings.planes = {Plane::radiance};
    const Frame bare = records(scene, settings).frame;
    CHECK(bare.radiance == frame.radiance);
    CHECK(bare.direct.empty());
    CHECK(bare.position_world.empty());
}

TEST_CASE("a scene without any light is black", "[surface_records]") {
    const Scene scene = box_with("", kBall);
    const Frame frame = records(scene, small_settings({16, 16}, 1)).frame;
    CHECK(mean_of(frame.radiance) == glm::dvec3(0.0));
}

TEST_CASE("surface_records is a method, with options that make its plan", "[surface_records]") {
    const Method& method = find_method("surface_records");
    const Scene scene = repository_scene("cornell");
    MethodRequest request{scene, small_settings({16, 16}, 8), {}};
    const MethodRender by_spp = method.run(request, {});
    CHECK(by_spp.facts["cell"] == surface_records_plan(8).cell);
    CHECK(by_spp.render.frame.radiance ==
          records(scene, request.settings, surface_records_plan(8)).frame.radiance);
    request.parameters.surface_records.cell = 4;
    request.parameters.surface_records.record_paths = 32;
    SurfaceRecordsPlan plan = surface_records_plan(8);
    plan.cell = 4;
    plan.record_paths = 32;
    const MethodRender given = method.run(request, {});
    CHECK(given.facts["record_paths"] == 32);
    CHECK(given.render.frame.radiance == records(scene, request.settings, plan).frame.radiance);
    const Scene pattern = repository_scene("illustration_9");
    const MethodRender filled = render(method, {pattern, small_settings({4, 4}, 1), {}});
    CHECK(filled.render.frame.radiance(3, 0).x == Approx(0.875f));
}

TEST_CASE("surface records say what they cannot do", "[surface_records]") {
    const Scene scene = repository_scene("cornell");
    RenderSettings settings = small_settings({8, 8}, 1);
    SurfaceRecordsPlan plan = kSmallPlan;
    plan.cell = 0;
    const Error cell = error_of([&] { records(scene, settings, plan); });
    CHECK(cell.code() == ExitCode::usage);
    CHECK(std::string(cell.what()).find("cell: found 0, allowed: 1 to 256") != std::string::npos);
    settings.planes = {Plane::radiance, Plane::albedo_mean};
    CHECK(error_of([&] { records(scene, settings); }).code() == ExitCode::usage);
    settings.planes = Planes::all();
    settings.light_sampling = LightSampling::none;
    CHECK(error_of([&] { records(scene, settings); }).code() == ExitCode::usage);
    settings.light_sampling = LightSampling::nee;
    const Progress stop = [](double) { return false; };
    const Error stopped =
        error_of([&] { render_surface_records(scene, settings, kSmallPlan, stop); });
    CHECK(stopped.code() == ExitCode::interrupted);
}

TEST_CASE("where the time of surface records goes", "[.][benchmark]") {
    for (const char* name : {"cornell_sphere", "hard_shadows"}) {
        const Scene scene = repository_scene(name);
        RenderSettings settings = small_settings({512, 512}, 1);
        settings.planes = {Plane::radiance};
        std::printf("%s, 512x512, ms\n  spp  pilot records  fit  needs samples resolve\n", name);
        for (const int spp : {2, 4, 8, 16, 32, 64}) {
            StageTimes least;
            for (int repeat = 0; repeat < 5; ++repeat) {
                const StageTimes t =
                    render_in_stages(scene, settings, {surface_records_plan(spp)}, {}).times;
                const auto keep = [repeat](double& held, double now) {
                    held = repeat == 0 ? now : std::min(held, now);
                };
                keep(least.pilot_s, t.pilot_s);
                keep(least.records_s, t.records_s);
                keep(least.fit_s, t.fit_s);
                keep(least.needs_s, t.needs_s);
                keep(least.samples_s, t.samples_s);
                keep(least.resolve_s, t.resolve_s);
            }
            std::printf("%5d %6.1f %7.1f %4.1f %6.1f %7.1f %7.1f\n", spp, least.pilot_s * 1e3,
                        least.records_s * 1e3, least.fit_s * 1e3, least.needs_s * 1e3,
                        least.samples_s * 1e3, least.resolve_s * 1e3);
        }
    }
}
