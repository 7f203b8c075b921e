// SPDX-License-Identifier: Apache-2.0
//
// Every signature on images of which its value is known.
#include <cmath>
#include <limits>

#include "core/json_read.h"
#include "eval/signatures.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/region_frames.h"

using namespace vecino;
using nlohmann::json;

namespace {

constexpr glm::vec3 kBlue(0.0f, 0.0f, 1.0f);
constexpr glm::vec3 kRed(1.0f, 0.0f, 0.0f);

/// 12 x 8 pixels: object 0 is blue, object 1 red from column 6 on.
Frame two_sides() {
    Frame frame = flat_frame({12, 8});
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 12; ++x) {
            frame.object_id(x, y) = x < 6 ? 0 : 1;
            frame.radiance(x, y) = x < 6 ? kBlue : kRed;
        }
    }
    return frame;
}

void fill_column(Image& image, int x, glm::vec3 value) {
    for (int y = 0; y < image.size().height; ++y) image(x, y) = value;
}

struct Group {
    Frame reference = two_sides();
    std::vector<Image> images{two_sides().radiance};
    std::vector<Image> path;
    std::vector<json> rows{json::object()};

    [[nodiscard]] SignatureValues values(const json& measure) const {
        const Measure read = read_measure(JsonValue(measure, "test"));
        return measured(read, {images, path, rows, reference, read.parameters});
    }
    [[nodiscard]] double value(const json& measure) const { return values(measure).front(); }
};

/// Columns that the far side has taken: of object 0 beside object 1.
Group ring_of(int columns) {
    Group group;
    for (int i = 1; i <= columns; ++i) fill_column(group.images[0], 6 - i, kRed);
    return group;
}

}  // namespace

TEST_CASE("the width of a ring is counted in pixels", "[signature]") {
    const json swap{
        {"signature", "swap_width"}, {"where", {{"on", {0}}}}, {"objects", {1}}, {"far", 1}};
    for (const int columns : {0, 1, 2, 3}) CHECK(ring_of(columns).value(swap) == Approx(columns));
    Group blur;
    fill_column(blur.images[0], 5, 0.6f * kBlue + 0.4f * kRed);
    CHECK(blur.value(swap) == 0);  // a blur is no swap
    const json halo{{"signature", "halo_width"},
                    {"where", {{"on", {0}}}},
                    {"objects", {1}},
                    {"contrast", 1},
                    {"threshold", 0.3}};
    CHECK(blur.value(halo) == Approx(1));
    CHECK(ring_of(2).value(halo) == Approx(2));
}

TEST_CASE("the share of a far colour is that of the mixture", "[signature]") {
    Group group;
    for (const float share : {0.0f, 0.25f, 1.0f}) {
        fill_column(group.images[0], 5, (1 - share) * kBlue + share * kRed);
        const json near{{"on", {0}}, {"near", {1}}, {"within_px", {1, 1}}};
        CHECK(group.value({{"signature", "far_share"}, {"where", near}, {"far", 1}}) ==
              Approx(share));
        const json two{{"on", {0}}, {"near", {1}}, {"within_px", {1, 2}}};
        CHECK(group.value({{"signature", "far_share"}, {"where", two}, {"far", 1}}) ==
              Approx(share / 2));
    }
}

TEST_CASE("leaked energy is a share of its source's", "[signature]") {
    Group group;
    fill_column(group.images[0], 5, kBlue + 0.6f * kRed);
    fill_column(group.images[0], 0, glm::vec3(0));  // what is lost is not leaked
    CHECK(
        group.value({{"signature", "leaked_energy"}, {"where", {{"on", {0}}}}, {"objects", {1}}}) ==
        Approx(0.6 / 6));
}

