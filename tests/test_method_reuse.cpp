// SPDX-License-Identifier: Apache-2.0
//
// Reuse of traced pixels whose hits are near.
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "tests/method_frames.h"

using namespace vecino;
using namespace vecino::test;

TEST_CASE("a radius of 0 reuses nothing: path tracing, bit for bit", "[methods]") {
    const Scene scene = repository_scene("cornell_sphere");
    MethodRequest request = request_of(scene, {23, 17}, 8);
    request.parameters.radius = 0;
    const MethodRender result = render_by("reuse", request);
    const Frame path = render(scene, request.settings).frame;
    CHECK(result.render.frame.radiance == path.radiance);
    CHECK(result.render.frame.variance == path.variance);
    CHECK(result.render.frame.position_world == path.position_world);
    CHECK(result.facts["traced_share"] == 1.0);
}

TEST_CASE("a reused colour is that of a traced hit within the radius", "[methods]") {
    const Scene scene = repository_scene("cornell_sphere");
    MethodRequest request = request_of(scene, {48, 48}, 8);
    request.settings.first_hit = FirstHit::centre;
    request.parameters.reused = Reused::nearest;
    for (const float radius : {1.0f, 2.5f}) {
        request.parameters.radius = radius;
        const MethodRender result = render_by("reuse", request);
        const Frame& frame = result.render.frame;
        const std::size_t traced = require_paths_kept(frame, request);
        CHECK(traced < 48 * 48);
        const float pixel = 2 * std::tan(glm::radians(scene.camera.vertical_fov_degrees) / 2) / 48;
        const int reach = 3;
        for (int y = 0; y < 48; ++y) {
            for (int x = 0; x < 48; ++x) {
                if (frame.sample_count(x, y) != 0) continue;
                bool found = false;
                for (int v = std::max(y - reach, 0); v <= std::min(y + reach, 47); ++v) {
                    for (int u = std::max(x - reach, 0); u <= std::min(x + reach, 47); ++u) {
                        const float d =
                            glm::distance(frame.position_world(x, y), frame.position_world(u, v));
                        const bool is_near =
                            d <= radius * pixel * frame.distance_world(x, y) * 1.0001f;
                        found = found ||
                                (frame.sample_count(u, v) != 0 && is_near &&
                                 frame.object_id(u, v) == frame.object_id(x, y) &&
                                 glm::distance(frame.radiance(u, v), frame.radiance(x, y)) < 1e-5f);
                    }
                }
                REQUIRE(found);
            }
        }
    }
}

TEST_CASE("a larger radius traces less, and the mean is less noisy than the nearest", "[methods]") {
    const Scene scene = repository_scene("cornell");
    MethodRequest request = request_of(scene, {64, 64}, 4);
    const double two = render_by("reuse", request).facts["traced_share"];
    request.parameters.radius = 4;
    request.parameters.reused = Reused::nearest;
    const MethodRender nearest = render_by("reuse", request);
    CHECK(nearest.facts["traced_share"] < two);
    request.parameters.reused = Reused::mean;
    request.parameters.weighting = Weighting::gaussian;
    const MethodRender mean = render_by("reuse", request);
    CHECK(mean.facts == nearest.facts);
    MethodRequest truth = request;
    truth.settings.spp = 1024;
    const Image reference = render(scene, truth.settings).frame.radiance;
    CHECK(error_against(mean.render.frame.radiance, reference) <
          error_against(nearest.render.frame.radiance, reference));
}
