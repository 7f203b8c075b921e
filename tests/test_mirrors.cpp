// SPDX-License-Identifier: Apache-2.0
//
// Perfect mirrors against what they must show.
#include <cmath>
#include <nlohmann/json.hpp>

#include "tests/catch.h"
#include "tests/scene_text.h"

using namespace vecino;
using namespace vecino::test;

namespace {

/// A wall at z = 0 that fills the view, and a lamp behind the camera that fills it in the mirror.
std::string wall_and_lamp(const std::string& wall, const std::string& rest = "") {
    return R"({"camera": {"position": [0, 0, 2], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 40},
        "materials": {"wall": )" +
           wall + R"(, "lamp": {"emission": [2, 4, 8]}},
        "objects": [{"quad": [[-2,-2,0],[2,-2,0],[2,2,0],[-2,2,0]], "material": "wall"},
                    {"quad": [[-9,-9,5],[-9,9,5],[9,9,5],[9,-9,5]], "material": "lamp"}])" +
           rest + "}";
}

/// A closed room with a lamp, a box of mirrors and a textured look: everything at once.
Scene room(bool with_mirrors) {
    nlohmann::json document = nlohmann::json::parse(
        R"({"camera": {"position": [0, 1, 4.2], "look_at": [0, 1, 0], "up": [0, 1, 0], "vertical_fov_degrees": 34.5},
        "materials": {"white": {"albedo": [0.7, 0.7, 0.7]}, "red": {"albedo": [0.6, 0.1, 0.1]},
                      "mirror": {"albedo": [0.9, 0.8, 0.7], "mirror": true}, "lamp": {"emission": [15, 15, 15]}},
        "objects": [
          {"quad": [[-1,0,1],[1,0,1],[1,0,-1],[-1,0,-1]], "material": "white"},
          {"quad": [[-1,2,-1],[1,2,-1],[1,2,1],[-1,2,1]], "material": "white"},
          {"quad": [[-1,0,-1],[1,0,-1],[1,2,-1],[-1,2,-1]], "material": "mirror"},
          {"quad": [[-1,0,1],[-1,0,-1],[-1,2,-1],[-1,2,1]], "material": "red"},
          {"quad": [[1,0,-1],[1,0,1],[1,2,1],[1,2,-1]], "material": "white"},
          {"sphere": {"center": [0.3, 0.4, 0.2], "radius": 0.4}, "material": "mirror"},
          {"quad": [[-0.25,1.999,-0.25],[0.25,1.999,-0.25],[0.25,1.999,0.25],[-0.25,1.999,0.25]], "material": "lamp"}]})");
    if (!with_mirrors) document["materials"]["mirror"]["mirror"] = false;
    return parse_scene(document, "room.json");
}

glm::dvec3 mean_radiance(const Scene& scene, const RenderSettings& settings) {
    return mean_of(render(scene, settings).frame.radiance);
}

}  // namespace

TEST_CASE("a mirror shows a lamp in full, whatever else finds light", "[mirror]") {
    const int width = GENERATE(from_range(simd_widths()));
    RenderSettings settings = small_settings({8, 8}, 16);
    settings.simd_width = width;
    settings.max_depth = 1;
    settings.light_sampling = GENERATE(LightSampling::none, LightSampling::nee);
    settings.multiple_importance = GENERATE(MultipleImportance::none, MultipleImportance::balance);
    settings.control_variate = GENERATE(ControlVariate::none, ControlVariate::irradiance);
    const bool has_sky = GENERATE(false, true);
    CAPTURE(width, has_sky);
    const Scene scene = scene_from(wall_and_lamp(R"({"albedo": [0.5, 0.25, 1], "mirror": true})",
                                                 has_sky ? R"(, "background": [7, 7, 7])" : ""));
    const Frame frame = render(scene, settings).frame;
    for (std::size_t i = 0; i < frame.radiance.values().size(); ++i) {
        CHECK(frame.radiance.values()[i] == glm::vec3(1, 1, 8));
        CHECK(frame.direct.values()[i] == glm::vec3(1, 1, 8));
        CHECK(frame.albedo.values()[i] == glm::vec3(0.5f, 0.25f, 1));  // of the mirror itself
        CHECK(frame.object_id.values()[i] == 0);
        CHECK(frame.normal_world.values()[i] == glm::vec3(0, 0, 1));
    }
}

TEST_CASE("a mirror without an albedo reflects all light, and one of depth 0 none", "[mirror]") {
    const Scene scene = scene_from(wall_and_lamp(R"({"mirror": true})"));
    RenderSettings settings = small_settings({4, 4}, 4);
    CHECK(render(scene, settings).frame.radiance(1, 1) == glm::vec3(2, 4, 8));
    settings.max_depth = 0;
    CHECK(render(scene, settings).frame.radiance(1, 1) == glm::vec3(0));
    CHECK(scene_from(wall_and_lamp(R"({"mirror": false})")).materials[1].albedo == glm::vec3(0));
}