TEST_CASE("errors within pixels follow their formulas", "[signature]") {
    Group group;
    fill_column(group.images[0], 5, glm::vec3(0.0f, 0.0f, 0.7f));
    const json column{{"box", {5.0 / 12, 0, 6.0 / 12, 1}}};
    CHECK(group.value({{"signature", "rms_error"}, {"where", column}, {"contrast", 0.5}}) ==
          Approx(0.3 / std::sqrt(3.0) / 0.5));
    CHECK(group.value({{"signature", "mean_error"}, {"where", column}}) == Approx(0.3));
    CHECK(group.value({{"signature", "deviation"}, {"where", column}, {"expected", {0, 0, 1}}}) ==
          Approx(0.3));
    CHECK(group.value({{"signature", "deviation"}, {"where", column}, {"expected", {0, 0, 0}}}) ==
          Approx(0.7));
    group.images[0](5, 3).x = std::numeric_limits<float>::quiet_NaN();
    CHECK(std::isnan(
        group.value({{"signature", "deviation"}, {"where", column}, {"expected", {0, 0, 1}}})));
}

TEST_CASE("lost contrast is 0 for the pattern, 1 for none and 2 for its negative", "[signature]") {
    Group group;
    for (const float left : {1.0f, 0.5f, 0.0f, -1.0f}) {
        for (int x = 0; x < 12; ++x) {
            const glm::vec3 r = x < 6 ? kBlue : kRed;
            fill_column(group.images[0], x, left * r + (1 - left) * 0.5f * (kBlue + kRed));
        }
        CHECK(group.value({{"signature", "lost_contrast"}}) == Approx(1 - left));
    }
}

TEST_CASE("a ramp is as wide as it is drawn", "[signature]") {
    const json edge{{"signature", "edge_widening"}, {"across", "x"}};
    Group group;
    CHECK(group.value(edge) == 0);
    for (int x = 2; x < 10; ++x) {
        const float p = (static_cast<float>(x) - 1.5f) / 8;
        fill_column(group.images[0], x, (1 - p) * kBlue + p * kRed);
    }
    CHECK(group.value(edge) == Approx(8).epsilon(0.02));
}

TEST_CASE("a shifted object is found where it is", "[signature]") {
    Group group;
    group.reference = flat_frame({20, 20});
    group.reference.radiance = group.images[0] = Image({20, 20}, kBlue);
    for (int y = 8; y < 12; ++y) {
        for (int x = 8; x < 12; ++x) {
            group.reference.object_id(x, y) = 1;
            group.reference.radiance(x, y) = kRed;
            group.images[0](x + 1, y) = kRed;
        }
    }
    CHECK(group.value({{"signature", "centroid_shift"}, {"objects", {1}}, {"reach_px", 4}}) ==
          Approx(1));
}

TEST_CASE("steps are told from those of the reference", "[signature]") {
    Group group;
    const json seam{{"signature", "seam_step"}, {"contrast", 0.5}};
    CHECK(group.value(seam) == 0);
    for (int x = 6; x < 12; ++x) fill_column(group.images[0], x, kRed + 0.1f * kBlue);
    CHECK(group.value(seam) == Approx(0.1 / std::sqrt(3.0) / 0.5));
    for (int y = 0; y < 8; ++y)
        for (int x = 6; x < 12; ++x) group.reference.normal_world(x, y) = {1, 0, 0};
    CHECK(group.value({{"signature", "facet_step"}, {"contrast", 0.5}, {"min_angle_degrees", 5}}) ==
          Approx(0.1 / std::sqrt(3.0) / 0.5));
}

TEST_CASE("an outlier is as large as the pixels that it fills", "[signature]") {
    Group group;
    const json spots{{"signature", "outlier_area"}, {"contrast", 1}, {"threshold", 1}};
    CHECK(group.value(spots) == 0);
    group.images[0](2, 2) = glm::vec3(9);
    CHECK(group.value(spots) == 1);
    group.images[0](3, 3) = glm::vec3(9);  // corners touch
    group.images[0](9, 5) = glm::vec3(9);
    CHECK(group.value(spots) == Approx(1.5));
}

