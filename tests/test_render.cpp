// SPDX-License-Identifier: Apache-2.0
//
// The planes of a frame, and what a render may and may not depend on.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "core/error.h"
#include "tests/catch.h"
#include "tests/scene_text.h"

using namespace vecino;
using namespace vecino::test;

namespace {

bool equal_bits(const Frame& a, const Frame& b) {
    for (const PlaneInfo& info : all_planes()) {
        if (!std::visit([&](auto member) { return a.*member == b.*member; }, info.member))
            return false;
    }
    return true;
}

/// Where a point stands in an image of cornell's camera, in pixels.
glm::dvec2 project(const Camera& camera, glm::dvec3 point, Extent size) {
    const glm::dvec3 forward =
        glm::normalize(glm::dvec3(camera.look_at_world) - glm::dvec3(camera.position_world));
    const glm::dvec3 right = glm::normalize(glm::cross(forward, glm::dvec3(camera.up_world)));
    const glm::dvec3 up = glm::cross(right, forward);
    const glm::dvec3 d = point - glm::dvec3(camera.position_world);
    const double half =
        std::tan(0.5 * static_cast<double>(camera.vertical_fov_degrees) * 3.14159265358979 / 180);
    const double aspect = static_cast<double>(size.width) / size.height;
    const double depth = glm::dot(d, forward);
    return {(glm::dot(d, right) / (depth * half * aspect) + 1) / 2 * size.width,
            (1 - glm::dot(d, up) / (depth * half)) / 2 * size.height};
}

struct NearestPoint {
    double distance = 1e30;
    glm::dvec3 normal{0.0};
};

/// Distance to a triangle's plane where the point stands over the triangle, else to nothing.
void approach_triangle(const std::array<glm::vec3, 3>& corners, glm::dvec3 p,
                       NearestPoint& nearest) {
    const glm::dvec3 a = corners[0], b = corners[1], c = corners[2];
    const glm::dvec3 cross = glm::cross(b - a, c - a);
    const glm::dvec3 n = glm::normalize(cross);
    const double area = glm::length(cross);
    const double u = glm::dot(glm::cross(c - b, p - b), n) / area;
    const double v = glm::dot(glm::cross(a - c, p - c), n) / area;
    const double w = glm::dot(glm::cross(b - a, p - a), n) / area;
    const double distance = std::abs(glm::dot(p - a, n));
    if (std::min({u, v, w}) > -1e-4 && distance < nearest.distance) nearest = {distance, n};
}

NearestPoint nearest_on(const Object& object, glm::dvec3 p) {
    NearestPoint nearest;
    if (const auto* const sphere = std::get_if<Sphere>(&object.shape)) {
        const glm::dvec3 out = p - glm::dvec3(sphere->center_world);
        return {std::abs(glm::length(out) - static_cast<double>(sphere->radius)),
                glm::normalize(out)};
    }
    if (const auto* const quad = std::get_if<Quad>(&object.shape)) {
        const auto& q = quad->corners_world;
        approach_triangle({q[0], q[1], q[2]}, p, nearest);
        approach_triangle({q[0], q[2], q[3]}, p, nearest);
        return nearest;
    }
    const auto& mesh = std::get<TriangleMesh>(object.shape);
    for (const auto& t : mesh.indices) {
        const auto& at = mesh.positions_world;
        approach_triangle({at[t[0]], at[t[1]], at[t[2]]}, p, nearest);
    }
    return nearest;
}

}  // namespace

TEST_CASE("a render has the same bits with 1, 2 and 7 threads", "[render]") {
    const Scene scene = repository_scene("cornell_sphere");
    RenderSettings settings = small_settings({37, 23}, 33);
    settings.sampler = GENERATE(Sampler::independent, Sampler::sobol);
    settings.light_sampling = GENERATE(LightSampling::none, LightSampling::nee);
    settings.threads = 1;
    const Frame one = render(scene, settings).frame;
    settings.threads = 2;
    CHECK(equal_bits(one, render(scene, settings).frame));
    settings.threads = 7;
    CHECK(equal_bits(one, render(scene, settings).frame));
}

