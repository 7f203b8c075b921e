// SPDX-License-Identifier: Apache-2.0
//
// What holds for every render method, whatever rays it traces: each test goes over the table, so a
// new row is tested at once.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "filters/methods.h"
#include "tests/catch.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;

template <class Check>
void for_each_method(Check&& check) {
    for (const Method& method : all_methods()) {
        INFO(method.name);
        check(method);
    }
}

Json quad(std::initializer_list<std::initializer_list<int>> corners) {
    return {{"quad", corners}, {"material", "wall"}};
}

/// A closed box of one material, seen from inside: the same radiance everywhere.
Scene furnace(double albedo, double emission) {
    const Json camera = {{"position", {0.1, 0.2, 0.3}},
                         {"look_at", {0, 0, -1}},
                         {"up", {0, 1, 0}},
                         {"vertical_fov_degrees", 60}};
    const Json wall = {{"albedo", {albedo, albedo, albedo}},
                       {"emission", {emission, emission, emission}}};
    const Json walls = {quad({{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}}),
                        quad({{1, -1, 1}, {-1, -1, 1}, {-1, 1, 1}, {1, 1, 1}}),
                        quad({{-1, -1, 1}, {1, -1, 1}, {1, -1, -1}, {-1, -1, -1}}),
                        quad({{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}),
                        quad({{-1, -1, 1}, {-1, -1, -1}, {-1, 1, -1}, {-1, 1, 1}}),
                        quad({{1, -1, -1}, {1, -1, 1}, {1, 1, 1}, {1, 1, -1}})};
    const Json document = {{"camera", camera}, {"materials", {{"wall", wall}}}, {"objects", walls}};
    return parse_scene(document, "furnace.json");
}

Scene box() {
    return load_scene(std::string(VECINO_SOURCE_DIR) + "/scenes/cornell_sphere.json");
}

RenderSettings settings_of(Extent size, int spp) {
    RenderSettings settings;
    settings.size = size;
    settings.spp = spp;
    return settings;
}

bool all_finite(const Image& image) {
    return std::ranges::all_of(image.values(), is_finite);
}

double mean(const Image& image) {
    double sum = 0;
    for (const glm::vec3& color : image.values())
        sum += (double{color.x} + double{color.y} + double{color.z}) / 3;
    return sum / static_cast<double>(image.size().area());
}

}  // namespace

TEST_CASE("in a furnace every method finds the radiance that a series tells", "[methods]") {
    const Scene scene = furnace(0.5, 1.0);
    const double expected[] = {1.0, 1.5, 1.75, 1.875};
    const int depth = GENERATE(0, 1, 2, 3);
    for_each_method([&](const Method& method) {
        RenderSettings settings = settings_of({33, 23}, 64);
        settings.max_depth = depth;
        const Image image = render(method, {scene, settings, {}}).render.frame.radiance;
        CHECK(image.size() == Extent{33, 23});
        CHECK(mean(image) == Approx(expected[depth]).epsilon(0.02));
    });
}

TEST_CASE("light that is scaled scales what every method finds", "[methods]") {
    const Scene dim = furnace(0.7, 1.0);
    const Scene bright = furnace(0.7, 1024.0);
    for_each_method([&](const Method& method) {
        const RenderSettings settings = settings_of({16, 12}, 16);
        const Image expected = render(method, {dim, settings, {}}).render.frame.radiance;
        const Image result = render(method, {bright, settings, {}}).render.frame.radiance;
        CHECK(mean(result) == Approx(1024 * mean(expected)).epsilon(0.02));
    });
}

TEST_CASE("every method renders every size, with the same bits on any number of threads",
          "[methods]") {
    const Scene scene = box();
    const Extent size = GENERATE(values<Extent>({{1, 1}, {1, 9}, {13, 1}, {2, 2}, {31, 19}}));
    INFO(size_text(size));
    for_each_method([&](const Method& method) {
        RenderSettings settings = settings_of(size, 5);
        settings.threads = 1;
        const Image one = render(method, {scene, settings, {}}).render.frame.radiance;
        CHECK(one.size() == size);
        CHECK(all_finite(one));
        settings.threads = 3;
        CHECK(render(method, {scene, settings, {}}).render.frame.radiance == one);
    });
}

TEST_CASE("every method gives finite images of the darkest and the brightest scenes", "[methods]") {
    const double emission = GENERATE(0.0, 1.0e-30, 1.0e30);
    const double albedo = GENERATE(0.0, 1.0);
    const Scene scene = furnace(albedo, emission);
    for_each_method([&](const Method& method) {
        const MethodRender made = render(method, {scene, settings_of({9, 7}, 4), {}});
        CHECK(all_finite(made.render.frame.radiance));
        CHECK(made.render.statistics.non_finite_pixels == 0);
        if (emission == 0.0) CHECK(mean(made.render.frame.radiance) == 0.0);
    });
}

TEST_CASE("every method renders scenes of nothing and of one point of light", "[methods]") {
    Scene nothing = furnace(0.5, 1.0);
    nothing.objects.clear();
    nothing.background = {0.25f, 0.5f, 1.0f};
    Scene speck = nothing;
    speck.objects.push_back({Sphere{{0.0f, 0.0f, -1.0e3f}, 1.0e-3f}, 0});
    for_each_method([&](const Method& method) {
        const RenderSettings settings = settings_of({8, 6}, 4);
        const Image empty = render(method, {nothing, settings, {}}).render.frame.radiance;
        CHECK(empty == Image({8, 6}, {0.25f, 0.5f, 1.0f}));
        CHECK(all_finite(render(method, {speck, settings, {}}).render.frame.radiance));
    });
}
