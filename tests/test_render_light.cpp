// SPDX-License-Identifier: Apache-2.0
//
// Light transport against values that are known exactly.
#include <cmath>
#include <numbers>

#include "tests/catch.h"
#include "tests/scene_text.h"

using namespace vecino;
using namespace vecino::test;

namespace {

double furnace(double emission, double albedo, int depth) {
    double sum = 0;
    for (int k = 0; k <= depth; ++k) sum += std::pow(albedo, k);
    return emission * sum;
}

const char* const kGreyLamp = R"({"albedo": [0.5, 0.25, 0.75], "emission": [2, 2, 2]})";

/// Two floors that face each other, with a lamp between them; the camera sees one of them.
std::string lamp_between_floors(const std::string& lamp, bool camera_on_lower) {
    const std::string look = camera_on_lower ? "[0, -1, 0]" : "[0, 1, 0]";
    return R"({"camera": {"position": [3, 0, 0], "look_at": )" + look +
           R"(, "up": [0, 0, 1], "vertical_fov_degrees": 4},
        "materials": {"floor": {"albedo": [0.5, 0.5, 0.5]}, "lamp": {"emission": [1, 1, 1]}},
        "objects": [
          {"quad": [[-1,-1,-1],[-1,-1,1],[1,-1,1],[1,-1,-1]], "material": "floor"},
          {"quad": [[-1,1,-1],[1,1,-1],[1,1,1],[-1,1,1]], "material": "floor"},
          )" +
           lamp + R"(]})";
}

double lit(const std::string& lamp, bool lower, LightSampling light_sampling) {
    RenderSettings settings = small_settings({8, 8}, 4096);
    settings.max_depth = 1;
    settings.light_sampling = light_sampling;
    return mean_of(render(scene_from(lamp_between_floors(lamp, lower)), settings).frame.radiance).x;
}

}  // namespace

TEST_CASE("a closed furnace found by chance holds Le (1 + a + ... + a^d) in every sample",
          "[render]") {
    const int depth = GENERATE(0, 1, 2, 5);
    const Sampler sampler = GENERATE(Sampler::independent, Sampler::sobol);
    CAPTURE(depth);
    RenderSettings settings = small_settings({16, 16}, 16);
    settings.max_depth = depth;
    settings.light_sampling = LightSampling::none;
    settings.sampler = sampler;
    const Image image = render(scene_from(closed_cube(kGreyLamp)), settings).frame.radiance;
    for (const glm::vec3& value : image.values()) {
        CHECK(value.x == Approx(furnace(2, 0.5, depth)).epsilon(1e-5));
        CHECK(value.y == Approx(furnace(2, 0.25, depth)).epsilon(1e-5));
        CHECK(value.z == Approx(furnace(2, 0.75, depth)).epsilon(1e-5));
    }
}

TEST_CASE("a closed furnace with next-event estimation holds Le (1 + a + ... + a^d) on average",
          "[render][slow]") {
    const int depth = GENERATE(0, 1, 2, 4);
    CAPTURE(depth);
    RenderSettings settings = small_settings({32, 32}, 1024);
    settings.max_depth = depth;
    const glm::dvec3 mean =
        mean_of(render(scene_from(closed_cube(kGreyLamp)), settings).frame.radiance);
    CHECK(mean.x == Approx(furnace(2, 0.5, depth)).epsilon(0.01));
    CHECK(mean.y == Approx(furnace(2, 0.25, depth)).epsilon(0.01));
    CHECK(mean.z == Approx(furnace(2, 0.75, depth)).epsilon(0.01));
}

TEST_CASE("a sum of a million samples loses nothing", "[render][slow]") {
    RenderSettings settings = small_settings({1, 1}, 1000000);
    settings.light_sampling = LightSampling::none;
    const Image image = render(scene_from(closed_cube(kGreyLamp)), settings).frame.radiance;
    CHECK(image(0, 0).x == Approx(furnace(2, 0.5, 2)).epsilon(1e-6));
}