TEST_CASE("means of first hits are those of the pixel's samples", "[render]") {
    const Scene scene = repository_scene("cornell_sphere");
    RenderSettings settings = small_settings({16, 16}, 1);
    settings.planes = {Plane::albedo, Plane::normal, Plane::id, Plane::albedo_mean,
                       Plane::normal_mean};
    const Frame one = render(scene, settings).frame;
    CHECK(one.albedo_mean == one.albedo);
    CHECK(one.normal_world_mean == one.normal_world);
    settings.spp = 200;
    settings.threads = 2;
    const Frame many = render(scene, settings).frame;
    // Inside the back wall every sample hits the same; on the sphere's edge they differ.
    CHECK(length(many.normal_world_mean(8, 4) - glm::vec3(0, 0, 1)) < 1e-6f);
    CHECK(length(many.albedo_mean(8, 4) - many.albedo(8, 4)) < 1e-6f);
    std::size_t mixed = 0;
    for (const glm::vec3& normal : many.normal_world_mean.values()) {
        CHECK(length(normal) < 1.0001f);
        mixed += length(normal) < 0.9f ? 1 : 0;
    }
    CHECK(mixed > 10);
    settings.threads = 7;
    const Frame again = render(scene, settings).frame;
    CHECK(again.albedo_mean == many.albedo_mean);
    CHECK(again.normal_world_mean == many.normal_world_mean);
}

TEST_CASE("radiance has the same bits whatever other planes are asked for", "[render]") {
    const Scene scene = repository_scene("cornell");
    RenderSettings settings = small_settings({16, 16}, 100);
    settings.sampler = Sampler::independent;
    const Frame all = render(scene, settings).frame;
    settings.planes = {Plane::radiance};
    const Frame alone = render(scene, settings).frame;
    CHECK(all.radiance == alone.radiance);
    CHECK(planes_of(alone) == Planes{Plane::radiance});
    CHECK(planes_of(all) == Planes::all());
    settings.sampler = Sampler::sobol;  // here the variance plane alone may change it
    const Frame sobol = render(scene, settings).frame;
    settings.planes = {Plane::radiance, Plane::direct, Plane::position, Plane::id, Plane::count};
    CHECK(render(scene, settings).frame.radiance == sobol.radiance);
}

TEST_CASE("Sobol samples err less than independent ones", "[render]") {
    const Scene scene = repository_scene("cornell");
    RenderSettings settings = small_settings({24, 24}, 4096);
    settings.planes = {Plane::radiance};
    settings.seed = 99;
    const Image reference = render(scene, settings).frame.radiance;
    const auto error = [&](Sampler sampler) {
        settings.sampler = sampler;
        settings.spp = 64;
        settings.seed = 1;
        const Image image = render(scene, settings).frame.radiance;
        double sum = 0;
        for (std::size_t i = 0; i < image.values().size(); ++i) {
            const glm::dvec3 d = image.values()[i] - reference.values()[i];
            sum += glm::dot(d, d);
        }
        return sum;
    };
    CHECK(error(Sampler::sobol) < 0.4 * error(Sampler::independent));
}

TEST_CASE("packet widths agree", "[render]") {
    const Scene scene = repository_scene("cornell_sphere");
    RenderSettings settings = small_settings({32, 32}, 256);
    const int width = GENERATE(from_range(simd_widths()));
    CAPTURE(width);
    settings.simd_width = 4;
    const Render narrow = render(scene, settings);
    settings.simd_width = width;
    const Render wide = render(scene, settings);
    CHECK(wide.statistics.simd_width == width);
    const glm::dvec3 a = mean_of(narrow.frame.radiance);
    const glm::dvec3 b = mean_of(wide.frame.radiance);
    for (int c = 0; c < 3; ++c) CHECK(a[c] == Approx(b[c]).epsilon(1e-3));
}

TEST_CASE("radiance is the sum of emission, direct and indirect light", "[render]") {
    const Scene scene = repository_scene("cornell");
    RenderSettings settings = small_settings({32, 32}, 64);
    settings.max_depth = 3;
    const Frame deep = render(scene, settings).frame;
    for (std::size_t i = 0; i < deep.radiance.values().size(); ++i) {
        CHECK(deep.radiance.values()[i] ==
              deep.emission.values()[i] + deep.direct.values()[i] + deep.indirect.values()[i]);
    }
    CHECK(mean_of(deep.emission).x > 0.1);
    CHECK(mean_of(deep.indirect).x > 0.01);
    settings.max_depth = 1;
    const Frame direct_only = render(scene, settings).frame;
    CHECK(direct_only.direct == deep.direct);
    CHECK(mean_of(direct_only.indirect).x == 0.0);
    settings.max_depth = 0;
    const Frame emission_only = render(scene, settings).frame;
    CHECK(emission_only.emission == deep.emission);
    CHECK(mean_of(emission_only.direct).x == 0.0);
}

