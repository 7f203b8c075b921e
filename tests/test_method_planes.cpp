// SPDX-License-Identifier: Apache-2.0
//
// What holds for every method that traces some pixels and makes others of these.
#include <glm/geometric.hpp>

#include "core/frame_planes.h"
#include "tests/method_frames.h"

using namespace vecino;
using namespace vecino::test;

namespace {

constexpr const char* kPlans[] = {"interleaved", "adaptive", "reuse", "variation"};

/// Every part of a scene: a miss beside objects, a lamp, a mirror.
Scene open_scene() {
    return scene_from(R"({
        "camera": {"position": [0, 1, 4], "look_at": [0, 0.5, 0], "up": [0, 1, 0],
                   "vertical_fov_degrees": 40},
        "materials": {"grey": {"albedo": [0.5, 0.5, 0.5]}, "mirror": {"albedo": [0.9, 0.9, 0.9],
                      "mirror": true}, "lamp": {"emission": [5, 5, 5]}},
        "objects": [{"quad": [[-2, 0, 2], [2, 0, 2], [2, 0, -2], [-2, 0, -2]], "material": "grey"},
                    {"sphere": {"center": [0.5, 0.5, 0], "radius": 0.5}, "material": "mirror"},
                    {"sphere": {"center": [-1, 1, 0], "radius": 0.2}, "material": "lamp"}],
        "background": [0.2, 0.3, 0.4]})");
}

}  // namespace

TEST_CASE("methods make the planes that were asked for", "[methods]") {
    const Scene scene = open_scene();
    const Planes sets[] = {{}, {Plane::normal, Plane::variance}, Planes::all()};
    for (const char* method : kPlans) {
        for (const Planes& planes : sets) {
            MethodRequest request = request_of(scene, {20, 15}, 8);
            request.settings.planes = planes;
            Planes made = planes;
            made.add(Plane::radiance);
            INFO(method);
            const Frame frame = render_by(method, request).render.frame;
            CHECK(planes_of(frame) == made);
        }
    }
}

TEST_CASE("methods give planes of first hits as path tracing does", "[methods]") {
    const Scene scene = open_scene();
    for (const char* method : kPlans) {
        for (const FirstHit first_hit : {FirstHit::first_sample, FirstHit::centre}) {
            INFO(method);
            MethodRequest request = request_of(scene, {24, 18}, 8);
            request.settings.first_hit = first_hit;
            request.settings.planes.add(kMeanPlanes);
            const Frame path = render(scene, request.settings).frame;
            const Frame frame = render_by(method, request).render.frame;
            CHECK(frame.object_id == path.object_id);
            CHECK(frame.position_world == path.position_world);
            CHECK(frame.albedo == path.albedo);
            // No method stopped at fewer samples here.
            CHECK(frame.albedo_mean == path.albedo_mean);
            CHECK(frame.normal_world_mean == path.normal_world_mean);
        }
    }
}

TEST_CASE("what does not follow from its neighbours is traced", "[methods]") {
    const Scene scene = open_scene();
    for (const char* method : {"adaptive", "reuse"}) {
        INFO(method);
        MethodRequest request = request_of(scene, {64, 48}, 16);
        request.settings.first_hit = FirstHit::centre;
        const Frame frame = render_by(method, request).render.frame;
        std::size_t misses_made = 0;
        for (std::size_t i = 0; i < frame.object_id.values().size(); ++i) {
            const bool is_traced = frame.sample_count.values()[i] > 0;
            if (frame.object_id.values()[i] >= 1) REQUIRE(is_traced);  // mirror and lamp
            if (is_traced || frame.object_id.values()[i] != kMiss) continue;
            ++misses_made;
            const glm::vec3 background(0.2f, 0.3f, 0.4f);
            REQUIRE(glm::distance(frame.radiance.values()[i], background) < 1e-6f);
        }
        CHECK(misses_made > 100);
        (void)require_paths_kept(frame, request);
    }
}

TEST_CASE("methods render images of any size", "[methods]") {
    const Scene scene = open_scene();
    for (const char* method : kPlans) {
        for (const Extent size : {Extent{1, 1}, Extent{1, 13}, Extent{13, 1}, Extent{7, 5}}) {
            for (const int spp : {4, 5}) {
                CAPTURE(method, size.width, size.height, spp);
                MethodRequest request = request_of(scene, size, spp);
                request.parameters.step = 2;
                const MethodRender result = render_by(method, request);
                CHECK(result.render.frame.size() == size);
                for (const glm::vec3& value : result.render.frame.radiance.values())
                    CHECK(is_finite(value));
            }
        }
    }
}

TEST_CASE("methods count the rays that they trace", "[methods]") {
    const Scene scene = open_scene();
    MethodRequest request = request_of(scene, {24, 18}, 8);
    request.settings.planes = {};
    const RenderStatistics path = render(scene, request.settings).statistics;
    // Nothing is reused: all of path tracing, and a ray through the centre of every pixel.
    request.parameters.radius = 0;
    const RenderStatistics all = render_by("reuse", request).render.statistics;
    CHECK(all.samples == path.samples);
    CHECK(all.rays == path.rays + 24 * 18);
    request.parameters.radius = 2;
    const MethodRender some = render_by("reuse", request);
    CHECK(some.render.statistics.rays < path.rays);
    CHECK(some.facts["mean_spp"].get<double>() * 24 * 18 ==
          Approx(static_cast<double>(some.render.statistics.samples)));
}
