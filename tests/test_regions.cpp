// SPDX-License-Identifier: Apache-2.0
//
// Regions against a brute-force reading of their definition, and by hand.
#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <string>

#include "eval/regions.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/region_frames.h"
#include "tests/scene_text.h"

using namespace vecino;

namespace {

const double kDegree = std::acos(-1.0) / 180;

glm::vec3 tilted(double degrees) {
    return {0.0f, static_cast<float>(std::sin(degrees * kDegree)),
            static_cast<float>(std::cos(degrees * kDegree))};
}

/// The angle from the chord between unit vectors, not from the cosine as in the program.
bool bent(glm::vec3 a, glm::vec3 b) {
    const glm::dvec3 chord = glm::dvec3(a) - glm::dvec3(b);
    return 2 * std::asin(std::hypot(chord.x, chord.y, chord.z) / 2) > 18 * kDegree;
}

bool differ(const Frame& frame, int x, int y, int u, int v) {
    if (frame.object_id(x, y) != frame.object_id(u, v)) return true;
    if (frame.object_id(x, y) == kMiss) return false;
    for (int c = 0; c < 3; ++c) {
        const auto a = static_cast<double>(frame.albedo(x, y)[c]);
        if (std::abs(a - static_cast<double>(frame.albedo(u, v)[c])) > 1e-3) return true;
    }
    return bent(frame.normal_world(x, y), frame.normal_world(u, v));
}

bool has_change(const Frame& frame, int x, int y) {
    const auto [width, height] = frame.size();
    return (x > 0 && differ(frame, x, y, x - 1, y)) || (y > 0 && differ(frame, x, y, x, y - 1)) ||
           (x + 1 < width && differ(frame, x, y, x + 1, y)) ||
           (y + 1 < height && differ(frame, x, y, x, y + 1));
}

bool sees_emitter(const Frame& frame, int x, int y) {
    const glm::vec3 e = frame.emission(x, y);
    return frame.object_id(x, y) != kMiss && (e.x > 0 || e.y > 0 || e.z > 0);
}

/// Assigns a region to all pixels within sqrt(a / b) of one that has a property.
template <class Property>
void assign(RegionMap& regions, Region region, const Frame& frame, Property has, int a, int b) {
    const auto [width, height] = frame.size();
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            if (!has(frame, x, y)) continue;
            for (int v = 0; v < height; ++v)
                for (int u = 0; u < width; ++u)
                    if (((u - x) * (u - x) + (v - y) * (v - y)) * b <= a) regions(u, v) = region;
        }
}

RegionMap brute_force(const Frame& frame) {
    RegionMap regions(frame.size(), Region::interior);
    const int width = frame.size().width;
    assign(regions, Region::edge, frame, has_change, 4, 1);
    assign(regions, Region::emitter, frame, sees_emitter, width * width, 32 * 32);
    return regions;
}

/// A wall with about one speck of any kind in so many pixels.
Frame speckled(Extent size, unsigned rarity, unsigned seed) {
    std::mt19937 engine(seed);
    Frame frame = flat_frame(size);
    const double tilts[] = {17.8, 18.2, 40};
    const glm::vec3 emissions[] = {{0, 0, 0.001f}, {0, 2, 0}, {15, 15, 15}};
    const glm::vec3 albedos[] = {{0.5f, 0.5f, 0.5009f}, {0.5f, 0.5011f, 0.5f}, {0.4f, 0.5f, 0.5f}};
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const auto drawn = [&](unsigned share) { return engine() % (share * rarity) == 0; };
            if (drawn(1)) frame.albedo(x, y) = albedos[engine() % 3];
            if (drawn(1)) frame.normal_world(x, y) = tilted(tilts[engine() % 3]);
            if (drawn(2)) frame.object_id(x, y) = 1;
            if (drawn(4)) set_miss(frame, x, y);
            if (drawn(4)) frame.emission(x, y) = emissions[engine() % 3];
        }
    return frame;
}

std::string drawing(const RegionMap& regions) {
    std::string text;
    for (int y = 0; y < regions.size().height; ++y) {
        for (int x = 0; x < regions.size().width; ++x) text += "*#."[region_index(regions(x, y))];
        text += '\n';
    }
    return text;
}

