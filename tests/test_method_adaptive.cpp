// SPDX-License-Identifier: Apache-2.0
//
// Adaptive tracing from coarse to fine, and the interpolation that it rests on.
#include <algorithm>
#include <numeric>

#include "filters/plane_fit.h"
#include "tests/method_frames.h"

using namespace vecino;
using namespace vecino::test;

namespace {

const Grid<float>& map_of(const MethodRender& render, std::string_view name) {
    const auto found = std::ranges::find(render.maps, name, &MethodMap::name);
    REQUIRE(found != render.maps.end());
    return found->values;
}

/// A grey wall that fills the view, in even light.
Scene plain_wall() {
    return scene_from(R"({
        "camera": {"position": [0, 0, 2], "look_at": [0, 0, 0], "up": [0, 1, 0],
                   "vertical_fov_degrees": 40},
        "materials": {"grey": {"albedo": [0.5, 0.5, 0.5]}},
        "objects": [{"quad": [[-9, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]],
                     "material": "grey"}],
        "background": [1, 1, 1]})");
}

}  // namespace

TEST_CASE("a plane through scattered pixels is exact for a plane", "[methods]") {
    const std::vector<Pixel> points{{-2, -1}, {3, -1}, {-1, 4}, {2, 2}};
    std::vector<double> weights(4);
    weights_at_origin(points, weights);
    double value = 0;
    for (std::size_t i = 0; i < points.size(); ++i)
        value += weights[i] * (5 + 2 * points[i].x - 3 * points[i].y);
    CHECK(value == Approx(5));
    CHECK(std::accumulate(weights.begin(), weights.end(), 0.0) == Approx(1));
    // On a line: the nearer one counts more, by the inverse distance.
    const std::vector<Pixel> line{{-1, 0}, {3, 0}};
    weights.resize(2);
    weights_at_origin(line, weights);
    CHECK(weights[0] == Approx(0.75));
}

TEST_CASE("pixels surround a place when it lies in their hull", "[methods]") {
    CHECK(surrounds_origin(std::vector<Pixel>{{-1, -1}, {1, -1}, {0, 2}}));
    CHECK(surrounds_origin(std::vector<Pixel>{{-4, 0}, {4, 0}}));  // on its border
    CHECK(surrounds_origin(std::vector<Pixel>{{-4, 0}, {4, 0}, {4, 4}, {-4, 4}}));
    CHECK_FALSE(surrounds_origin(std::vector<Pixel>{{1, 1}, {1, -1}, {3, 0}}));
    CHECK_FALSE(surrounds_origin(std::vector<Pixel>{{2, 0}, {4, 0}}));
    CHECK_FALSE(surrounds_origin(std::vector<Pixel>{{-4, 1}, {4, 1}, {0, 3}}));
    CHECK_FALSE(surrounds_origin({}));
}

TEST_CASE("of a plain wall, adaptive traces the lattice and the border", "[methods]") {
    const Scene scene = plain_wall();
    const MethodRequest request = request_of(scene, {65, 49}, 16);
    const MethodRender result = render_by("adaptive", request);
    // 16 x 12 pixels of the lattice, the last row and column.
    const std::size_t expected = 16 * 12 + 65 + 49 - 1;
    CHECK(require_paths_kept(result.render.frame, request) == expected);
    CHECK(result.facts["traced_share"] == double(expected) / (65 * 49));
    CHECK(result.facts["corrected_share"] == 0.0);
    // Half of the light arrives, everywhere.
    for (const glm::vec3& value : result.render.frame.radiance.values())
        CHECK(value.x == Approx(0.5).margin(1e-5));
    const Grid<float>& traced = map_of(result, "Explicit");
    const Grid<float>& calculated = map_of(result, "Calculated");
    CHECK(calculated(0, 0) == 1);
    CHECK(traced(0, 0) == 1);
    CHECK(traced(1, 0) == 0);
    CHECK(std::ranges::count(calculated.values(), 0.0f) == 0);
}

TEST_CASE("adaptive traces silhouettes, lamps and shadows' edges, and interpolates elsewhere",
          "[methods]") {
    const Scene scene = repository_scene("cornell_sphere");
    MethodRequest request = request_of(scene, {96, 96}, 64);
    request.settings.first_hit = FirstHit::centre;
    const MethodRender result = render_by("adaptive", request);
    const Frame& frame = result.render.frame;
    const std::size_t traced = require_paths_kept(frame, request);
    CHECK(traced > 96 * 96 / 20);
    CHECK(traced < 96 * 96 * 3 / 4);
    const Grid<float>& is_traced = map_of(result, "Explicit");
    for (int y = 1; y < 95; ++y) {
        for (int x = 1; x < 95; ++x) {
            const auto object = static_cast<std::size_t>(frame.object_id(x, y));
            const bool is_lamp = scene.materials[scene.objects[object].material].emission.x > 0;
            const bool is_silhouette = frame.object_id(x, y) != frame.object_id(x + 1, y) ||
                                       frame.object_id(x, y) != frame.object_id(x, y + 1);
            if (is_lamp || is_silhouette) REQUIRE(is_traced(x, y) == 1);
        }
    }
    MethodRequest truth = request;
    truth.settings.spp = 2048;
    const Image reference = render(scene, truth.settings).frame.radiance;
    const double path = error_against(render(scene, request.settings).frame.radiance, reference);
    CHECK(error_against(frame.radiance, reference) < 4 * path);
}

TEST_CASE("a tolerance of nothing and no noise to hide it make adaptive trace", "[methods]") {
    const Scene scene = repository_scene("cornell_sphere");
    MethodRequest request = request_of(scene, {40, 40}, 64);
    const double loose = render_by("adaptive", request).facts["traced_share"];
    request.parameters.tolerance = 0;
    const double strict = render_by("adaptive", request).facts["traced_share"];
    request.parameters.tolerance = 1e6f;
    request.parameters.correction = false;
    const double blind = render_by("adaptive", request).facts["traced_share"];
    CHECK(strict > loose);
    CHECK(blind < loose);
    request.parameters.coarse_step = 1;
    CHECK(render_by("adaptive", request).facts["traced_share"] == 1.0);
}

TEST_CASE("adaptive renders images of any size", "[methods]") {
    const Scene scene = repository_scene("cornell_sphere");
    for (const Extent size :
         {Extent{1, 1}, Extent{1, 13}, Extent{13, 1}, Extent{3, 2}, Extent{17, 9}, Extent{16, 8}}) {
        CAPTURE(size.width, size.height);
        const MethodRequest request = request_of(scene, size, 4);
        const MethodRender result = render_by("adaptive", request);
        CHECK(std::ranges::count(map_of(result, "Calculated").values(), 0.0f) == 0);
        (void)require_paths_kept(result.render.frame, request);
    }
}