TEST_CASE("a convex object under a uniform background reflects its albedo", "[render]") {
    const LightSampling light_sampling = GENERATE(LightSampling::none, LightSampling::nee);
    const Scene scene = scene_from(R"({
        "camera": {"position": [0, 0, 5], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 10},
        "background": [1, 2, 3],
        "materials": {"m": {"albedo": [0.5, 0.5, 0.25]}},
        "objects": [{"sphere": {"center": [0, 0, 0], "radius": 1}, "material": "m"}]})");
    RenderSettings settings = small_settings({8, 8}, 16);
    settings.light_sampling = light_sampling;
    const Frame frame = render(scene, settings).frame;
    for (const glm::vec3& value : frame.radiance.values()) {
        CHECK(value.x == Approx(0.5));
        CHECK(value.y == Approx(1.0));
        CHECK(value.z == Approx(0.75));
    }
    settings.max_depth = 0;
    CHECK(mean_of(render(scene, settings).frame.radiance).x == Approx(0.0).margin(1e-9));
}

TEST_CASE("lamps of all three shapes light one side only", "[render]") {
    const LightSampling light_sampling = GENERATE(LightSampling::none, LightSampling::nee);
    const std::string quad_down =
        R"({"quad": [[-0.4,0,-0.4],[0.4,0,-0.4],[0.4,0,0.4],[-0.4,0,0.4]], "material": "lamp"})";
    const std::string quad_up =
        R"({"quad": [[-0.4,0,-0.4],[-0.4,0,0.4],[0.4,0,0.4],[0.4,0,-0.4]], "material": "lamp"})";
    const std::string mesh_down =
        R"({"triangles": {"positions": [[-0.4,0,-0.4],[0.4,0,-0.4],[0,0,0.4]], "indices": [[0,1,2]]}, "material": "lamp"})";
    const std::string mesh_up =
        R"({"triangles": {"positions": [[-0.4,0,-0.4],[0.4,0,-0.4],[0,0,0.4]], "indices": [[0,2,1]]}, "material": "lamp"})";
    const std::string sphere =
        R"({"sphere": {"center": [0, 0, 0], "radius": 0.3}, "material": "lamp"})";
    CHECK(lit(quad_down, true, light_sampling) > 0.01);
    CHECK(lit(quad_down, false, light_sampling) == 0.0);
    CHECK(lit(quad_up, true, light_sampling) == 0.0);
    CHECK(lit(quad_up, false, light_sampling) > 0.01);
    CHECK(lit(mesh_down, true, light_sampling) > 0.005);
    CHECK(lit(mesh_down, false, light_sampling) == 0.0);
    CHECK(lit(mesh_up, true, light_sampling) == 0.0);
    CHECK(lit(mesh_up, false, light_sampling) > 0.005);
    CHECK(lit(sphere, true, light_sampling) > 0.01);
    CHECK(lit(sphere, false, light_sampling) > 0.01);
}

TEST_CASE("inside of a glowing sphere it is dark", "[render]") {
    const LightSampling light_sampling = GENERATE(LightSampling::none, LightSampling::nee);
    RenderSettings settings = small_settings({8, 8}, 64);
    settings.light_sampling = light_sampling;
    const Scene scene = scene_from(R"({
        "camera": {"position": [0, 0, 0.5], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 60},
        "materials": {"m": {"albedo": [0.5, 0.5, 0.5]}, "lamp": {"emission": [1, 1, 1]}},
        "objects": [{"sphere": {"center": [0, 0, 0], "radius": 1}, "material": "lamp"},
                    {"sphere": {"center": [0, 0, 0], "radius": 0.2}, "material": "m"}]})");
    CHECK(mean_of(render(scene, settings).frame.radiance).x == 0.0);
}

TEST_CASE("a floor under a spherical lamp reflects a Le (r / d)^2", "[render]") {
    const LightSampling light_sampling = GENERATE(LightSampling::none, LightSampling::nee);
    const Scene scene = scene_from(R"({
        "camera": {"position": [0, 0.001, 10], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 0.02},
        "materials": {"m": {"albedo": [0.8, 0.8, 0.8]}, "lamp": {"emission": [3, 3, 3]}},
        "objects": [{"quad": [[-9,-9,0],[9,-9,0],[9,9,0],[-9,9,0]], "material": "m"},
                    {"sphere": {"center": [0, 0, 2], "radius": 0.5}, "material": "lamp"}]})");
    // The lamp itself stands before the camera: look from the side instead.
    Scene side = scene;
    side.camera.position_world = {4, 0, 3};
    RenderSettings settings = small_settings({2, 2}, 1 << 16);
    settings.max_depth = 1;
    settings.light_sampling = light_sampling;
    const double expected = 0.8 * 3 * (0.5 * 0.5) / (2.0 * 2.0);
    CHECK(mean_of(render(side, settings).frame.radiance).x == Approx(expected).epsilon(0.01));
}

