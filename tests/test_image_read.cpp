// SPDX-License-Identifier: Apache-2.0
//
// Files of other programs: which channels are colour, and what becomes of the rest.
#include <OpenImageIO/deepdata.h>
#include <OpenImageIO/imageio.h>

#include <limits>

#include "core/color.h"
#include "core/image_io.h"
#include "core/planes.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/foreign_image.h"
#include "tests/temp_dir.h"

using namespace vecino;
using Names = std::vector<std::string>;

namespace {

/// An EXR file of one pixel.
std::string write_exr_pixel(const TempDir& dir, const Names& channels,
                            const std::vector<float>& values) {
    std::string path = dir.path("foreign.exr");
    write_foreign(path, make_spec({1, 1}, channels, OIIO::TypeDesc::FLOAT), values);
    return path;
}

std::string mismatch_of(const std::string& path) {
    const Error error = error_of([&] { load_frame(path); });
    CHECK(error.code() == ExitCode::mismatch);
    return error.what();
}

}  // namespace

TEST_CASE("16-bit PNG is decoded from sRGB at its full precision", "[image_io]") {
    const TempDir dir;
    const std::vector<unsigned short> values = {0, 300, 30000, 30001, 65534, 65535};
    write_foreign(dir.path("a.png"), make_spec({2, 1}, {"R", "G", "B"}, OIIO::TypeDesc::UINT16),
                  values);
    const Image image = load_image(dir.path("a.png"));
    for (int i = 0; i < 6; ++i) {
        const float encoded = static_cast<float>(values[static_cast<std::size_t>(i)]) / 65535.0f;
        CHECK(image(i / 3, 0)[i % 3] == Approx(srgb_decode(encoded)).epsilon(1e-5));
    }
    CHECK(image(0, 0).b < image(1, 0).r);
}

TEST_CASE("alpha plays no part: a PNG with alpha 0 keeps its colours", "[image_io]") {
    const TempDir dir;
    OIIO::ImageSpec spec = make_spec({2, 1}, {"R", "G", "B", "A"}, OIIO::TypeDesc::UINT8);
    spec.alpha_channel = 3;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    write_foreign<unsigned char>(dir.path("a.png"), spec, {200, 100, 50, 0, 200, 100, 50, 128});
    const Image image = load_image(dir.path("a.png"));
    for (int x = 0; x < 2; ++x) {
        CHECK(image(x, 0).r == Approx(srgb_decode(200.0f / 255.0f)));
        CHECK(image(x, 0).g == Approx(srgb_decode(100.0f / 255.0f)));
        CHECK(image(x, 0).b == Approx(srgb_decode(50.0f / 255.0f)));
    }
}

TEST_CASE("grey becomes RGB, with or without alpha", "[image_io]") {
    const TempDir dir;
    const float grey = srgb_decode(77.0f / 255.0f);
    write_foreign<unsigned char>(dir.path("y.png"), make_spec({1, 1}, {"Y"}, OIIO::TypeDesc::UINT8),
                                 {77});
    OIIO::ImageSpec spec = make_spec({1, 1}, {"Y", "A"}, OIIO::TypeDesc::UINT8);
    spec.alpha_channel = 1;
    spec.attribute("oiio:UnassociatedAlpha", 1);
    write_foreign<unsigned char>(dir.path("ya.png"), spec, {77, 10});
    for (const char* name : {"y.png", "ya.png"}) {
        CAPTURE(name);
        const glm::vec3 pixel = load_image(dir.path(name))(0, 0);
        CHECK(pixel.r == Approx(grey));
        CHECK(pixel.g == pixel.r);
        CHECK(pixel.b == pixel.r);
    }
    CHECK(load_image(write_exr_pixel(dir, {"Y", "A"}, {2.5f, 0.0f}))(0, 0) == glm::vec3(2.5f));
}

