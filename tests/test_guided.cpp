// SPDX-License-Identifier: Apache-2.0
//
// The schemes with a guide, by hand: what is rebuilt exactly, what must not mix, and what a guide
// of few planes still tells apart.
#include <algorithm>
#include <glm/common.hpp>

#include "filters/guide.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/guides.h"
#include "tests/scheme_frames.h"

using namespace vecino;

namespace {

Reconstruction run(const char* name, const Frame& low, const Frame& guide, Extent size,
                   int order = 2, int threads = 1) {
    const Scheme& scheme = find_scheme(name);
    SchemeParameters parameters = scheme.defaults;
    parameters.order = order;
    return reconstruct(low, scheme, {size, parameters, threads, &guide});
}

glm::vec3 linear(float u, float v) {
    return {0.2f + 0.5f * u + 0.3f * v, 1.0f - 0.7f * u, 0.4f + 0.6f * v};
}

glm::vec3 quadratic(float u, float v) {
    return {0.3f + u * u, 0.5f + 0.4f * u - 0.3f * u * v, 1.0f - 0.8f * v * v + 0.2f * v};
}

/// The left part of a guide farther back, with another albedo; its edge is at a column.
Frame step_guide(Extent size, int edge) {
    Frame guide = flat_guide(size);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < edge; ++x) {
            guide.position_world(x, y).z = -1.0f;
            guide.object_id(x, y) = 1;
        }
    }
    return guide;
}

/// 1 left of a column, 3 right of it.
Image step_image(Extent size, int edge) {
    Image image(size, glm::vec3(3.0f));
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < edge; ++x) image(x, y) = glm::vec3(1.0f);
    }
    return image;
}

}  // namespace

TEST_CASE("a fit of order 1 or 2 rebuilds linear irradiance on a plane exactly", "[guided]") {
    const int order = GENERATE(1, 2);
    const Extent low_size = GENERATE(values<Extent>({{24, 18}, {16, 12}, {48, 36}, {13, 11}}));
    const Extent size{48, 36};
    const Frame guide = flat_guide(size);
    const Frame low = frame_of(sampled(low_size, linear));
    const Reconstruction result = run("guided_fit", low, guide, size, order);
    // 48 / 13: parts of guide pixels stand for whole ones.
    const double tolerance = low_size.width == 13 ? 1e-3 : 2e-6;
    CHECK(largest_difference(result.image, sampled(size, linear)) < tolerance);
    CHECK(result.fallback_pixels == 0);
    CHECK(result.fits_of_order[2] == (order == 2 ? low_size.area() - 4 * 3 : 0));
}

TEST_CASE("a fit of order 2 rebuilds a quadratic exactly, one of order 1 does not", "[guided]") {
    const Extent size{48, 36};
    const Frame guide = flat_guide(size);
    const Frame low = frame_of(sampled({16, 12}, quadratic));
    const Image expected = sampled(size, quadratic);
    const auto error_inside = [&](int order) {
        const Image image = run("guided_fit", low, guide, size, order).image;
        double largest = 0;
        for (int y = 9; y < 27; ++y) {
            for (int x = 9; x < 39; ++x) {
                const glm::vec3 d = glm::abs(image(x, y) - expected(x, y));
                largest = std::max(largest, static_cast<double>(std::max({d.x, d.y, d.z})));
            }
        }
        return largest;
    };
    CHECK(error_inside(2) < 2e-6);
    CHECK(error_inside(1) > 1e-3);
}

TEST_CASE("a checker of albedos comes back exactly through demodulation", "[guided]") {
    const Extent size{48, 36};
    Frame guide = flat_guide(size);
    // Squares of one full-res pixel: every low-res pixel is a mixture of all of them.
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x)
            guide.albedo(x, y) = (x + y) % 2 == 0 ? glm::vec3(0.8f, 0.7f, 0.1f) : glm::vec3(0.2f);
    }
    const Image expected = lit(guide, Image(size, {0.5f, 2.0f, 7.0f}));
    for (const int factor : {1, 2, 4}) {
        const Frame low = frame_of(averaged(expected, reduced(size, factor)));
        const Reconstruction result = run("guided_fit", low, guide, size);
        CHECK(largest_difference(result.image, expected) < 2e-6);
    }
}

TEST_CASE("squares of low-res pixels under linear light come back exactly too", "[guided]") {
    const Extent size{48, 36};
    Frame guide = flat_guide(size);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x)
            guide.albedo(x, y) = glm::vec3((x / 3 + y / 3) % 2 == 0 ? 0.9f : 0.3f);
    }
    const Image expected = lit(guide, sampled(size, linear));
    const Frame low = frame_of(averaged(expected, {16, 12}));
    CHECK(largest_difference(run("guided_fit", low, guide, size).image, expected) < 2e-6);
}

