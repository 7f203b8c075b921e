// SPDX-License-Identifier: Apache-2.0
//
// The schemes by hand: golden values, the fallback and miss rules, the tables and their errors.
#include <algorithm>

#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/scheme_frames.h"

using namespace vecino;

namespace {

/// All black, on the plane z = 0 with one unit between pixels, facing +z, one object.
Frame flat_frame(Extent size) {
    Frame frame;
    frame.radiance = Image(size);
    frame.position_world = Grid<glm::vec3>(size);
    frame.normal_world = Grid<glm::vec3>(size, {0, 0, 1});
    frame.object_id = Grid<std::int32_t>(size, 0);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) frame.position_world(x, y) = {x, y, 0};
    }
    return frame;
}

/// The same with a colour of its own in every pixel.
Frame coloured_frame(Extent size) {
    Frame frame = flat_frame(size);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) frame.radiance(x, y) = {1 + x + 10 * y, 2 + x, 3 + y};
    }
    return frame;
}

Reconstruction run(std::string_view scheme, const Frame& low,
                   const SchemeParameters& parameters = {}) {
    return rebuild(low, find_scheme(scheme), parameters, low.size());
}

struct Place {
    int x, y;
};

/// The normalised weight of a neighbour: what a centre receives of a single bright pixel.
float weight_of(std::string_view scheme, Extent size, Place centre, Place neighbour) {
    Frame low = flat_frame(size);
    low.radiance(neighbour.x, neighbour.y) = glm::vec3(1.0f);
    return run(scheme, low).image(centre.x, centre.y).x;
}

/// Hits at 1, 0 and 2 units from the middle one, with colours 3, 6 and 9.
Frame three_pixels() {
    Frame low = flat_frame({3, 1});
    low.position_world(2, 0).x = 3.0f;
    for (int x = 0; x < 3; ++x) low.radiance(x, 0) = glm::vec3(3.0f * static_cast<float>(x + 1));
    return low;
}

float middle_of_three(Weighting weighting, bool use_centre) {
    SchemeParameters parameters;
    parameters.weighting = weighting;
    parameters.use_centre = use_centre;
    return run("distance3d", three_pixels(), parameters).image(1, 0).x;
}

void set_option(SchemeParameters& parameters, std::string_view name, const char* json) {
    const nlohmann::json document = parse_json_text(json, "matrix.json");
    find_scheme_option(name).set(parameters, JsonValue(document, "matrix.json", "/fixed"));
}

Error option_error(std::string_view name, const char* json) {
    return error_of([&] {
        SchemeParameters parameters;
        set_option(parameters, name, json);
    });
}