TEST_CASE("what changes with the seed is counted and measured", "[signature]") {
    Group group;
    group.images.push_back(group.images[0]);
    group.rows.push_back(json::object());
    fill_column(group.images[1], 5, kBlue + 0.4f * kRed);
    const json flips{{"signature", "seed_flips"}, {"contrast", 1}, {"threshold", 0.3}};
    CHECK(group.value(flips) == Approx(1.0 / 12));
    const json column{{"box", {5.0 / 12, 0, 6.0 / 12, 1}}};
    // Two values 0.4 apart in one channel of three scatter by 0.4 / sqrt(2); blue is 1/3 bright.
    const double noise = group.value({{"signature", "seed_noise"}, {"where", column}});
    CHECK(noise == Approx(0.4 / std::sqrt(2.0) / std::sqrt(3.0) * 3));
}

TEST_CASE("damage that no count tells of is infinite", "[signature]") {
    Group group;
    group.rows[0] = {{"params", {{"reduction", 2}, {"inject", {1}}}},
                     {"counts", {{"dropped_samples", 1}, {"fallback_pixels", 6}}}};
    const json damage{{"signature", "damaged_blocks"}, {"contrast", 1}, {"threshold", 0.1}};
    CHECK(group.value(damage) == 0);
    for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 2; ++x) group.images[0](x, y) = glm::vec3(0);
    CHECK(group.value(damage) == Approx(1));
    CHECK(group.value({{"signature", "fallbacks"}}) == Approx(6.0 / 24));
    group.rows[0]["counts"]["dropped_samples"] = 0;
    CHECK(std::isinf(group.value(damage)));
}

TEST_CASE("what differs from path tracing of the same seed is told", "[signature]") {
    Group group;
    group.path = {group.images[0]};
    CHECK(group.value({{"signature", "differs_from_path"}}) == 0);
    group.images[0](0, 0).z = 1.5f;
    CHECK(group.value({{"signature", "differs_from_path"}}) == Approx(0.5 * 3));
    group.path.clear();
    CHECK_THROWS_AS(group.value({{"signature", "differs_from_path"}}), Error);
}

TEST_CASE("every signature has a value of its own for every seed", "[signature]") {
    Group group;
    group.images.push_back(group.images[0]);
    group.path = group.images;
    const json row{{"params", {{"reduction", 2}, {"inject", {1}}}},
                   {"counts", {{"dropped_samples", 1}}}};
    group.rows = {row, row};
    for (int y = 0; y < 8; ++y)
        for (int x = 6; x < 12; ++x) group.reference.normal_world(x, y) = {1, 0, 0};
    const json parameters{
        {"far", 1},      {"objects", {1}}, {"contrast", 1},          {"threshold", 1},
        {"reach_px", 4}, {"across", "x"},  {"min_angle_degrees", 5}, {"expected", {1, 1, 1}}};
    for (const Signature& signature : all_signatures()) {
        CAPTURE(std::string(signature.name));
        json measure{{"signature", signature.name}};
        for (const std::string_view key : signature.keys)
            if (key != "where") measure[std::string(key)] = parameters.at(std::string(key));
        CHECK(group.values(measure).size() == 2);
        // A key that is missing is no default.
        if (measure.size() == 1) continue;
        measure.erase(std::prev(measure.end()).key() == "signature"
                          ? measure.begin().key()
                          : std::prev(measure.end()).key());
        CHECK_THROWS_AS(read_measure(JsonValue(measure, "test")), Error);
    }
}

TEST_CASE("pixels that are not there, and planes, are named", "[signature]") {
    Group group;
    const json none{{"signature", "mean_error"}, {"where", {{"on", {7}}}}};
    CHECK(std::string(error_of([&] { (void)group.value(none); }).what()).find("no pixel") !=
          std::string::npos);
    group.reference.object_id = {};
    CHECK(error_of([&] { (void)group.value(none); }).code() == ExitCode::mismatch);
}
