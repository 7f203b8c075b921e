// SPDX-License-Identifier: Apache-2.0
//
// Files of other renderers on the command line: cornell_sphere by Blender 5.0 and Mitsuba 3.9, as
// configs/renderers/ writes them, and files that are not what they seem.
#include <filesystem>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "core/image_io.h"
#include "core/render.h"
#include "core/renderer_channels.h"
#include "core/scene.h"
#include "eval/metrics.h"
#include "eval/regions.h"
#include "filters/guide.h"
#include "tests/catch.h"
#include "tests/foreign_image.h"
#include "tests/program.h"

using namespace vecino;

namespace {

std::string data(const std::string& name) {
    return std::string(VECINO_SOURCE_DIR) + "/tests/data/" + name;
}

/// What the files show, by our own tracer: 32x24.
const Frame& reference() {
    static const Frame frame = [] {
        RenderSettings settings;
        settings.size = {32, 24};
        settings.spp = 1024;
        settings.first_hit = FirstHit::centre;
        const std::string scene = std::string(VECINO_SOURCE_DIR) + "/scenes/cornell_sphere.json";
        return render(load_scene(scene), settings).frame;
    }();
    return frame;
}

/// PSNR in dB away from lamp and edges, which centre hits cannot smooth.
double interior_db(const std::string& path) {
    const RegionMap regions = regions_of(reference());
    const auto all = compare(load_image(path), reference().radiance, &regions).regions;
    return all->at(region_index(Region::interior)).metrics->psnr_float_db.value_or(99.0);
}

std::string line(const std::string& renderer, const std::string& scheme) {
    return "upsample '" + data(renderer + "_low.exr") + "' -o up.exr --size 32x24 --scheme " +
           scheme + " --guide '" + data(renderer + "_guide.exr") + "'";
}

}  // namespace

TEST_CASE("files of Blender and of Mitsuba are upsampled as they are", "[foreign]") {
    const std::string renderer = GENERATE("blender", "mitsuba");
    const std::string scheme = GENERATE("joint_bilateral", "guided_fit");
    CAPTURE(renderer, scheme);
    const TempDir dir;
    const Outcome outcome = run_in(dir, line(renderer, scheme) + " --json");
    CHECK(outcome.err.empty());
    REQUIRE(outcome.code == 0);
    const auto json = nlohmann::json::parse(outcome.out);
    CHECK(json["fallback_pixels"] == 0);
    CHECK(json["non_finite_pixels"] == 0);
    CHECK(load_image(dir.path("up.exr")).size() == Extent{32, 24});
    CHECK(interior_db(dir.path("up.exr")) > (scheme == "guided_fit" ? 30.0 : 25.0));
}

TEST_CASE("the planes of another renderer's guide are those of our own", "[foreign]") {
    const std::string renderer = GENERATE("blender", "mitsuba");
    CAPTURE(renderer);
    const std::string path = data(renderer + "_guide.exr");
    Frame guide = load_renderer_frame(path, kGuidePlanes).frame;
    CHECK(check_guide(guide, path).empty());
    int far = 0;
    int other = 0;
    int pale = 0;
    for (int y = 0; y < 24; ++y) {
        for (int x = 0; x < 32; ++x) {
            if (reference().object_id(x, y) == kMiss) {
                CHECK(guide.object_id(x, y) == kMiss);
                continue;
            }
            const glm::vec3 d = guide.position_world(x, y) - reference().position_world(x, y);
            far += glm::length(d) > 0.01f ? 1 : 0;
            const glm::vec3 n = reference().normal_world(x, y);
            other += std::abs(glm::dot(n, guide.normal_world(x, y))) < 0.99f ? 1 : 0;
            const glm::vec3 a = guide.albedo(x, y) - reference().albedo(x, y);
            pale += glm::length(a) > 0.01f ? 1 : 0;
        }
    }
    // Rays through the middle of pixels meet the edges between walls, which fall to either.
    CHECK(far <= 3);
    CHECK(other <= 16);
    CHECK(pale <= 16);
}