TEST_CASE("8-bit TIFF is decoded from sRGB, half-float EXR is linear", "[image_io]") {
    const TempDir dir;
    write_foreign<unsigned char>(
        dir.path("a.tif"), make_spec({1, 1}, {"R", "G", "B"}, OIIO::TypeDesc::UINT8), {10, 20, 30});
    CHECK(load_image(dir.path("a.tif"))(0, 0).b == Approx(srgb_decode(30.0f / 255.0f)));
    const auto path = dir.path("a.exr");
    const auto spec = make_spec({1, 1}, {"R", "G", "B"}, OIIO::TypeDesc::HALF);
    const auto output = OIIO::ImageOutput::create(path);
    const float values[] = {0.5f, 2.0f, 0.25f};
    REQUIRE(output->open(path, spec));
    REQUIRE(output->write_image(OIIO::TypeDesc::FLOAT, values));
    REQUIRE(output->close());
    CHECK(load_image(path)(0, 0) == glm::vec3(0.5f, 2.0f, 0.25f));
}

TEST_CASE("channels are found by name, wherever they stand", "[image_io]") {
    const TempDir dir;
    const std::string path = write_exr_pixel(
        dir, {"N.Z", "Beauty.R", "B", "A", "N.X", "G", "crypto00", "Id", "N.Y", "R", "Z"},
        {0.3f, 9.0f, 3.0f, 0.5f, 0.1f, 2.0f, 8.0f, 4.0f, 0.2f, 1.0f, 7.0f});
    const Frame frame = load_frame(path);
    CHECK(planes_of(frame) == Planes{Plane::radiance, Plane::normal, Plane::id, Plane::distance});
    CHECK(frame.radiance(0, 0) == glm::vec3(1.0f, 2.0f, 3.0f));
    CHECK(frame.normal_world(0, 0) == glm::vec3(0.1f, 0.2f, 0.3f));
    CHECK(frame.object_id(0, 0) == 4);
    CHECK(frame.distance_world(0, 0) == 7.0f);
    CHECK(load_image(path) == frame.radiance);
}

TEST_CASE("an EXR file without colour is a mismatch that names its channels", "[image_io]") {
    const TempDir dir;
    const std::string path = write_exr_pixel(dir, {"Beauty.R", "Beauty.G", "Z"}, {1, 2, 3});
    const std::string message = mismatch_of(path);
    CHECK(message.starts_with(path + ": found channels "));
    for (const char* name : {"Beauty.R", "Beauty.G", "Z"}) {
        CHECK(message.find(name) != std::string::npos);
    }
    CHECK(message.ends_with(", allowed: R, G, B or Y among them"));
    CHECK(error_of([&] { load_image(path); }).code() == ExitCode::mismatch);
    mismatch_of(write_exr_pixel(dir, {"R", "G"}, {1, 2}));
    mismatch_of(write_exr_pixel(dir, {"Z"}, {1}));
}

TEST_CASE("some channels of a plane without the others are a mismatch", "[image_io]") {
    const TempDir dir;
    const std::string path = write_exr_pixel(dir, {"R", "G", "B", "P.X", "P.Y"}, {1, 2, 3, 4, 5});
    CHECK(mismatch_of(path) == path + ": found only channels P.X, P.Y, allowed: P.X, P.Y, P.Z");
    CHECK(load_image(path)(0, 0) == glm::vec3(1.0f, 2.0f, 3.0f));
}

TEST_CASE("an identity is rounded, and refused where it is no number", "[image_io]") {
    const TempDir dir;
    const Names names = {"R", "G", "B", "Id"};
    CHECK(load_frame(write_exr_pixel(dir, names, {0, 0, 0, 2.9999f})).object_id(0, 0) == 3);
    CHECK(load_frame(write_exr_pixel(dir, names, {0, 0, 0, -1.0f})).object_id(0, 0) == kMiss);
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(),
                            std::numeric_limits<float>::infinity(), 2147483648.0f, -3.0e9f}) {
        const std::string path = write_exr_pixel(dir, names, {0, 0, 0, bad});
        const Error error = error_of([&] { load_frame(path); });
        CHECK(error.code() == ExitCode::non_finite);
        CHECK(std::string(error.what()) ==
              path + ": found " + std::to_string(bad) +
                  " at pixel (0, 0), channel Id, allowed: 32-bit integers");
    }
}