TEST_CASE("where one surface ends and another begins the image is sharp", "[guided]") {
    const char* scheme = GENERATE("joint_bilateral", "guided_fit");
    const Extent size{48, 36};
    for (const int edge : {24, 25, 23, 22}) {
        CAPTURE(scheme, edge);
        const Frame guide = step_guide(size, edge);
        const Image expected = step_image(size, edge);
        const Frame low = frame_of(averaged(expected, {12, 9}));
        const Image image = run(scheme, low, guide, size).image;
        // A low-res pixel that shows both surfaces says a little of each.
        CHECK(largest_difference(image, expected) < (edge == 24 ? 1e-6 : 0.12));
    }
}

TEST_CASE("each plane by itself tells surfaces apart", "[guided]") {
    const char* scheme = GENERATE("joint_bilateral", "guided_fit");
    const Extent size{48, 36};
    const Frame whole = step_guide(size, 24);
    const Image expected = step_image(size, 24);
    const Frame low = frame_of(averaged(expected, {12, 9}));
    const auto error_with = [&](const Frame& guide) {
        return largest_difference(run(scheme, low, guide, size).image, expected);
    };
    Frame ids;
    ids.object_id = whole.object_id;
    CHECK(error_with(ids) < 1e-6);
    Frame positions;
    positions.position_world = whole.position_world;
    CHECK(error_with(positions) < 1e-3);
    Frame normals;
    normals.normal_world = whole.normal_world;
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < 24; ++x) normals.normal_world(x, y) = {1, 0, 0};
    }
    CHECK(error_with(normals) < 1e-6);
    Frame distances;
    distances.distance_world = Grid<float>(size, 1.0f);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < 24; ++x) distances.distance_world(x, y) = 2.0f;
    }
    CHECK(error_with(distances) < 1e-3);
}

TEST_CASE("a lamp leaves no halo: its light is taken off, then put back", "[guided]") {
    const char* scheme = GENERATE("joint_bilateral", "guided_fit");
    const Extent size{48, 36};
    Frame guide = flat_guide(size);
    for (int y = 13; y < 22; ++y) {
        for (int x = 14; x < 31; ++x) {
            guide.emission(x, y) = glm::vec3(15.0f);
            guide.albedo(x, y) = glm::vec3(0.0f);
        }
    }
    const Image expected = lit(guide, Image(size, glm::vec3(0.4f)));
    Frame low = frame_of(averaged(expected, {16, 12}));
    CHECK(largest_difference(run("guided_fit", low, guide, size).image, expected) < 1e-5);
    low.emission = averaged(guide.emission, {16, 12});
    CHECK(largest_difference(run("guided_fit", low, guide, size).image, expected) < 1e-5);
    // It does not know the albedo of mixed pixels, but no light of 15 is left over.
    CHECK(largest_difference(run(scheme, low, guide, size).image, expected) < 0.3);
}

TEST_CASE("a guide of several samples per pixel smooths edges", "[guided]") {
    const char* scheme = GENERATE("joint_bilateral", "guided_fit");
    const int scale = GENERATE(2, 4);
    const Extent size{24, 18};
    const Extent fine{size.width * scale, size.height * scale};
    const int edge = 12 * scale + scale / 2;  // half of a column of pixels
    const Frame guide = step_guide(fine, edge);
    const Frame low = frame_of(averaged(step_image(fine, edge), {12, 9}));
    const Image image = run(scheme, low, guide, size).image;
    for (int y = 0; y < size.height; ++y) {
        CHECK(image(11, y).x == Approx(1.0f).margin(0.02));
        CHECK(image(12, y).x == Approx(2.0f).margin(0.15));
        CHECK(image(13, y).x == Approx(3.0f).margin(0.15));
        CHECK(image(14, y).x == Approx(3.0f).margin(0.15));
    }
}

TEST_CASE("a mirror, whose albedo is 0, keeps its radiance", "[guided]") {
    const Extent size{48, 36};
    Frame guide = flat_guide(size);
    guide.albedo = Image(size);
    const Frame low = frame_of(sampled({16, 12}, linear));
    const Image image = run("guided_fit", low, guide, size).image;
    CHECK(largest_difference(image, sampled(size, linear)) < 2e-6);
}

TEST_CASE("misses are averaged among themselves, and a known background is put back", "[guided]") {
    const char* scheme = GENERATE("joint_bilateral", "guided_fit");
    const Extent size{48, 36};
    Frame guide = flat_guide(size);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < 24; ++x) {
            guide.object_id(x, y) = kMiss;
            guide.normal_world(x, y) = guide.position_world(x, y) = glm::vec3(0.0f);
            guide.albedo(x, y) = glm::vec3(0.0f);
        }
    }
    const Frame low = frame_of(averaged(step_image(size, 24), {12, 9}));
    Frame without_emission = guide;
    without_emission.emission = {};
    const Image image = run(scheme, low, without_emission, size).image;
    CHECK(largest_difference(image, step_image(size, 24)) < 1e-6);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < 24; ++x) guide.emission(x, y) = glm::vec3(1.0f);
    }
    CHECK(largest_difference(run(scheme, low, guide, size).image, step_image(size, 24)) < 1e-6);
}