TEST_CASE("many lamps of all shapes: next-event estimation and chance agree", "[render][slow]") {
    const Scene scene = scene_from(R"({
        "camera": {"position": [0, 1, 4.2], "look_at": [0, 1, 0], "up": [0, 1, 0], "vertical_fov_degrees": 34.5},
        "background": [0.05, 0.1, 0.2],
        "materials": {"w": {"albedo": [0.7, 0.7, 0.7]}, "a": {"emission": [8, 1, 1]}, "b": {"emission": [1, 9, 1], "albedo": [0.3, 0.3, 0.3]},
                      "c": {"emission": [2, 2, 12]}},
        "objects": [
          {"quad": [[-1,0,-1],[-1,0,1],[1,0,1],[1,0,-1]], "material": "w"},
          {"quad": [[-1,0,-1],[1,0,-1],[1,2,-1],[-1,2,-1]], "material": "w"},
          {"quad": [[-0.8,1.9,-0.5],[-0.2,1.9,-0.5],[-0.3,1.8,0.2],[-0.9,1.9,0.1]], "material": "a"},
          {"quad": [[0.2,1.9,-0.5],[0.6,1.9,-0.5],[0.6,1.9,0],[0.2,1.9,0]], "material": "b"},
          {"sphere": {"center": [0.5, 0.3, 0.2], "radius": 0.25}, "material": "c"},
          {"triangles": {"positions": [[-0.6,0.01,0.3],[-0.3,0.01,0.3],[-0.5,0.3,0.2],[-0.2,0.4,0.2]], "indices": [[0,1,2],[2,1,3]]}, "material": "a"}]})");
    RenderSettings settings = small_settings({12, 12}, 1 << 15);
    settings.sampler = Sampler::independent;
    const Frame by_light = render(scene, settings).frame;
    settings.light_sampling = LightSampling::none;
    settings.seed = 2;
    const Frame by_chance = render(scene, settings).frame;
    double chi2 = 0;
    int noisy = 0;
    for (std::size_t i = 0; i < by_light.radiance.values().size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const double difference = static_cast<double>(by_light.radiance.values()[i][c]) -
                                      static_cast<double>(by_chance.radiance.values()[i][c]);
            const double variance = static_cast<double>(by_light.variance.values()[i][c]) +
                                    static_cast<double>(by_chance.variance.values()[i][c]);
            CHECK(difference * difference <= 25.0 * variance + 1e-12);
            if (variance < 1e-10) continue;  // only background or a lamp is seen
            chi2 += difference * difference / variance;
            ++noisy;
        }
    }
    CHECK(noisy > 100);
    CHECK(chi2 / noisy == Approx(1.0).margin(0.3));
}

TEST_CASE("normals that equal the geometric ones change nothing but others do", "[render]") {
    const auto tilted = [](const std::string& normal) {
        return scene_from(R"({
        "camera": {"position": [0, 0, 3], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 30},
        "materials": {"m": {"albedo": [0.5, 0.5, 0.5]}, "lamp": {"emission": [20, 20, 20]}},
        "objects": [{"triangles": {"positions": [[-2,-2,0],[2,-2,0],[0,3,0]], "indices": [[0,1,2]])" +
                          normal + R"(}, "material": "m"},
                    {"sphere": {"center": [2, 0, 2], "radius": 0.2}, "material": "lamp"}]})");
    };
    const RenderSettings settings = small_settings({16, 16}, 64);
    const Frame plain = render(tilted(""), settings).frame;
    const Frame same = render(tilted(R"(, "normals": [[0,0,2],[0,0,1],[0,0,1]])"), settings).frame;
    const Frame other = render(tilted(R"(, "normals": [[1,0,1],[1,0,1],[1,0,1]])"), settings).frame;
    CHECK(plain.radiance == same.radiance);
    CHECK(mean_of(other.radiance).x > 1.05 * mean_of(plain.radiance).x);  // turned towards the lamp
    CHECK(other.normal_world == plain.normal_world);  // the first hit keeps the geometric normal
}