std::size_t count(const RegionMap& regions, Region region) {
    return region_pixels(regions)[region_index(region)];
}

}  // namespace

TEST_CASE("regions are those of a search through all pixels", "[regions]") {
    const auto size =
        GENERATE(Extent{64, 48}, Extent{47, 61}, Extent{200, 9}, Extent{3, 150}, Extent{96, 1},
                 Extent{1, 40}, Extent{2, 2}, Extent{31, 5}, Extent{32, 5}, Extent{33, 5});
    const auto rarity = GENERATE(3u, 40u, 700u);
    const auto seed = GENERATE(1u, 2u, 3u);
    const Frame frame = speckled(size, rarity, seed);
    CAPTURE(size.width, size.height, rarity, seed);
    CHECK(drawing(regions_of(frame)) == drawing(brute_force(frame)));
}

TEST_CASE("the random frames of that search hold all regions", "[regions]") {
    const PerRegion<std::size_t> pixels = region_pixels(brute_force(speckled({64, 48}, 40, 1)));
    CHECK(*std::ranges::min_element(pixels) > 64);
}

TEST_CASE("regions of rendered scenes are those of a search through all pixels", "[regions]") {
    const auto* const scene = GENERATE("cornell_sphere", "illustration_13");
    const Frame frame =
        render(test::repository_scene(scene), test::small_settings({96, 64}, 1)).frame;
    const RegionMap regions = regions_of(frame);
    CHECK(drawing(regions) == drawing(brute_force(frame)));
    CHECK(count(regions, Region::edge) > 64);
    CHECK(count(regions, Region::interior) > 64);
}

TEST_CASE("a pixel is in the edge region up to 2 px from either pixel of a change", "[regions]") {
    Frame frame = flat_frame({9, 7});
    for (int y = 0; y < 7; ++y)
        for (int x = 4; x < 9; ++x) frame.object_id(x, y) = 7;
    for (int y = 0; y < 7; ++y)
        for (int x = 0; x < 9; ++x) {
            CAPTURE(x, y);
            CHECK((regions_of(frame)(x, y) == Region::edge) == (x >= 1 && x <= 6));
        }
}

TEST_CASE("one other pixel has a round edge region", "[regions]") {
    Frame frame = flat_frame({11, 11});
    frame.albedo(5, 5).y = 0.6f;
    CHECK(drawing(regions_of(frame)) ==
          "...........\n"
          "...........\n"
          ".....#.....\n"
          "....###....\n"
          "...#####...\n"
          "..#######..\n"
          "...#####...\n"
          "....###....\n"
          ".....#.....\n"
          "...........\n"
          "...........\n");
}

TEST_CASE("what counts as a change has a threshold", "[regions]") {
    Frame frame = flat_frame({16, 1});
    const auto has_edge = [&] { return count(regions_of(frame), Region::edge) > 0; };
    REQUIRE_FALSE(has_edge());
    SECTION("albedo") {
        frame.albedo(8, 0).z = 0.5009f;
        CHECK_FALSE(has_edge());
        frame.albedo(8, 0).z = 0.4989f;
        CHECK(has_edge());
    }
    SECTION("normal") {
        frame.normal_world(8, 0) = tilted(17.99);
        CHECK_FALSE(has_edge());
        frame.normal_world(8, 0) = tilted(18.01);
        CHECK(has_edge());
    }
    SECTION("normals that are not of unit length") {
        frame.normal_world(8, 0) = 0.2f * tilted(17.99);
        CHECK_FALSE(has_edge());
        frame.normal_world(8, 0) = 5.0f * tilted(18.01);
        CHECK(has_edge());
    }
    SECTION("object id") {
        frame.object_id(8, 0) = 1;
        CHECK(has_edge());
    }
}

TEST_CASE("a miss differs from every hit and from no other miss", "[regions]") {
    Frame frame = flat_frame({12, 1});
    frame.albedo = frame.normal_world = Image({12, 1});  // black hits look like misses, but for id
    for (int x = 6; x < 12; ++x) set_miss(frame, x, 0);
    frame.albedo(10, 0) = glm::vec3(1.0f);
    frame.normal_world(9, 0) = {1.0f, 0.0f, 0.0f};
    frame.normal_world(10, 0) = {0.0f, 1.0f, 0.0f};
    CHECK(drawing(regions_of(frame)) == "...######...\n");
}