TEST_CASE("integers in a plane are refused, since OpenImageIO would scale them", "[image_io]") {
    const TempDir dir;
    const std::string path = dir.path("a.exr");
    OIIO::ImageSpec spec = make_spec({1, 1}, {"R", "G", "B", "Id"}, OIIO::TypeDesc::FLOAT);
    spec.channelformats = {OIIO::TypeDesc::FLOAT, OIIO::TypeDesc::FLOAT, OIIO::TypeDesc::FLOAT,
                           OIIO::TypeDesc::UINT32};
    const auto output = OIIO::ImageOutput::create(path);
    const float values[] = {1.0f, 2.0f, 3.0f, 0.0f};
    REQUIRE(output->open(path, spec));
    REQUIRE(output->write_image(OIIO::TypeDesc::FLOAT, values));
    REQUIRE(output->close());
    CHECK(mismatch_of(path) ==
          path + ": found integers in channel Id, allowed: floating-point values");
    CHECK(load_image(path)(0, 0) == glm::vec3(1.0f, 2.0f, 3.0f));
}

TEST_CASE("the pixels of a data window are the image", "[image_io]") {
    const TempDir dir;
    OIIO::ImageSpec spec = make_spec({2, 1}, {"R", "G", "B"}, OIIO::TypeDesc::FLOAT);
    spec.x = 10;
    spec.y = -4;
    spec.full_width = 100;
    spec.full_height = 50;
    write_foreign<float>(dir.path("a.exr"), spec, {1, 2, 3, 4, 5, 6});
    const Image image = load_image(dir.path("a.exr"));
    CHECK(image.size() == Extent{2, 1});
    CHECK(image(1, 0) == glm::vec3(4, 5, 6));
}

TEST_CASE("a tiled EXR file is read like any other", "[image_io]") {
    const TempDir dir;
    OIIO::ImageSpec spec = make_spec({70, 40}, {"R", "G", "B"}, OIIO::TypeDesc::FLOAT);
    spec.tile_width = spec.tile_height = 32;
    std::vector<float> values(70 * 40 * 3);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i);
    write_foreign(dir.path("a.exr"), spec, values);
    const Image image = load_image(dir.path("a.exr"));
    REQUIRE(image.size() == Extent{70, 40});
    CHECK(image(69, 39) == glm::vec3(8397, 8398, 8399));
    CHECK(image(33, 2) == glm::vec3(519, 520, 521));
}

TEST_CASE("of a multi-part EXR file the first part is read", "[image_io]") {
    const TempDir dir;
    const std::string path = dir.path("a.exr");
    OIIO::ImageSpec specs[] = {make_spec({1, 1}, {"R", "G", "B"}, OIIO::TypeDesc::FLOAT),
                               make_spec({2, 2}, {"R", "G", "B"}, OIIO::TypeDesc::FLOAT)};
    specs[0].full_width = specs[0].full_height = 2;  // parts share the display window
    specs[0].attribute("oiio:subimagename", "first");
    specs[1].attribute("oiio:subimagename", "second");
    const std::vector<float> values(12, 5.0f);
    const auto output = OIIO::ImageOutput::create(path);
    REQUIRE(output->open(path, 2, specs));
    REQUIRE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()));
    REQUIRE(output->open(path, specs[1], OIIO::ImageOutput::AppendSubimage));
    REQUIRE(output->write_image(OIIO::TypeDesc::FLOAT, values.data()));
    REQUIRE(output->close());
    CHECK(load_image(path).size() == Extent{1, 1});
}

TEST_CASE("a deep EXR file is refused", "[image_io]") {
    const TempDir dir;
    const std::string path = dir.path("deep.exr");
    OIIO::ImageSpec spec = make_spec({1, 1}, {"R", "G", "B", "A", "Z"}, OIIO::TypeDesc::FLOAT);
    spec.deep = true;
    OIIO::DeepData pixels(spec);
    const auto output = OIIO::ImageOutput::create(path);
    REQUIRE(output->open(path, spec));
    REQUIRE(output->write_deep_image(pixels));
    REQUIRE(output->close());
    const Error error = error_of([&] { load_image(path); });
    CHECK(error.code() == ExitCode::file);
    CHECK(std::string(error.what()) ==
          path + ": cannot be read: deep and volume images are not supported");
}
