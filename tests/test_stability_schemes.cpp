// SPDX-License-Identifier: Apache-2.0
//
// What must not change a result: the unit of length, and which way up the image is. Over every row
// of the tables of schemes and of render methods, so that a new one is tested at once.
#include <glm/common.hpp>
#include <utility>

#include "filters/methods.h"
#include "tests/catch.h"
#include "tests/scene_text.h"
#include "tests/scheme_cells.h"

using namespace vecino;
using namespace vecino::test;

namespace {

/// What stands at from(x, y) of a grid, at (x, y) of one of another size.
template <class T, class From>
Grid<T> rearranged(const Grid<T>& grid, Extent size, From from) {
    Grid<T> result(size);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            const auto [u, v] = from(x, y);
            result(x, y) = grid(u, v);
        }
    }
    return result;
}

template <class From>
Frame rearranged(const Frame& frame, Extent size, From from) {
    Frame result;
    result.radiance = rearranged(frame.radiance, size, from);
    result.position_world = rearranged(frame.position_world, size, from);
    result.normal_world = rearranged(frame.normal_world, size, from);
    result.object_id = rearranged(frame.object_id, size, from);
    return result;
}

Extent turned(Extent size) {
    return {size.height, size.width};
}

/// A low-resolution size and a full one, no full pixel's centre on a border of low pixels.
struct Sizes {
    Extent low, full;
};

bool has_tie(int full, int low) {
    for (int x = 0; x < full; ++x)
        if ((2LL * x + 1) * low % (2LL * full) == 0) return true;
    return false;
}

void scale(Scene& scene, float factor) {
    scene.camera.position_world *= factor;
    scene.camera.look_at_world *= factor;
    for (Object& object : scene.objects) {
        if (auto* const quad = std::get_if<Quad>(&object.shape)) {
            for (glm::vec3& corner : quad->corners_world) corner *= factor;
        } else if (auto* const sphere = std::get_if<Sphere>(&object.shape)) {
            sphere->center_world *= factor;
            sphere->radius *= factor;
        } else {
            for (glm::vec3& p : std::get<TriangleMesh>(object.shape).positions_world) p *= factor;
        }
    }
}

/// The Cornell box with a sphere that is a mirror, a crooked wall and a textured back wall: shapes
/// and materials of every kind.
Scene varied_scene() {
    Scene scene = repository_scene("cornell_sphere");
    auto texture = std::make_shared<Texture>();
    texture->texels = Image({4, 4});
    for (int i = 0; i < 16; ++i)
        texture->texels.values()[static_cast<std::size_t>(i)] = glm::vec3(i % 3 == 0 ? 0.7f : 0.2f);
    scene.materials.push_back({.name = "picture", .albedo_texture = texture});
    scene.materials.push_back({.name = "mirror", .albedo = glm::vec3(0.8f), .mirror = true});
    for (Object& object : scene.objects) {
        if (std::holds_alternative<Sphere>(object.shape))
            object.material = scene.materials.size() - 1;
    }
    scene.objects.push_back({Quad{{{{-0.9f, 0.2f, -0.9f},
                                    {0.5f, 0.2f, -0.9f},
                                    {0.6f, 1.7f, -0.8f},
                                    {-0.8f, 1.5f, -0.9f}}}},
                             scene.materials.size() - 2});
    return scene;
}

MethodRender rendered(const Method& method, const Scene& scene) {
    RenderSettings settings = small_settings({33, 27}, 16);
    settings.planes = Planes::all();
    settings.sampler = Sampler::sobol;
    return render(method, {scene, settings, {}});
}

}  // namespace

TEST_CASE("a thousand times the unit of length changes rounding alone", "[stability]") {
    const float factor = GENERATE(1000.0f, 0.001f);
    const Frame low = random_frame({23, 17}, FrameContent::awkward);
    Frame scaled = low;
    for (glm::vec3& p : scaled.position_world.values()) p *= factor;
    for_each_cell(5, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        const Reconstruction expected = rebuild(low, scheme, parameters, {47, 35});
        const Reconstruction result = rebuild(scaled, scheme, parameters, {47, 35});
        CHECK(relative_difference(result.image, expected.image) <= 2e-5);
        CHECK(result.fallback_pixels == expected.fallback_pixels);
    });
}