TEST_CASE("a mirror shows the sky", "[mirror]") {
    Scene scene = scene_from(wall_and_lamp(R"({"albedo": [0.5, 0.5, 0.5], "mirror": true})",
                                           R"(, "background": [3, 2, 1])"));
    const bool has_lamp = GENERATE(false, true);
    if (!has_lamp) scene.objects.pop_back();
    if (has_lamp) {  // aside, where the mirror does not show it
        for (glm::vec3& corner : std::get<Quad>(scene.objects[1].shape).corners_world)
            corner.x += 100.0f;
    }
    RenderSettings settings = small_settings({8, 8}, 16);
    settings.light_sampling = GENERATE(LightSampling::none, LightSampling::nee);
    settings.max_depth = GENERATE(1, 3);
    const Frame frame = render(scene, settings).frame;
    for (const glm::vec3& value : frame.radiance.values()) CHECK(value == glm::vec3(1.5f, 1, 0.5f));
    CHECK(frame.direct == frame.radiance);
}

TEST_CASE("a furnace with walls of mirrors holds Le (1 + a + ... + a^d)", "[mirror]") {
    const int depth = GENERATE(1, 2, 5);
    const bool all_mirrors = GENERATE(false, true);
    CAPTURE(depth, all_mirrors);
    nlohmann::json document =
        nlohmann::json::parse(closed_cube(R"({"albedo": [0.5, 0.5, 0.5], "emission": [2, 2, 2]})"));
    document["materials"]["mirror"] = document["materials"]["m"];
    document["materials"]["mirror"]["mirror"] = true;
    for (std::size_t i = 0; i < (all_mirrors ? 6u : 3u); ++i)
        document["objects"][i]["material"] = "mirror";
    const Scene scene = parse_scene(document, "furnace.json");
    const double expected = 2 * (1 - std::pow(0.5, depth + 1)) / 0.5;
    RenderSettings settings = small_settings({16, 16}, 256);
    settings.max_depth = depth;
    settings.light_sampling = LightSampling::none;
    const Image image = render(scene, settings).frame.radiance;
    for (const glm::vec3& value : image.values()) CHECK(value.x == Approx(expected).epsilon(1e-5));
    settings.light_sampling = LightSampling::nee;
    const double tolerance = all_mirrors ? 1e-5 : 0.01;  // next-event estimation has noise
    CHECK(mean_radiance(scene, settings).x == Approx(expected).epsilon(tolerance));
}

TEST_CASE("a flat mirror shows what a camera behind it would see", "[mirror]") {
    // The lamp's picture in the mirror at z = 0, and the lamp seen from the mirrored camera.
    const Scene in_mirror = scene_from(
        R"({"camera": {"position": [0.5, 0.25, 4], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 40},
        "materials": {"mirror": {"mirror": true}, "lamp": {"emission": [1, 2, 3]}},
        "objects": [{"quad": [[-9,-9,0],[9,-9,0],[9,9,0],[-9,9,0]], "material": "mirror"},
                    {"triangles": {"positions": [[-1,-1,5],[-1,1,6],[1,0,5]], "indices": [[0,1,2]]}, "material": "lamp"}]})");
    const Scene behind = scene_from(
        R"({"camera": {"position": [0.5, 0.25, -4], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 40},
        "materials": {"lamp": {"emission": [1, 2, 3]}},
        "objects": [{"triangles": {"positions": [[-1,-1,5],[-1,1,6],[1,0,5]], "indices": [[0,1,2]]}, "material": "lamp"}]})");
    RenderSettings settings = small_settings({24, 24}, 1024);
    settings.max_depth = 1;
    settings.light_sampling = GENERATE(LightSampling::none, LightSampling::nee);
    const Frame mirrored = render(in_mirror, settings).frame;
    const Image seen = render(behind, settings).frame.radiance;
    double largest = 0;
    for (int y = 0; y < 24; ++y) {
        for (int x = 0; x < 24; ++x) {
            const float found = mirrored.direct(x, y).x;
            largest = std::max(largest, std::abs(static_cast<double>(found - seen(23 - x, y).x)));
        }
    }
    CHECK(largest < 0.02);
    CHECK(mean_of(seen).x > 0.02);
}

TEST_CASE("light by way of mirrors is the same on average, found by chance or by estimation",
          "[mirror][slow]") {
    RenderSettings settings = small_settings({16, 16}, 4096);
    settings.max_depth = GENERATE(1, 2, 4);
    settings.multiple_importance = GENERATE(MultipleImportance::none, MultipleImportance::balance);
    settings.light_sampling = LightSampling::none;
    const glm::dvec3 by_chance = mean_radiance(room(true), settings);
    settings.light_sampling = LightSampling::nee;
    const glm::dvec3 estimated = mean_radiance(room(true), settings);
    for (int c = 0; c < 3; ++c) CHECK(estimated[c] == Approx(by_chance[c]).epsilon(0.015));
    CHECK(mean_radiance(room(false), settings).x != Approx(by_chance.x).epsilon(0.015));
}

TEST_CASE("a render with mirrors has the same bits with 1, 2 and 7 threads", "[mirror]") {
    const Scene scene = room(true);
    RenderSettings settings = small_settings({37, 23}, 33);
    settings.light_sampling = GENERATE(LightSampling::none, LightSampling::nee);
    settings.threads = 1;
    const Frame one = render(scene, settings).frame;
    settings.threads = 2;
    CHECK(render(scene, settings).frame.radiance == one.radiance);
    settings.threads = 7;
    CHECK(render(scene, settings).frame.radiance == one.radiance);
}
