// SPDX-License-Identifier: Apache-2.0
//
// Quads in one plane: what is hit is defined, and depends on no packet width, thread or order.
#include <cmath>
#include <numbers>

#include "core/overlays.h"
#include "tests/catch.h"
#include "tests/scene_text.h"

using namespace vecino;
using namespace vecino::test;

namespace {

/// A square of a plane, which goes through (0, 0, 0) upright to the view or leans away from it.
std::string square(double half_side, bool leans, const std::string& material) {
    std::string corners;
    constexpr int kCorners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};
    for (const auto& [x, y] : kCorners) {
        corners += (corners.empty() ? "[" : ", [") + std::to_string(x * half_side) + ", " +
                   std::to_string(y * half_side) + ", " +
                   std::to_string(leans ? (0.3 * x + 0.2 * y) * half_side : 0.0) + "]";
    }
    return R"({"quad": [)" + corners + R"(], "material": ")" + material + R"("})";
}

/// Objects of a plane, which the camera sees from a distance in front.
Scene plane_of(const std::string& objects, double distance = 5) {
    const double degrees = 2 * std::atan(1 / distance) * 180 / std::numbers::pi;
    return scene_from(R"({"camera": {"position": [0, 0, )" + std::to_string(distance) +
                      R"(], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": )" +
                      std::to_string(degrees) + R"(},
        "materials": {"ceiling": {"albedo": [0.7, 0.7, 0.7]}, "tile": {"albedo": [0.2, 0.2, 0.2]},
                      "lamp": {"emission": [15, 15, 15]}},
        "objects": [)" +
                      objects + R"(], "background": [0.2, 0.2, 0.2]})");
}

RenderSettings settings_of(int width, int threads) {
    RenderSettings settings = small_settings({48, 48}, 16);
    settings.simd_width = width;
    settings.threads = threads;
    settings.max_depth = 1;
    return settings;
}

/// The pixels in the middle quarter of each side, and none else; some more or less where it leans.
void check_middle(const Frame& frame, int inside, int outside) {
    for (int y = 0; y < 48; ++y) {
        for (int x = 0; x < 48; ++x) {
            const int from_edge = std::max(std::abs(2 * x - 47), std::abs(2 * y - 47));
            CAPTURE(x, y);
            if (from_edge < 8) CHECK(frame.object_id(x, y) == inside);
            if (from_edge > 18) CHECK(frame.object_id(x, y) == outside);
        }
    }
}

}  // namespace

TEST_CASE("a lamp in the plane of its ceiling is seen, wherever the file names it", "[coplanar]") {
    const bool is_first = GENERATE(true, false);
    const bool leans = GENERATE(false, true);
    const double distance = GENERATE(3.0, 20.0, 1000.0);
    CAPTURE(is_first, leans, distance);
    const std::string lamp = square(0.25, leans, "lamp");
    const std::string ceiling = square(1.6, leans, "ceiling");
    const Scene scene = plane_of(is_first ? lamp + "," + ceiling : ceiling + "," + lamp, distance);
    const Frame expected = render(scene, settings_of(1, 1)).frame;
    check_middle(expected, is_first ? 0 : 1, is_first ? 1 : 0);
    CHECK(expected.radiance(24, 24) == glm::vec3(15));
    CHECK(expected.radiance(3, 3).x == Approx(0.14));
    for (const int width : simd_widths()) {
        for (const int threads : {1, 2}) {
            CAPTURE(width, threads);
            const Frame frame = render(scene, settings_of(width, threads)).frame;
            CHECK(frame.object_id == expected.object_id);
            CHECK(frame.radiance == expected.radiance);
        }
    }
}

TEST_CASE("of quads in one plane that emit nothing the last is seen", "[coplanar]") {
    const int width = GENERATE(from_range(simd_widths()));
    const bool leans = GENERATE(false, true);
    CAPTURE(width, leans);
    const auto frame_of = [&](const std::string& objects) {
        return render(plane_of(objects), settings_of(width, 0)).frame;
    };
    const std::string tile = square(0.25, leans, "tile");
    const std::string ceiling = square(1.6, leans, "ceiling");
    check_middle(frame_of(ceiling + "," + tile), 1, 0);
    check_middle(frame_of(tile + "," + ceiling), 1, 1);
    check_middle(frame_of(tile + "," + ceiling + "," + tile), 2, 1);
}

TEST_CASE("neighbours in one plane are no overlays, and those in others are none", "[coplanar]") {
    using Corners = std::array<glm::vec3, 4>;
    const auto rectangle = [](float x, float z) {
        return Corners{{{x, 0, z}, {x + 1, 0, z}, {x + 1, 1, z}, {x, 1, z}}};
    };
    const auto overlays = [](const std::vector<Corners>& corners) {
        std::vector<ParallelogramShape> shapes;
        for (const Corners& each : corners) shapes.push_back(parallelogram_shape(each));
        return find_overlays(corners, shapes);
    };
    CHECK(overlays({rectangle(0, 0), rectangle(1, 0), rectangle(0, 0.001f)}).empty());
    const auto found = overlays({rectangle(0, 0), rectangle(0.5f, 0), rectangle(1, 0)});
    CHECK(found == std::vector<std::vector<unsigned>>{{1}, {2}, {}});
}

TEST_CASE("bounces find as much of a lamp in its ceiling's plane as next-event estimation does",
          "[coplanar]") {
    const Scene scene = scene_from(
        R"({"camera": {"position": [0, 0.5, 0], "look_at": [0, 0, 0], "up": [0, 0, 1], "vertical_fov_degrees": 90},
        "materials": {"grey": {"albedo": [0.5, 0.5, 0.5]}, "lamp": {"emission": [4, 4, 4]}},
        "objects": [{"quad": [[-0.5,1,-0.5],[0.5,1,-0.5],[0.5,1,0.5],[-0.5,1,0.5]], "material": "lamp"},
                    {"quad": [[-1,1,-1],[1,1,-1],[1,1,1],[-1,1,1]], "material": "grey"},
                    {"quad": [[-1,0,-1],[-1,0,1],[1,0,1],[1,0,-1]], "material": "grey"}]})");
    RenderSettings settings = small_settings({8, 8}, 4096);
    settings.max_depth = 1;
    const double by_estimation = mean_of(render(scene, settings).frame.radiance).x;
    settings.light_sampling = LightSampling::none;
    CHECK(by_estimation > 0.1);
    CHECK(mean_of(render(scene, settings).frame.radiance).x == Approx(by_estimation).epsilon(0.01));
}
