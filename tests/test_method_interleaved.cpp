// SPDX-License-Identifier: Apache-2.0
//
// Interleaving of pixels and of samples.
#include <cmath>
#include <glm/geometric.hpp>

#include "core/error.h"
#include "core/frame_planes.h"
#include "tests/error_of.h"
#include "tests/method_frames.h"

using namespace vecino;
using namespace vecino::test;

namespace {

MethodRequest lattice_request(const Scene& scene, LatticeMask mask, int step) {
    MethodRequest request = request_of(scene, {25, 18}, 8);
    request.settings.planes.add(Plane::count);
    request.parameters.mask = mask;
    request.parameters.step = step;
    return request;
}

/// Whether all pixels within two of this one show one plane.
bool is_plain(const Frame& frame, Pixel at) {
    for (int v = at.y - 2; v <= at.y + 2; ++v) {
        for (int u = at.x - 2; u <= at.x + 2; ++u) {
            if (frame.object_id(u, v) != frame.object_id(at.x, at.y)) return false;
        }
    }
    return frame.albedo(at.x, at.y).y > 0;
}

}  // namespace

TEST_CASE("the pixels of a lattice keep the values of path tracing", "[methods]") {
    const Scene scene = repository_scene("cornell_sphere");
    for (const LatticeMask mask : {LatticeMask::square, LatticeMask::quincunx}) {
        for (const int step : {1, 2, 3}) {
            CAPTURE(int(mask), step);
            const MethodRequest request = lattice_request(scene, mask, step);
            const MethodRender result = render_by("interleaved", request);
            const Frame& frame = result.render.frame;
            std::size_t on_mask = 0;
            for (int y = 0; y < 18; y += step) {
                for (int x = 0; x < 25; x += step) {
                    if (mask == LatticeMask::quincunx && (x + y) / step % 2 != 0) continue;
                    CHECK(frame.sample_count(x, y) == 8);
                    ++on_mask;
                }
            }
            const std::size_t traced = require_paths_kept(frame, request);
            const auto fallback = result.facts["fallback_pixels"].get<std::size_t>();
            CHECK(traced == on_mask + fallback);
            CHECK(result.facts["traced_share"] == double(traced) / (25 * 18));
            CHECK(result.render.statistics.samples == traced * 8);
        }
    }
}

TEST_CASE("a pixel of a checkerboard is the weighted mean of the four around it", "[methods]") {
    const Scene scene = repository_scene("cornell");
    MethodRequest request = request_of(scene, {32, 32}, 16);
    request.parameters.mask = LatticeMask::quincunx;
    request.parameters.step = 1;
    request.settings.first_hit = FirstHit::centre;
    const Frame frame = render_by("interleaved", request).render.frame;
    int checked = 0;
    for (int y = 2; y < 30; ++y) {
        for (int x = 2; x < 30; ++x) {
            if (frame.sample_count(x, y) != 0 || !is_plain(frame, {x, y})) continue;
            const Pixel around[] = {{x, y - 1}, {x - 1, y}, {x + 1, y}, {x, y + 1}};
            const auto distance = [&](Pixel p) {
                return double(
                    glm::distance(frame.position_world(p.x, p.y), frame.position_world(x, y)));
            };
            double sum = 0, weights = 0, mean = 0;
            for (const Pixel& p : around) mean += distance(p) / 4;
            for (const Pixel& p : around) {
                const double weight = 1 / (distance(p) + 0.01 * mean);
                sum += weight * double(frame.radiance(p.x, p.y).y);
                weights += weight;
            }
            REQUIRE(double(frame.radiance(x, y).y) == Approx(sum / weights).epsilon(1e-4));
            ++checked;
        }
    }
    CHECK(checked > 100);
}

TEST_CASE("the thesis's kernel ignores objects, the kernel of surfaces does not", "[methods]") {
    // Two coplanar halves of different albedo: their normals are alike.
    const Scene scene = scene_from(R"({
        "camera": {"position": [0, 0, 2], "look_at": [0, 0, 0], "up": [0, 1, 0],
                   "vertical_fov_degrees": 40},
        "materials": {"dark": {"albedo": [0.1, 0.1, 0.1]}, "light": {"albedo": [0.9, 0.9, 0.9]}},
        "objects": [{"quad": [[-9, -9, 0], [0, -9, 0], [0, 9, 0], [-9, 9, 0]], "material": "dark"},
                    {"quad": [[0, -9, 0], [9, -9, 0], [9, 9, 0], [0, 9, 0]], "material": "light"}],
        "background": [1, 1, 1]})");
    MethodRequest request = lattice_request(scene, LatticeMask::square, 3);
    request.settings.size = {30, 12};
    request.settings.max_depth = 1;
    // Between columns 0.1 and 0.9 nothing is right; the seam lies between columns 14 and 15.
    const auto wrong_pixels = [&](LatticeKernel kernel) {
        request.parameters.kernel = kernel;
        const Image image = render_by("interleaved", request).render.frame.radiance;
        int wrong = 0;
        for (int y = 0; y < 12; ++y) {
            for (int x = 0; x < 30; ++x)
                wrong += std::abs(image(x, y).x - (x < 15 ? 0.1f : 0.9f)) > 1e-4f ? 1 : 0;
        }
        return wrong;
    };
    CHECK(wrong_pixels(LatticeKernel::surface) == 0);
    CHECK(wrong_pixels(LatticeKernel::distance3d_normal) > 0);
}

TEST_CASE("a subsequence puts together the samples of its box", "[methods]") {
    const Scene scene = repository_scene("cornell");
    MethodRequest request = request_of(scene, {31, 30}, 64);
    request.parameters.interleaving = Interleaving::subsequence;
    request.parameters.step = 2;
    const MethodRender result = render_by("interleaved", request);
    CHECK(result.render.statistics.samples == 31 * 30 * 16);
    CHECK(result.facts["samples_per_pixel"] == 16);
    CHECK(result.facts["traced_share"] == 1.0);
    // With a quarter of the samples it comes nearer to the truth than path tracing with as many.
    MethodRequest truth = request;
    truth.settings.spp = 4096;
    const Image reference = render(scene, truth.settings).frame.radiance;
    MethodRequest few = request;
    few.settings.spp = 16;
    const double path = error_against(render(scene, few.settings).frame.radiance, reference);
    CHECK(error_against(result.render.frame.radiance, reference) < path);
    // The box of one pixel changes nothing but the random numbers, which all pixels share.
    request.parameters.step = 1;
    const Frame plain = render_by("interleaved", request).render.frame;
    const double as_many = error_against(render(scene, request.settings).frame.radiance, reference);
    CHECK(error_against(plain.radiance, reference) < 4 * as_many);
    CHECK(plain.radiance(3, 7) != render(scene, request.settings).frame.radiance(3, 7));
}

TEST_CASE("a subsequence without a sample for every pixel of its box is refused", "[methods]") {
    const Scene scene = repository_scene("cornell");
    MethodRequest request = request_of(scene, {8, 8}, 8);
    request.parameters.interleaving = Interleaving::subsequence;
    request.parameters.step = 3;
    const Error error = error_of([&] { (void)render_by("interleaved", request); });
    CHECK(error.code() == ExitCode::usage);
    CHECK(std::string(error.what()).starts_with("spp: found 8, allowed with a subsequence"));
}