TEST_CASE("first hits lie on the surface of their object and in their own pixel", "[render]") {
    const Scene scene = repository_scene(GENERATE("cornell", "cornell_sphere", "illustration_16"));
    RenderSettings settings = small_settings({96, 64}, 1);
    settings.first_hit = GENERATE(FirstHit::first_sample, FirstHit::centre);
    const Frame frame = render(scene, settings).frame;
    const double jitter = settings.first_hit == FirstHit::centre ? 1e-3 : 0.5 + 1e-3;
    int misses = 0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 96; ++x) {
            if (frame.object_id(x, y) == kMiss) {
                ++misses;
                CHECK(frame.position_world(x, y) == glm::vec3(0.0f));
                CHECK(frame.normal_world(x, y) == glm::vec3(0.0f));
                CHECK(frame.albedo(x, y) == glm::vec3(0.0f));
                CHECK(frame.distance_world(x, y) == 0.0f);
                continue;
            }
            const auto id = static_cast<std::size_t>(frame.object_id(x, y));
            REQUIRE(id < scene.objects.size());
            const glm::dvec3 p = frame.position_world(x, y);
            const glm::dvec3 n = frame.normal_world(x, y);
            const NearestPoint nearest = nearest_on(scene.objects[id], p);
            CHECK(nearest.distance < 1e-5);
            CHECK(std::abs(glm::dot(n, nearest.normal)) == Approx(1.0).epsilon(1e-4));
            const glm::dvec3 to_camera = glm::dvec3(scene.camera.position_world) - p;
            CHECK(glm::dot(n, to_camera) > 0);
            CHECK(glm::length(to_camera) ==
                  Approx(static_cast<double>(frame.distance_world(x, y))).epsilon(1e-5));
            CHECK(frame.albedo(x, y) == scene.materials[scene.objects[id].material].albedo);
            const glm::dvec2 at = project(scene.camera, p, {96, 64});
            CHECK(std::abs(at.x - (x + 0.5)) <= jitter);
            CHECK(std::abs(at.y - (y + 0.5)) <= jitter);
        }
    }
    CHECK(misses > 0);  // 96x64 sees past the sides of the box
}

TEST_CASE("the first hit is that of the first sample, whatever comes after", "[render]") {
    const Scene scene = repository_scene("cornell_sphere");
    RenderSettings settings = small_settings({24, 24}, 1);
    const Frame one = render(scene, settings).frame;
    settings.spp = 65;
    const Frame many = render(scene, settings).frame;
    CHECK(one.position_world == many.position_world);
    CHECK(one.object_id == many.object_id);
}

TEST_CASE("the variance plane is the variance of the pixel mean", "[render][slow]") {
    const Scene scene = repository_scene("cornell_sphere");
    const Sampler sampler = GENERATE(Sampler::independent, Sampler::sobol);
    const int spp = GENERATE(6, 64);
    CAPTURE(static_cast<int>(sampler), spp);
    RenderSettings settings = small_settings({12, 12}, spp);
    settings.sampler = sampler;
    constexpr int kSeeds = 200;
    std::vector<glm::dvec3> sum(144, glm::dvec3(0.0)), squares = sum;
    double stated = 0;
    for (int seed = 1; seed <= kSeeds; ++seed) {
        settings.seed = static_cast<std::uint32_t>(seed);
        const Frame frame = render(scene, settings).frame;
        for (std::size_t i = 0; i < 144; ++i) {
            const glm::dvec3 value = frame.radiance.values()[i];
            sum[i] += value;
            squares[i] += value * value;
        }
        stated += mean_of(frame.variance).x / kSeeds;
    }
    double measured = 0;
    for (std::size_t i = 0; i < 144; ++i) {
        measured += (squares[i].x - sum[i].x * sum[i].x / kSeeds) / (kSeeds - 1) / 144.0;
    }
    CHECK(stated == Approx(measured).epsilon(0.1));
}