TEST_CASE("the emitter region reaches width/32 px from an emitter", "[regions]") {
    // 2 px at a width of 64: the pixel at (1, 2) from the emitter is farther.
    Frame frame = flat_frame({64, 7});
    frame.emission(10, 3).y = 1e-6f;
    const RegionMap regions = regions_of(frame);
    CHECK(count(regions, Region::emitter) == 13);
    CHECK(regions(12, 3) == Region::emitter);
    CHECK(regions(11, 4) == Region::emitter);
    CHECK(regions(11, 5) == Region::interior);
    // 1.97 px at a width of 63: no pixel at 2 px.
    frame = flat_frame({63, 7});
    frame.emission(10, 3).y = 1e-6f;
    CHECK(count(regions_of(frame), Region::emitter) == 9);
}

TEST_CASE("a lit background is no emitter", "[regions]") {
    Frame frame = flat_frame({64, 8});
    for (int x = 32; x < 64; ++x)
        for (int y = 0; y < 8; ++y) set_miss(frame, x, y);
    for (int x = 32; x < 64; ++x) frame.emission(x, 4) = glm::vec3(1.0f);
    CHECK(count(regions_of(frame), Region::emitter) == 0);
    CHECK(count(regions_of(frame), Region::edge) == 6 * 8);
}

TEST_CASE("where regions overlap the emitter comes first", "[regions]") {
    Frame frame = flat_frame({64, 1});
    frame.object_id(20, 0) = 1;
    frame.emission(20, 0) = glm::vec3(15.0f);
    CHECK(drawing(regions_of(frame)).substr(15, 11) == "..#*****#..");
}

TEST_CASE("a frame may be all emitter, or one pixel", "[regions]") {
    const auto size = GENERATE(Extent{40, 30}, Extent{1, 1});
    Frame frame = flat_frame(size);
    CHECK(regions_of(frame) == RegionMap(size, Region::interior));
    frame.emission = Image(size, glm::vec3(1.0f));
    CHECK(regions_of(frame) == RegionMap(size, Region::emitter));
    frame.object_id = Grid<std::int32_t>(size, kMiss);
    CHECK(regions_of(frame) == RegionMap(size, Region::interior));
}

TEST_CASE("regions name the planes that they lack", "[regions]") {
    Frame frame = flat_frame({4, 3});
    CHECK(has_region_planes(frame));
    frame.normal_world = {};
    frame.object_id = {};
    CHECK_FALSE(has_region_planes(frame));
    const Error error = error_of([&] { regions_of(frame); });
    CHECK(error.code() == ExitCode::mismatch);
    CHECK(std::string(error.what()) ==
          "regions need the planes emission, albedo, normal and id, missing: normal, id");
}

TEST_CASE("planes of different sizes have no regions", "[regions]") {
    Frame frame = flat_frame({4, 3});
    frame.albedo = Image({3, 4});
    const Error error = error_of([&] { regions_of(frame); });
    CHECK(error.code() == ExitCode::mismatch);
    CHECK(std::string(error.what()) ==
          "regions: plane albedo is 3x4, plane id is 4x3: allowed: equal sizes");
}

TEST_CASE("the table of regions is in the order of their indices, under names of their own",
          "[regions]") {
    std::set<std::string_view> names;
    for (std::size_t i = 0; i < kRegions.size(); ++i) {
        CHECK(region_index(kRegions[i].region) == i);
        names.insert(kRegions[i].name);
    }
    CHECK(names.size() == kRegions.size());
}

TEST_CASE("regions fit images of their own size only", "[regions]") {
    const RegionMap regions({4, 3}, Region::edge);
    require_size(regions, {4, 3});
    const Error error = error_of([&] { require_size(regions, {3, 4}); });
    CHECK(error.code() == ExitCode::mismatch);
    CHECK(std::string(error.what()) == "regions are 4x3, image is 3x4: allowed: equal sizes");
}