TEST_CASE("the schemes of the thesis read other renderers' names too", "[foreign]") {
    const TempDir dir;
    const std::string low = "upsample '" + data("blender_guide.exr") + "' -o up.exr --size 64x48";
    CHECK(run_in(dir, low + " --scheme nearest").code == 0);
    CHECK(run_in(dir, low + " --scheme distance3d_normal").code == 0);
}

TEST_CASE("a scheme with a guide says when it has none, and others when they do not read it",
          "[foreign]") {
    const TempDir dir;
    const std::string low = "upsample '" + data("blender_low.exr") + "' -o up.exr --size 32x24";
    const Outcome none = run_in(dir, low + " --scheme guided_fit");
    CHECK(none.code == 64);
    CHECK(none.err ==
          "vecino: command line: --scheme guided_fit: found no --guide, allowed: with a file of "
          "full-resolution planes\n");
    const Outcome vain =
        run_in(dir, low + " --scheme nearest --guide '" + data("blender_guide.exr") + "'");
    CHECK(vain.code == 0);
    CHECK(vain.err == "note: nearest does not read --guide\n");
    CHECK(run_in(dir, low + " --scheme guided_fit --guide gone.exr").code == 4);
}

TEST_CASE("a guide of another size or without planes is one line", "[foreign]") {
    const TempDir dir;
    const std::string low = "upsample '" + data("blender_low.exr") + "' -o up.exr --size 32x24" +
                            " --scheme guided_fit --guide ";
    const Outcome small = run_in(dir, low + "'" + data("mitsuba_low.exr") + "'");
    CHECK(small.code == 3);
    CHECK_THAT(small.err, Catch::Matchers::Contains(
                              "found a guide of 16x12, allowed: 32x24 or a whole multiple of it"));
    save_image(Image({32, 24}), dir.path("plain.exr"));
    const Outcome plain = run_in(dir, low + "plain.exr");
    CHECK(plain.code == 3);
    CHECK_THAT(plain.err, Catch::Matchers::Contains(
                              "plain.exr: found none of the planes position, normal, distance and "
                              "id, allowed: one of them at least (--channel says"));
    CHECK_FALSE(std::filesystem::exists(dir.path("up.exr")));
}

TEST_CASE("channels of unknown names are mapped by flags", "[foreign]") {
    const TempDir dir;
    write_foreign<float>(
        dir.path("low.exr"),
        make_spec({1, 1}, {"beauty.red", "beauty.green", "beauty.blue"}, OIIO::TypeDesc::FLOAT),
        {1, 2, 3});
    write_foreign<float>(dir.path("guide.exr"),
                         make_spec({2, 1}, {"face.a", "face.b", "face.c"}, OIIO::TypeDesc::FLOAT),
                         {0.5f, 0.5f, 1.0f, 0.5f, 0.5f, 1.0f});  // encoded as (n + 1) / 2
    const std::string start =
        "upsample low.exr -o up.exr --size 2x1 --scheme joint_bilateral "
        "--guide guide.exr";
    CHECK(run_in(dir, start).code == 3);
    const Outcome mapped = run_in(dir, start +
                                           " --channel radiance=beauty.red,beauty.green,beauty.blue"
                                           " --channel normal=face.a,face.b,face.c");
    CHECK(mapped.code == 0);
    CHECK(mapped.err ==
          "note: guide.exr: its normals are encoded as (n + 1) / 2 and were decoded\n");
    CHECK(load_image(dir.path("up.exr"))(1, 0) == glm::vec3(1, 2, 3));
    const Outcome wrong = run_in(dir, start + " --channel normal=face.a,face.b");
    CHECK(wrong.code == 64);
    CHECK_THAT(wrong.err, Catch::Matchers::Contains("the names of 3 channels of normal"));
}
