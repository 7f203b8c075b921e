// SPDX-License-Identifier: Apache-2.0
//
// The method surface_records where few samples, or few records, mislead.
#include <algorithm>
#include <utility>
#include <variant>
#include <vector>

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

TEST_CASE("half-shadow without further samples is smooth, and hard edges stay hard",
          "[surface_records]") {
    // One sample for each needy pixel on average: most get none.
    const SurfaceRecordsPlan plan{1, 1, 16, 0, 64, 64, 1.0, 0.15};
    RenderSettings settings = small_settings({256, 256}, 1);
    settings.max_depth = 1;
    const auto quality = [&](const std::string& name) {
        const Scene scene = repository_scene("failures/" + name);
        return db(records(scene, settings, plan).frame.radiance, paths(scene, settings, 256));
    };
    CHECK(quality("f16_soft_shadow") > 32);  // 17 as the samples are
    CHECK(quality("f16_hard_shadow") > 29);  // 30 so
    settings.size = {200, 90};
    const Scene many = repository_scene("corridor");
    Image threads[2];
    for (int i = 0; i < 2; ++i) {
        settings.threads = 1 + 6 * i;
        threads[i] = records(many, settings, plan).frame.radiance;
    }
    CHECK(threads[0] == threads[1]);
    CHECK(db(threads[0], paths(many, settings, 256)) > 26.8);  // 25.6 so
}

namespace {

/// Each lamp in four, which shine as it does: more lamps than samples sum up.
Scene with_split_lamps(Scene scene) {
    std::vector<Object> objects;
    for (const Object& object : scene.objects) {
        const auto* const quad = std::get_if<Quad>(&object.shape);
        if (quad == nullptr || scene.materials[object.material].emission == glm::vec3(0.0f)) {
            objects.push_back(object);
            continue;
        }
        const auto& [a, b, c, d] = quad->corners_world;
        const glm::vec3 ab = 0.5f * (a + b), bc = 0.5f * (b + c), cd = 0.5f * (c + d),
                        da = 0.5f * (d + a), middle = 0.5f * (ab + cd);
        for (const Quad& part : {Quad{{a, ab, middle, da}}, Quad{{ab, b, bc, middle}},
                                 Quad{{middle, bc, c, cd}}, Quad{{da, middle, cd, d}}})
            objects.push_back({part, object.material});
    }
    scene.objects = std::move(objects);
    return scene;
}

/// The corridor below its lamps.
Scene low_corridor() {
    Scene scene = repository_scene("corridor");
    scene.camera.look_at_world = {0.0f, 0.0f, -0.6f};
    return scene;
}

/// With something that throws shadows.
Scene corridor_with_balls() {
    Scene scene = low_corridor();
    const std::size_t material = scene.objects.front().material;
    scene.objects.push_back({Sphere{{-0.4f, 0.4f, -1.6f}, 0.4f}, material});
    scene.objects.push_back({Sphere{{0.35f, 0.9f, -2.6f}, 0.35f}, material});
    return scene;
}

}  // namespace

TEST_CASE("of many lamps, what nothing hides has no noise, and shadows come out right",
          "[surface_records]") {
    RenderSettings settings = small_settings({160, 160}, 1);
    settings.max_depth = 1;
    const SurfaceRecordsPlan few{1, 4, 16, 0, 64, 64, 1.0, 0.15}, many{16, 512, 16, 0, 64, 64};
    const auto quality = [&](const Scene& scene, const SurfaceRecordsPlan& plan) {
        return db(records(scene, settings, plan).frame.radiance, paths(scene, settings, 1024));
    };
    const Scene corridor = low_corridor(), balls = corridor_with_balls();
    CHECK(quality(corridor, few) > 54);
    CHECK(quality(balls, few) > 49);
    CHECK(quality(balls, many) > 67);
    // Of 48 lamps all is found by picking.
    CHECK(quality(with_split_lamps(corridor), few) > 46);
    CHECK(quality(with_split_lamps(balls), many) > 66);
}