TEST_CASE("one sample has no variance plane", "[render]") {
    const Frame frame = render(repository_scene("cornell"), small_settings({4, 4}, 1)).frame;
    CHECK(frame.variance.empty());
    CHECK(frame.sample_count(2, 2) == 1.0f);
}

TEST_CASE("seeds decide the noise", "[render]") {
    const Scene scene = repository_scene("cornell");
    RenderSettings settings = small_settings({8, 8}, 4);
    settings.sampler = GENERATE(Sampler::independent, Sampler::sobol);
    const Frame a = render(scene, settings).frame;
    CHECK(a.radiance == render(scene, settings).frame.radiance);
    settings.seed = 2;
    CHECK_FALSE(a.radiance == render(scene, settings).frame.radiance);
}

TEST_CASE("a reduced frame sees what the full one sees", "[render]") {
    const Scene scene = repository_scene("cornell");
    RenderSettings settings = small_settings({512, 256}, 1);
    settings.reduction = 3;
    settings.first_hit = FirstHit::centre;
    const Frame low = render(scene, settings).frame;
    REQUIRE(low.size() == Extent{170, 85});
    const glm::dvec2 at = project(scene.camera, low.position_world(80, 40), {512, 256});
    CHECK(at.x == Approx((80.5) / 170 * 512).margin(1e-2));
    CHECK(at.y == Approx((40.5) / 85 * 256).margin(1e-2));
    settings.reduction = 1000;
    CHECK(render(scene, settings).frame.size() == Extent{1, 1});
}

TEST_CASE("the gradient pattern is Eq. 1 at the pixel centres", "[render]") {
    const Frame frame =
        render(repository_scene("illustration_9"), small_settings({8, 4}, 64)).frame;
    CHECK(frame.radiance(0, 0) == glm::vec3(0.0625f, 0.125f, 0.0f));
    CHECK(frame.radiance(7, 3) == glm::vec3(0.9375f, 0.875f, 0.0f));
    CHECK(frame.position_world(7, 3) == frame.radiance(7, 3));
    CHECK(frame.normal_world(3, 3) == glm::vec3(0, 0, 1));
    CHECK(frame.object_id(3, 3) == 0);
}

TEST_CASE("a scene without objects shows its background", "[render]") {
    const Scene scene = scene_from(R"({
        "camera": {"position": [0, 0, 1], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 40},
        "materials": {}, "objects": [], "background": [0.25, 0.5, 1]})");
    const Frame frame = render(scene, small_settings({4, 4}, 8)).frame;
    CHECK(frame.radiance(1, 1) == glm::vec3(0.25f, 0.5f, 1.0f));
    CHECK(frame.emission == frame.radiance);
    CHECK(frame.object_id(0, 0) == kMiss);
}

TEST_CASE("a render whose progress is refused stops as interrupted", "[render]") {
    try {
        render(repository_scene("cornell"), small_settings({64, 64}, 4),
               [](double) { return false; });
        FAIL("not stopped");
    } catch (const Error& error) {
        CHECK(error.code() == ExitCode::interrupted);
    }
}

TEST_CASE("progress rises to 1", "[render]") {
    double last = 0;
    RenderSettings settings = small_settings({64, 64}, 4);
    settings.threads = 1;
    render(repository_scene("cornell"), settings, [&](double done) {
        CHECK(done > last);
        last = done;
        return true;
    });
    CHECK(last == Approx(1.0));
}

TEST_CASE("settings out of range are refused by name", "[render]") {
    const Scene scene = repository_scene("cornell");
    RenderSettings settings = small_settings({4, 4}, 1);
    settings.spp = 0;
    CHECK_THROWS_WITH(render(scene, settings), "spp: found 0, allowed: 1 or more");
    settings = small_settings({0, 4}, 1);
    CHECK_THROWS_WITH(render(scene, settings), "size: width: found 0, allowed: 1 to 65536");
    settings = small_settings({4, 4}, 1);
    settings.simd_width = 5;
    CHECK_THROWS_AS(render(scene, settings), Error);
}