TEST_CASE("where few neighbours are of a surface the order falls", "[guided]") {
    const Extent size{40, 40};
    Frame guide = flat_guide(size);
    for (int y = 0; y < size.height; ++y) {  // stripes of low-res pixels, each a surface
        for (int x = 0; x < size.width; ++x) guide.object_id(x, y) = x / 2;
    }
    const Frame low = frame_of(sampled({20, 20}, linear));
    const Reconstruction stripes = run("guided_fit", low, guide, size);
    // 5 samples, in a line.
    CHECK(stripes.fits_of_order == std::array<std::size_t, 3>{400, 0, 0});
    CHECK(stripes.fallback_pixels == 0);
    const Reconstruction constant = run("guided_fit", low, guide, size, 0);
    CHECK(constant.fits_of_order == std::array<std::size_t, 3>{400, 0, 0});
}

TEST_CASE("a fit does not run away from its samples", "[guided]") {
    const Extent size{60, 60};
    const Frame guide = flat_guide(size);
    Random random(5);
    Image noise({20, 20});
    for (glm::vec3& value : noise.values())
        value = random.chance(0.1f) ? random.vector() * 100.0f : random.vector();
    const Image image = run("guided_fit", frame_of(noise), guide, size).image;
    for (const glm::vec3& value : image.values()) {
        CHECK(std::min({value.x, value.y, value.z}) >= 0.0f);  // no sample is negative
        CHECK(std::max({value.x, value.y, value.z}) <= 130.0f);
    }
}

TEST_CASE("a full guide keeps a constant, and the bits of any number of threads", "[guided]") {
    const char* scheme = GENERATE("joint_bilateral", "guided_fit");
    const Extent size = GENERATE(values<Extent>({{48, 36}, {96, 72}}));
    const Frame guide = step_guide(size, 21);
    const Frame low = frame_of(Image({16, 12}, {0.1f, 0.7f, 13.3f}));
    const Image image = run(scheme, low, guide, {48, 36}).image;
    CHECK(same_bits(image, Image({48, 36}, {0.1f, 0.7f, 13.3f})));
    const Frame noisy = random_frame({16, 12}, FrameContent::awkward);
    const Reconstruction one = run(scheme, noisy, guide, {48, 36}, 2, 1);
    for (const int threads : {2, 7}) {
        const Reconstruction many = run(scheme, noisy, guide, {48, 36}, 2, threads);
        CHECK(same_bits(many.image, one.image));
        CHECK(many.fallback_pixels == one.fallback_pixels);
        CHECK(many.fits_of_order == one.fits_of_order);
    }
}

TEST_CASE("non-finite samples are left out and counted", "[guided]") {
    const char* scheme = GENERATE("joint_bilateral", "guided_fit");
    const Extent size{48, 36};
    const Frame guide = flat_guide(size);
    Frame low = frame_of(Image({16, 12}, glm::vec3(0.5f)));
    low.radiance(4, 4).x = kNaN;
    low.radiance(9, 3).y = kInfinity;
    low.emission = Image({16, 12});
    low.emission(1, 1).z = kNaN;
    const Reconstruction result = run(scheme, low, guide, size);
    CHECK(result.dropped_samples == 3);
    CHECK(result.non_finite_pixels == 0);
    CHECK(same_bits(result.image, Image(size, glm::vec3(0.5f))));
}

TEST_CASE("schemes with a guide say what guides they take", "[guided]") {
    const Extent size{48, 36};
    const Scheme& scheme = find_scheme("guided_fit");
    const Frame low = frame_of(Image({16, 12}));
    const auto error_with = [&](const Frame* guide, Extent wanted) {
        return error_of([&] { reconstruct(low, scheme, {wanted, scheme.defaults, 1, guide}); });
    };
    const Error none = error_with(nullptr, size);
    CHECK(none.code() == ExitCode::usage);
    CHECK(std::string(none.what()) ==
          "scheme \"guided_fit\": found no guide, allowed: with one (--guide)");
    const Frame guide = flat_guide(size);
    const Error other = error_with(&guide, {40, 36});
    CHECK(other.code() == ExitCode::mismatch);
    CHECK(std::string(other.what()) ==
          "guide: found a guide of 48x36, allowed: 40x36 or a whole multiple of it");
    CHECK(error_with(&guide, {48, 18}).code() == ExitCode::mismatch);  // twice as high alone
    Frame mixed = guide;
    mixed.albedo = Image({4, 4});
    CHECK_THAT(
        error_with(&mixed, size).what(),
        Catch::Matchers::Contains("found plane \"albedo\" of 4x4, allowed: 48x36, as the others"));
    Frame colours;
    colours.albedo = Image(size);
    CHECK_THAT(error_with(&colours, size).what(),
               Catch::Matchers::Contains("none of the planes position, normal, distance and id"));
}