bool contains(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("distance2d weighs a 3x3 window by uv distance", "[schemes]") {
    CHECK(weight_of("distance2d", {8, 8}, {4, 4}, {4, 4}) == 0.0f);
    for (const Place beside : {Place{3, 4}, {5, 4}, {4, 3}, {4, 5}}) {
        CHECK(weight_of("distance2d", {8, 8}, {4, 4}, beside) == Approx(0.103553f).epsilon(1e-5));
    }
    for (const Place diagonal : {Place{3, 3}, {5, 3}, {3, 5}, {5, 5}}) {
        CHECK(weight_of("distance2d", {8, 8}, {4, 4}, diagonal) == Approx(0.146447f).epsilon(1e-5));
    }
    CHECK(weight_of("distance2d", {8, 8}, {4, 4}, {6, 4}) == 0.0f);
}

TEST_CASE("distance2d clips its window at a corner of the image", "[schemes]") {
    CHECK(weight_of("distance2d", {8, 8}, {7, 0}, {7, 0}) == 0.0f);
    CHECK(weight_of("distance2d", {8, 8}, {7, 0}, {6, 0}) == Approx(0.292893f).epsilon(1e-5));
    CHECK(weight_of("distance2d", {8, 8}, {7, 0}, {7, 1}) == Approx(0.292893f).epsilon(1e-5));
    CHECK(weight_of("distance2d", {8, 8}, {7, 0}, {6, 1}) == Approx(0.414214f).epsilon(1e-5));
}

TEST_CASE("distance2d measures in uv, where the pixels of a wide image are narrow", "[schemes]") {
    // 4 x 2 pixels: 1/4 to the side, 1/2 down. Corner window: 1/4, 1/2, hypotenuse.
    const double sum = 0.25 + 0.5 + std::sqrt(0.3125);
    CHECK(weight_of("distance2d", {4, 2}, {0, 0}, {1, 0}) == Approx(0.25 / sum));
    CHECK(weight_of("distance2d", {4, 2}, {0, 0}, {0, 1}) == Approx(0.5 / sum));
}

TEST_CASE("the manhattan metric sums the sides", "[schemes]") {
    Frame low = flat_frame({4, 4});
    low.radiance(1, 1) = glm::vec3(1.0f);
    SchemeParameters parameters;
    parameters.metric = Metric::manhattan;
    CHECK(run("distance2d", low, parameters).image(0, 0).x == Approx(0.5));  // 2 / (1 + 1 + 2)
}

TEST_CASE("mean averages the window inside the image", "[schemes]") {
    const Frame low = coloured_frame({3, 3});
    CHECK(run("mean", low).image(1, 1) == glm::vec3(12, 3, 4));
    CHECK(run("mean", low).image(0, 0) == glm::vec3(6.5f, 2.5f, 3.5f));
    SchemeParameters parameters;
    parameters.use_centre = false;
    CHECK(run("mean", low, parameters).image(0, 0).x == Approx((2 + 11 + 12) / 3.0));
}

TEST_CASE("distance3d weighs by the distance of the hits", "[schemes]") {
    CHECK(middle_of_three(Weighting::proportional, true) == Approx(7.0));
    CHECK(middle_of_three(Weighting::proportional, false) == Approx(7.0));
    CHECK(middle_of_three(Weighting::inverse, true) == Approx(5.97847585));
    CHECK(middle_of_three(Weighting::inverse, false) == Approx(5.00990099));
    CHECK(middle_of_three(Weighting::gaussian, true) == Approx(5.47153944));
    CHECK(middle_of_three(Weighting::gaussian, false) == Approx(5.03546179));
}

TEST_CASE("the gate of distance3d_normal leaves out neighbours that face elsewhere", "[schemes]") {
    Frame low = three_pixels();
    low.normal_world(2, 0) = {0, std::sqrt(0.5f), std::sqrt(0.5f)};  // 45 degrees
    CHECK(run("distance3d", low).image(1, 0).x == Approx(7.0));
    CHECK(run("distance3d_normal", low).image(1, 0).x == Approx(3.0));
    SchemeParameters parameters;
    parameters.min_normal_cosine = 0.7f;
    CHECK(run("distance3d_normal", low, parameters).image(1, 0).x == Approx(7.0));
}

TEST_CASE("the gate asks for more than the least cosine", "[schemes]") {
    Frame low = three_pixels();
    low.normal_world = Grid<glm::vec3>({3, 1}, {0, 0, 1});
    SchemeParameters parameters;
    parameters.min_normal_cosine = 1.0f;  // which not even the same normal exceeds
    CHECK(run("distance3d_normal", low, parameters).fallback_pixels == 3);
}

TEST_CASE("an object of one pixel keeps its own colour, and is counted", "[schemes]") {
    Frame low = coloured_frame({5, 5});
    low.normal_world(2, 2) = {1, 0, 0};
    const Scheme& scheme = find_scheme("distance3d_normal");
    for (const SchemeParameters& parameters : parameters_of(scheme, 3)) {
        INFO(cell_name(scheme, parameters));
        const Reconstruction result = rebuild(low, scheme, parameters, {10, 10});
        CHECK(result.fallback_pixels == 1);
        CHECK(result.image(4, 5) == low.radiance(2, 2));
        CHECK(result.image(6, 5) != low.radiance(3, 2));
    }
}

TEST_CASE("hits in one place leave no weight, and every pixel falls back", "[schemes]") {
    Frame low = coloured_frame({6, 4});
    low.position_world = Grid<glm::vec3>({6, 4}, {1, 2, 3});
    for (const char* name : {"distance3d", "distance3d_normal"}) {
        for (const SchemeParameters& parameters : parameters_of(find_scheme(name), 5)) {
            INFO(cell_name(find_scheme(name), parameters));
            const Reconstruction result = run(name, low, parameters);
            CHECK(result.fallback_pixels == 24);
            CHECK(same_bits(result.image, low.radiance));
        }
    }
}

TEST_CASE("a miss keeps its own colour in the 3D schemes", "[schemes]") {
    Frame low = coloured_frame({5, 5});
    low.object_id(1, 1) = low.object_id(4, 0) = kMiss;
    for (const Scheme& scheme : all_schemes()) {
        if (!scheme.needs.has(Plane::position)) continue;
        for (const SchemeParameters& parameters : parameters_of(scheme, 3)) {
            INFO(cell_name(scheme, parameters));
            const Reconstruction result = rebuild(low, scheme, parameters, low.size());
            CHECK(result.fallback_pixels == 2);
            CHECK(result.image(1, 1) == low.radiance(1, 1));
            CHECK(result.image(4, 0) == low.radiance(4, 0));
        }
    }
}

TEST_CASE("a miss lends nothing to its neighbours in the 3D schemes, and all it has in the others",
          "[schemes]") {
    Frame low = coloured_frame({5, 5});
    low.object_id(2, 2) = kMiss;
    Frame other = low;
    other.radiance(2, 2) = glm::vec3(1.0e6f);
    other.position_world(2, 2) = glm::vec3(-700.0f);
    for (const Scheme& scheme : all_schemes()) {
        if (scheme.name == "nearest" || scheme.uses_guide()) continue;
        for (const SchemeParameters& parameters : parameters_of(scheme, 3)) {
            INFO(cell_name(scheme, parameters));
            const glm::vec3 before = rebuild(low, scheme, parameters, low.size()).image(1, 2);
            const glm::vec3 after = rebuild(other, scheme, parameters, low.size()).image(1, 2);
            CHECK((before == after) == scheme.needs.has(Plane::position));
        }
    }
}

TEST_CASE("without ids nothing is a miss", "[schemes]") {
    Frame low = coloured_frame({5, 5});
    const Image expected = run("distance3d", low).image;
    low.object_id = {};
    CHECK(same_bits(run("distance3d", low).image, expected));
}

TEST_CASE("a window of the centre alone without the centre falls back everywhere", "[schemes]") {
    SchemeParameters parameters;
    parameters.window = 1;
    parameters.use_centre = false;
    const Frame low = coloured_frame({4, 3});
    const Reconstruction result = run("mean", low, parameters);
    CHECK(result.fallback_pixels == 12);
    CHECK(same_bits(result.image, low.radiance));
}

TEST_CASE("where no finite colour is left the value is 0 and counted", "[schemes]") {
    Frame low = flat_frame({4, 3});
    low.radiance = Image({4, 3}, {1.0f, kNaN, 1.0f});
    for (const Scheme& scheme : all_schemes()) {
        INFO(scheme.name);
        const Reconstruction result = rebuild(low, scheme, {}, {9, 9});
        const std::size_t counted = scheme.uses_guide() ? 81 : 12;
        CHECK(result.non_finite_pixels == counted);
        CHECK(result.dropped_samples == 12);
        CHECK(result.fallback_pixels == (scheme.name == "nearest" ? 0 : counted));
        CHECK(same_bits(result.image, Image({9, 9})));
    }
}

TEST_CASE("512 pixels at a third are 170, and every one has exactly one of them", "[schemes]") {
    CHECK(reduced({512, 512}, 3) == Extent{170, 170});
    CHECK(reduced({512, 2}, 3) == Extent{170, 1});
    CHECK(corresponding(0, 512, 170) == 0);
    CHECK(corresponding(2, 512, 170) == 0);
    CHECK(corresponding(3, 512, 170) == 1);
    CHECK(corresponding(256, 512, 170) == 85);
    CHECK(corresponding(511, 512, 170) == 169);
    std::vector<int> owned(170);
    for (int x = 0; x < 512; ++x) ++owned[static_cast<std::size_t>(corresponding(x, 512, 170))];
    for (const int count : owned) CHECK((count == 3 || count == 4));
}

TEST_CASE("the tables name each other", "[schemes]") {
    for (const Scheme& scheme : all_schemes()) {
        CHECK(&find_scheme(scheme.name) == &scheme);
        for (const std::string_view option : scheme.options) {
            CHECK(find_scheme_option(option).name == option);
            CHECK(scheme.reads(option));
        }
        CHECK_FALSE(scheme.reads("sigma"));
    }
    CHECK_FALSE(find_scheme("distance3d").reads("metric"));
    CHECK_FALSE(find_scheme("distance3d").reads("min_normal_cosine"));
    CHECK(find_scheme("nearest").options.empty());
}

TEST_CASE("options are set from JSON and stand in the names of cells", "[schemes]") {
    SchemeParameters parameters;
    set_option(parameters, "window", "7");
    set_option(parameters, "weighting", "\"inverse\"");
    set_option(parameters, "metric", "\"manhattan\"");
    set_option(parameters, "min_normal_cosine", "0.9");
    set_option(parameters, "use_centre", "false");
    CHECK(cell_name(find_scheme("distance2d"), parameters) ==
          "distance2d.w7.inverse.manhattan.no_centre");
    CHECK(cell_name(find_scheme("distance3d_normal"), parameters) ==
          "distance3d_normal.w7.inverse.c0.9.no_centre");
    CHECK(cell_name(find_scheme("distance3d_normal"), {}) ==
          "distance3d_normal.w3.proportional.c0.95.centre");
}

TEST_CASE("a bad option is an error that says what is allowed", "[schemes]") {
    const auto says = [](const Error& error, std::string_view part) {
        INFO(error.what());
        CHECK(error.code() == ExitCode::usage);
        CHECK(contains(error.what(), "matrix.json: /fixed: found "));
        CHECK(contains(error.what(), part));
    };
    says(option_error("window", "4"), "found 4, allowed: an odd integer from 1 to 9999");
    says(option_error("window", "0"), "1 to 9999");
    says(option_error("window", "\"3\""), "integer");
    says(option_error("weighting", "\"uniform\""), "allowed: proportional, inverse, gaussian");
    says(option_error("metric", "\"chebyshev\""), "allowed: euclidean, manhattan");
    says(option_error("min_normal_cosine", "1.5"), "from -1 to 1");
    says(option_error("use_centre", "1"), "true or false");
}

TEST_CASE("an unknown name is an error that lists the known ones", "[schemes]") {
    const Error scheme = error_of([] { find_scheme("bilinear"); });
    CHECK(scheme.code() == ExitCode::usage);
    CHECK(std::string(scheme.what()) ==
          "scheme: found \"bilinear\", allowed: nearest, mean, distance2d, distance3d, "
          "distance3d_normal, joint_bilateral, guided_fit");
    const Error option = error_of([] { find_scheme_option("sigma"); });
    CHECK(option.code() == ExitCode::usage);
    CHECK(std::string(option.what()) ==
          "scheme option: found \"sigma\", allowed: window, weighting, metric, min_normal_cosine, "
          "use_centre, order, guide_scale");
}

TEST_CASE("a frame without a plane that the scheme needs is an error naming both", "[schemes]") {
    Frame low = flat_frame({4, 4});
    low.normal_world = {};
    require_planes(find_scheme("distance3d"), low, "low.exr");
    const Scheme& scheme = find_scheme("distance3d_normal");
    const Error error = error_of([&] { require_planes(scheme, low, "low.exr"); });
    CHECK(error.code() == ExitCode::mismatch);
    CHECK(std::string(error.what()) ==
          "low.exr: scheme \"distance3d_normal\" needs planes that are not there: normal");
    CHECK(error_of([&] { run("distance3d_normal", low); }).code() == ExitCode::mismatch);
    low.position_world = Grid<glm::vec3>({2, 2});
    CHECK(contains(error_of([&] { run("distance3d", low); }).what(),
                   "found plane \"position\" of 2x2, allowed: 4x4"));
}

TEST_CASE("sizes and windows that make no sense are errors", "[schemes]") {
    const Frame low = flat_frame({4, 4});
    const Scheme& scheme = find_scheme("mean");
    const auto code = [&](const Frame& frame, Extent size, int window) {
        SchemeParameters parameters;
        parameters.window = window;
        return error_of([&] { rebuild(frame, scheme, parameters, size); }).code();
    };
    CHECK(code(low, {8, 3}, 3) == ExitCode::mismatch);
    CHECK(code(low, {3, 8}, 3) == ExitCode::mismatch);
    CHECK(code(Frame{}, {8, 8}, 3) == ExitCode::mismatch);
    CHECK(code(low, {8, 8}, 2) == ExitCode::usage);
    CHECK(code(low, {8, 8}, 0) == ExitCode::usage);
    CHECK(code(low, {8, 8}, -1) == ExitCode::usage);
}
