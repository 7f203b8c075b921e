// SPDX-License-Identifier: Apache-2.0
//
// What a guide's planes hold is checked, not assumed.
#include "filters/guide.h"

#include <glm/geometric.hpp>

#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/guides.h"
#include "tests/scheme_frames.h"

using namespace vecino;

namespace {

/// Two walls that meet, seen from the front.
Frame corner_guide() {
    const Extent size{24, 16};
    Frame guide = flat_guide(size);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < 12; ++x) {
            guide.position_world(x, y).z = 0.5f - guide.position_world(x, y).x;
            guide.normal_world(x, y) = {std::sqrt(0.5f), 0, std::sqrt(0.5f)};
        }
    }
    return guide;
}

std::string fault_of(Frame guide) {
    const Error error = error_of([&] { check_guide(guide, "high.exr"); });
    CHECK(error.code() == ExitCode::mismatch);
    return error.what();
}

}  // namespace

TEST_CASE("a sound guide passes as it is", "[guide]") {
    Frame guide = corner_guide();
    CHECK(check_guide(guide, "high.exr").empty());
    CHECK(guide.position_world == corner_guide().position_world);
    CHECK(guide.object_id == corner_guide().object_id);
    CHECK(relative_difference(guide.normal_world, corner_guide().normal_world) < 1e-6);
}

TEST_CASE("normals encoded from 0 to 1 are decoded, and it is said", "[guide]") {
    Frame guide = corner_guide();
    for (glm::vec3& n : guide.normal_world.values()) n = 0.5f * n + 0.5f;
    const auto notes = check_guide(guide, "high.exr");
    REQUIRE(notes.size() == 1);
    CHECK(notes[0] == "high.exr: its normals are encoded as (n + 1) / 2 and were decoded");
    CHECK(relative_difference(guide.normal_world, corner_guide().normal_world) < 1e-5);
}

TEST_CASE("normals averaged at edges become unit ones, or none", "[guide]") {
    Frame guide = corner_guide();
    guide.normal_world(12, 3) = 0.9f * guide.normal_world(12, 3);
    guide.normal_world(12, 4) = 0.1f * guide.normal_world(12, 4);
    check_guide(guide, "high.exr");
    CHECK(glm::length(guide.normal_world(12, 3)) == Approx(1.0f));
    CHECK(guide.normal_world(12, 4) == glm::vec3(0.0f));
    CHECK(guide.object_id(12, 4) == kMiss);
}

TEST_CASE("normals of other lengths are an error", "[guide]") {
    Frame guide = corner_guide();
    for (glm::vec3& n : guide.normal_world.values()) n *= 7.0f;
    CHECK(fault_of(guide) ==
          "high.exr: found normals of length 7 to 7, in the middle 7, allowed: unit length, or "
          "unit normals encoded as (n + 1) / 2");
    guide.normal_world = Grid<glm::vec3>(guide_size(guide));
    CHECK(fault_of(guide) ==
          "high.exr: found no normal that is not 0, allowed: normals of unit length");
}

TEST_CASE("normals of another coordinate system than the positions are an error", "[guide]") {
    Frame guide = corner_guide();
    for (glm::vec3& n : guide.normal_world.values()) n = {n.x, n.z, n.y};  // y is up, or z
    CHECK_THAT(fault_of(guide),
               Catch::Matchers::Contains("normals with a cosine of 0.5 (median)") &&
                   Catch::Matchers::Contains("allowed: 0.8 and more: both planes in one "
                                             "coordinate system"));
    // Another axis up in both is no fault, nor are normals that face away.
    for (glm::vec3& p : guide.position_world.values()) p = {p.x, p.z, p.y};
    for (glm::vec3& n : guide.normal_world.values()) n = -n;
    CHECK(check_guide(guide, "high.exr").empty());
}

TEST_CASE("one position everywhere is an error", "[guide]") {
    Frame guide = corner_guide();
    guide.position_world = Grid<glm::vec3>(guide_size(guide), {1, 2, 3});
    CHECK(fault_of(guide) ==
          "high.exr: found one position everywhere, allowed: where each pixel's surface is");
}

TEST_CASE("distances may be negative, but not both", "[guide]") {
    Frame guide = corner_guide();
    guide.distance_world = Grid<float>(guide_size(guide), -3.0f);
    check_guide(guide, "high.exr");
    CHECK(guide.distance_world(0, 0) == 3.0f);
    guide.distance_world(1, 0) = -1.0f;
    CHECK(fault_of(guide) ==
          "high.exr: found distances from -1 to 3, allowed: distances from the camera, all of one "
          "sign");
    guide.distance_world = Grid<float>(guide_size(guide), 1e10f);
    CHECK_THAT(fault_of(guide), Catch::Matchers::Contains("no distance but 0 and infinity"));
}

TEST_CASE("a miss is one by its distance, its normal or its id", "[guide]") {
    Frame guide = corner_guide();
    guide.distance_world = Grid<float>(guide_size(guide), 3.0f);
    guide.distance_world(3, 4) = 1e10f;  // Blender's
    guide.normal_world(5, 6) = glm::vec3(0.0f);
    guide.object_id(7, 8) = kMiss;
    check_guide(guide, "high.exr");
    CHECK(guide.object_id(3, 4) == kMiss);
    CHECK(guide.object_id(5, 6) == kMiss);
    CHECK(guide.object_id(7, 8) == kMiss);
    CHECK(guide.object_id(9, 9) == 0);
}

TEST_CASE("albedo and emission have their ranges", "[guide]") {
    Frame guide = corner_guide();
    guide.albedo(0, 0) = glm::vec3(15.0f);  // a lamp's, in one renderer
    CHECK_NOTHROW(check_guide(guide, "high.exr"));
    guide.albedo = Image(guide_size(guide), glm::vec3(184.0f));
    CHECK(fault_of(guide) == "high.exr: found albedo from 0 to 184, allowed: 0 to 1");
    guide.albedo = Image(guide_size(guide), glm::vec3(-0.5f));
    CHECK_THAT(fault_of(guide), Catch::Matchers::Contains("albedo from -0.5"));
    guide.albedo = {};
    guide.emission(2, 2).y = -1.0f;
    CHECK(fault_of(guide) == "high.exr: found emission of -1, allowed: 0 and more");
}