TEST_CASE("half-shadow is fitted to the pixels around, and fades out", "[surface_records]") {
    const RenderSettings settings = [] {
        RenderSettings all = small_settings({256, 256}, 1);
        all.max_depth = 1;
        return all;
    }();
    const auto quality = [&](const std::string& name, const SurfaceRecordsPlan& plan) {
        const Scene scene = repository_scene(name);
        return db(records(scene, settings, plan).frame.radiance, paths(scene, settings, 1024));
    };
    // In brackets, without: pixels by their own samples, and none beyond what eight of them see.
    CHECK(quality("failures/f16_soft_shadow", {2, 32, 16, 0, 64, 64, 1.0, 0.15}) > 45);
    CHECK(quality("failures/f16_soft_shadow", {8, 200, 16, 0, 64, 64, 1.0, 0.15}) > 53);
    CHECK(quality("failures/f16_hard_shadow", {4, 64, 16, 0, 64, 64, 1.0, 0.15}) > 40);
}

TEST_CASE("however few samples there are, no edge of a lamp is left to the first ones",
          "[surface_records]") {
    const Scene scene = repository_scene("hard_shadows");
    RenderSettings settings = small_settings({256, 256}, 1);
    settings.max_depth = 1;
    const Image made = records(scene, settings, {1, 4, 16, 0, 64, 64, 1.0, 0.15}).frame.radiance;
    const Image reference = paths(scene, settings, 256);
    // Of pixels that are too bright to be shown, by one sample many are as dark as the ceiling.
    int dark = 0, bright = 0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 256; ++x) {
            if (!(reference(x, y).y > 1.5f)) continue;
            ++bright;
            if (made(x, y).y < 0.7f) ++dark;
        }
    }
    CHECK(bright > 20);
    CHECK(dark == 0);
}

namespace {

/// Bars and tiles a tenth of a pixel above a wall, cells down to single pixels.
constexpr SurfaceRecordsPlan kContactPlan{16, 256, 4, 2, 1024, 2048, 1.0, 0.2};

}  // namespace

TEST_CASE("fits between records swing no farther than their records do", "[surface_records]") {
    const Scene scene = repository_scene("failures/f10_odd_size");
    RenderSettings settings = small_settings({192, 192}, 1);
    settings.max_depth = 3;
    settings.seed = GENERATE(1u, 2u);
    const Render made = records(scene, settings, kContactPlan);
    float brightest = 0;
    for (int y = 0; y < 192; ++y) {
        for (int x = 0; x < 192; ++x) brightest = std::max(brightest, made.frame.radiance(x, y).z);
    }
    CHECK(brightest < 0.85f);  // the sky is 1, the blue of the wall 0.8
}

TEST_CASE("paths of their own show pixels at edges the finest contacts", "[surface_records]") {
    const Scene scene = repository_scene("failures/f09_thin_bar");
    RenderSettings settings = small_settings({192, 192}, 1);
    settings.max_depth = 3;
    const Image reference = paths(scene, settings, 1024);
    SurfaceRecordsPlan plan = kContactPlan;
    const double by_records = db(records(scene, settings, plan).frame.radiance, reference);
    plan.edge_light = EdgeLight::paths;
    settings.threads = 1;
    const Render made = records(scene, settings, plan);
    CHECK(db(made.frame.radiance, reference) > by_records + 4);
    settings.threads = 7;
    CHECK(made.frame.radiance == records(scene, settings, plan).frame.radiance);
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

TEST_CASE("records are not placed right beside something else where there is other room",
          "[surface_records]") {
    const Scene scene = repository_scene("failures/f09_thin_bar");
    RenderSettings settings = small_settings({192, 192}, 1);
    settings.max_depth = 3;
    SurfaceRecordsPlan plan{16, 2048, 4, 0, 1024, 1024, 1.0, 0.15};
    plan.edge_light = EdgeLight::paths;
    const Image made = records(scene, settings, plan).frame.radiance;
    CHECK(db(made, paths(scene, settings, 4096)) > 72);  // 67 so
}

TEST_CASE("paths show the ring of contact of a lamp right before its ceiling",
          "[surface_records]") {
    // A tenth of a pixel off, it hides the sky from what is right beside it.
    const Scene scene = repository_scene("failures/f06_flush_emitter");
    RenderSettings settings = small_settings({96, 96}, 1);
    settings.max_depth = 3;
    const Image reference = paths(scene, settings, 4096);
    SurfaceRecordsPlan plan{32, 1024, 8, 0, 64, 64, 1.0, 0.15};
    const double by_records = db(records(scene, settings, plan).frame.radiance, reference);
    plan.edge_light = EdgeLight::paths;
    CHECK(db(records(scene, settings, plan).frame.radiance, reference) > by_records + 10);
}