TEST_CASE("1,024 times the unit of length changes no bit of any render", "[stability]") {
    const float factor = GENERATE(1024.0f, 1.0f / 1024.0f);
    const Scene scene = varied_scene();
    Scene scaled = scene;
    scale(scaled, factor);
    for (const Method& method : all_methods()) {
        INFO(method.name);
        const Frame here = rendered(method, scene).render.frame;
        const Frame there = rendered(method, scaled).render.frame;
        CHECK(same_bits(there.radiance, here.radiance));
        CHECK(there.object_id == here.object_id);
        CHECK(same_bits(there.albedo, here.albedo));
        Grid<glm::vec3> positions = here.position_world;
        for (glm::vec3& p : positions.values()) p *= factor;
        CHECK(same_bits(there.position_world, positions));
    }
}

TEST_CASE("a thousand times the unit of length changes no render visibly", "[stability]") {
    const Scene scene = varied_scene();
    Scene scaled = scene;
    scale(scaled, 1000.0f);
    for (const Method& method : all_methods()) {
        INFO(method.name);
        const Image here = rendered(method, scene).render.frame.radiance;
        const Image there = rendered(method, scaled).render.frame.radiance;
        const glm::dvec3 mean = mean_of(here);
        CHECK(mean_of(there).x == Approx(mean.x).epsilon(3e-3));
        int changed = 0;  // where rounding takes a ray past another edge, all of its path differs
        for (std::size_t i = 0; i < here.values().size(); ++i) {
            const glm::vec3 d = glm::abs(there.values()[i] - here.values()[i]);
            changed += std::max({d.x, d.y, d.z}) > 1e-3f * (1.0f + here.values()[i].x) ? 1 : 0;
        }
        CHECK(changed <= static_cast<int>(here.values().size()) / 50);
    }
}

/// Random colours on a plane that faces the camera.
Frame plane_frame(Extent size) {
    Frame frame = random_frame(size, FrameContent::benign);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            frame.position_world(x, y) = {0.5f * static_cast<float>(2 * x + 1 - size.width),
                                          0.5f * static_cast<float>(2 * y + 1 - size.height), 0};
            frame.normal_world(x, y) = {0, 0, 1};
        }
    }
    return frame;
}

TEST_CASE("a turned or mirrored frame gives the turned or mirrored image, at every factor",
          "[stability]") {
    const Sizes sizes = GENERATE(values<Sizes>({{{20, 14}, {40, 28}},   // factor 2
                                                {{20, 14}, {60, 42}},   // 3
                                                {{20, 14}, {80, 56}},   // 4
                                                {{11, 7}, {66, 42}},    // 6
                                                {{21, 15}, {43, 31}},   // as near to 2 as it goes
                                                {{13, 9}, {40, 29}},    // to 3
                                                {{5, 3}, {32, 20}}}));  // to 6
    CAPTURE(sizes.full.width, sizes.full.height);
    REQUIRE_FALSE(has_tie(sizes.full.width, sizes.low.width));
    REQUIRE_FALSE(has_tie(sizes.full.height, sizes.low.height));
    const Frame awkward = random_frame(sizes.low, FrameContent::awkward);
    const Frame flat = plane_frame(sizes.low);
    for_each_cell(5, [&](const Scheme& scheme, const SchemeParameters& parameters) {
        // Where hits lie anyhow there are no surfaces, which is what schemes with a guide look for.
        const Frame& low = scheme.uses_guide() ? flat : awkward;
        const Reconstruction expected = rebuild(low, scheme, parameters, sizes.full);
        const auto commutes = [&](Extent low_size, Extent full_size, auto from_low,
                                  auto from_full) {
            const Frame moved = rearranged(low, low_size, from_low);
            const Reconstruction result = rebuild(moved, scheme, parameters, full_size);
            const Image wanted = rearranged(expected.image, full_size, from_full);
            // Neighbours are added up in another order.
            CHECK(relative_difference(result.image, wanted) <= 1e-6);
            CHECK(result.fallback_pixels == expected.fallback_pixels);
            CHECK(result.dropped_samples == expected.dropped_samples);
        };
        const auto transposed = [](int x, int y) { return std::pair(y, x); };
        const auto mirrored = [](Extent size) {
            return [size](int x, int y) { return std::pair(size.width - 1 - x, y); };
        };
        const auto upside_down = [](Extent size) {
            return [size](int x, int y) { return std::pair(x, size.height - 1 - y); };
        };
        commutes(turned(sizes.low), turned(sizes.full), transposed, transposed);
        commutes(sizes.low, sizes.full, mirrored(sizes.low), mirrored(sizes.full));
        commutes(sizes.low, sizes.full, upside_down(sizes.low), upside_down(sizes.full));
    });
}
