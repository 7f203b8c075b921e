// SPDX-License-Identifier: Apache-2.0
//
// What we write, and that we read it back. Files of others: test_image_read.cpp. Faults:
// test_image_faults.cpp.
#include "core/image_io.h"

#include <OpenImageIO/imageio.h>

#include <limits>
#include <set>

#include "core/color.h"
#include "core/planes.h"
#include "tests/catch.h"
#include "tests/temp_dir.h"
#include "tests/test_images.h"

using namespace vecino;

namespace {

OIIO::ImageSpec spec_of(const std::string& path) {
    const auto input = OIIO::ImageInput::open(path);
    REQUIRE(input);
    return input->spec();
}

std::set<std::string> channels_of(const std::string& path) {
    const std::vector<std::string> names = spec_of(path).channelnames;
    return {names.begin(), names.end()};
}

/// The values of a file as they stand there, three bytes a pixel.
std::vector<unsigned char> bytes_of(const std::string& path) {
    const auto input = OIIO::ImageInput::open(path);
    REQUIRE(input);
    REQUIRE(input->spec().nchannels == 3);
    std::vector<unsigned char> bytes(input->spec().image_pixels() * 3);
    REQUIRE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, bytes.data()));
    return bytes;
}

}  // namespace

TEST_CASE("a frame with all planes comes back from EXR bit for bit", "[image_io]") {
    const TempDir dir;
    const Frame frame = make_frame({70, 131}, Planes::all());
    save_frame(frame, dir.path("all.exr"));
    const Frame loaded = load_frame(dir.path("all.exr"));
    for (const PlaneInfo& info : all_planes()) {
        CAPTURE(info.name);
        CHECK(
            std::visit([&](auto member) { return frame.*member == loaded.*member; }, info.member));
    }
    CHECK(dir.names() == std::set<std::string>{"all.exr"});
}

TEST_CASE("a frame with some planes comes back with these and no others", "[image_io]") {
    const TempDir dir;
    const Planes planes = {Plane::radiance, Plane::id, Plane::normal};
    const Frame frame = make_frame({5, 3}, planes);
    save_frame(frame, dir.path("some.exr"));
    const Frame loaded = load_frame(dir.path("some.exr"));
    CHECK(planes_of(loaded) == planes);
    CHECK(loaded.radiance == frame.radiance);
    CHECK(loaded.object_id == frame.object_id);
    CHECK(loaded.normal_world == frame.normal_world);
    CHECK(load_image(dir.path("some.exr")) == frame.radiance);
}

TEST_CASE("the channels of an EXR file have the names of the design", "[image_io]") {
    const TempDir dir;
    save_frame(make_frame({4, 4}, Planes::all()), dir.path("all.exr"));
    CHECK(channels_of(dir.path("all.exr")) ==
          std::set<std::string>{
              "R",          "G",          "B",          "Direct.R",   "Direct.G",   "Direct.B",
              "Indirect.R", "Indirect.G", "Indirect.B", "Emission.R", "Emission.G", "Emission.B",
              "Albedo.R",   "Albedo.G",   "Albedo.B",   "P.X",        "P.Y",        "P.Z",
              "N.X",        "N.Y",        "N.Z",        "Z",          "Id",         "SampleCount",
              "Variance.R", "Variance.G", "Variance.B"});
    save_image(make_image({4, 4}), dir.path("one.exr"));
    CHECK(channels_of(dir.path("one.exr")) == std::set<std::string>{"R", "G", "B"});
}

TEST_CASE("an EXR file is 32-bit float, zip-compressed and without a date", "[image_io]") {
    const TempDir dir;
    save_frame(make_frame({4, 4}, {Plane::radiance, Plane::id}), dir.path("a.exr"));
    const OIIO::ImageSpec spec = spec_of(dir.path("a.exr"));
    for (int c = 0; c < spec.nchannels; ++c) CHECK(spec.channelformat(c) == OIIO::TypeDesc::FLOAT);
    CHECK(spec.get_string_attribute("compression") == "zip");
    CHECK(spec.find_attribute("DateTime") == nullptr);
}

TEST_CASE("metadata are attributes of an EXR file under their own names", "[image_io]") {
    const TempDir dir;
    const Metadata metadata = {{"scene", "cornell"}, {"spp", 64},          {"seed", 7},
                               {"depth", 2},         {"sampler", "sobol"}, {"version", "0.1.0"},
                               {"seconds", 1.25f}};
    save_frame(make_frame({4, 4}, {Plane::radiance}), dir.path("a.exr"), metadata);
    const OIIO::ImageSpec spec = spec_of(dir.path("a.exr"));
    CHECK(spec.get_string_attribute("scene") == "cornell");
    CHECK(spec.get_int_attribute("spp") == 64);
    CHECK(spec.get_int_attribute("seed") == 7);
    CHECK(spec.get_int_attribute("depth") == 2);
    CHECK(spec.get_string_attribute("sampler") == "sobol");
    CHECK(spec.get_string_attribute("version") == "0.1.0");
    CHECK(spec.get_float_attribute("seconds") == 1.25f);
}

TEST_CASE("float formats keep radiance", "[image_io]") {
    const auto extension = GENERATE(".exr", ".tif", ".tiff", ".EXR", ".Tif");
    CAPTURE(extension);
    const TempDir dir;
    const std::string path = dir.path(std::string("a") + extension);
    const Image image = make_image({67, 130});
    save_image(image, path);
    CHECK(load_image(path) == image);
    CHECK(dir.names().size() == 1);
}

TEST_CASE("RGBE keeps radiance to a 256th of the largest channel", "[image_io]") {
    const TempDir dir;
    const Image image = make_image({67, 130});
    save_image(image, dir.path("a.hdr"));
    const Image loaded = load_image(dir.path("a.hdr"));
    REQUIRE(loaded.size() == image.size());
    for (std::size_t i = 0; i < image.values().size(); ++i) {
        const glm::vec3 truth = image.values()[i], found = loaded.values()[i];
        const float step = std::max({truth.r, truth.g, truth.b}) / 128.0f;  // of the mantissa
        for (int c = 0; c < 3; ++c) {
            if (std::abs(found[c] - truth[c]) > step) FAIL("pixel " << i << " channel " << c);
        }
    }
}

TEST_CASE("RGBE clips what it cannot hold and leaves the rest of the pixel alone", "[image_io]") {
    const TempDir dir;
    Image image({2, 1});
    image(0, 0) = {-1.0f, 0.5f, 0.25f};
    image(1, 0) = {3.0e38f, 0.0f, 0.0f};
    save_image(image, dir.path("a.hdr"));
    const Image loaded = load_image(dir.path("a.hdr"));
    CHECK(loaded(0, 0).r < 0.01f);
    CHECK(loaded(0, 0).g == Approx(0.5).epsilon(0.01));
    CHECK(loaded(1, 0).r == Approx(1.0e38).epsilon(0.01));
}

TEST_CASE("8-bit formats hold radiance clipped and sRGB-encoded", "[image_io]") {
    const auto extension = GENERATE(".png", ".bmp");
    CAPTURE(extension);
    const TempDir dir;
    const std::string path = dir.path(std::string("a") + extension);
    Image image({2, 2});
    image(0, 0) = {0.0f, 0.5f, 1.0f};
    image(1, 0) = {-3.0f, 0.0031308f, 7.0f};
    image(0, 1) = {0.18f, 0.2f, 0.002f};
    image(1, 1) = {std::numeric_limits<float>::lowest(), 1.0f, std::numeric_limits<float>::max()};
    save_image(image, path);
    // 0.5 -> 0.7354, 0.0031308 -> 0.04045, 0.18 -> 0.4614, 0.2 -> 0.4845, 0.002 -> 0.02584
    CHECK(bytes_of(path) ==
          std::vector<unsigned char>{0, 188, 255, 0, 10, 255, 118, 124, 7, 0, 255, 255});
    CHECK(dir.names().size() == 1);
}

TEST_CASE("every 8-bit value survives decoding and encoding", "[image_io]") {
    const auto extension = GENERATE(".png", ".bmp");
    CAPTURE(extension);
    const TempDir dir;
    Grid<glm::u8vec3> raster({256, 3});
    for (int x = 0; x < 256; ++x) {
        for (int y = 0; y < 3; ++y) raster(x, y) = {x, 255 - x, (x + 85 * y) % 256};
    }
    const std::string first = dir.path(std::string("first") + extension);
    const std::string second = dir.path(std::string("second") + extension);
    save_raster(raster, first);
    const Image decoded = load_image(first);
    for (int x = 0; x < 256; ++x) {
        CHECK(decoded(x, 0).r == Approx(srgb_decode(static_cast<float>(x) / 255.0f)).margin(1e-6));
    }
    save_image(decoded, second);
    const auto* values = reinterpret_cast<const unsigned char*>(raster.values().data());
    const std::vector<unsigned char> expected(values, values + raster.values().size() * 3);
    CHECK(bytes_of(first) == expected);
    CHECK(bytes_of(second) == expected);
}

TEST_CASE("a frame of one pixel can be written in every format", "[image_io]") {
    const TempDir dir;
    for (const char* name : {"a.exr", "a.hdr", "a.tif", "a.tiff", "a.png", "a.bmp"}) {
        CAPTURE(name);
        save_frame(make_frame({1, 1}, Planes::all()), dir.path(name));
        CHECK(load_frame(dir.path(name)).size() == Extent{1, 1});
    }
    CHECK(dir.names().size() == 6);
}

TEST_CASE("NaN and infinity survive EXR", "[image_io]") {
    const TempDir dir;
    Image image({2, 1});
    image(0, 0).g = std::numeric_limits<float>::quiet_NaN();
    image(1, 0).b = -std::numeric_limits<float>::infinity();
    save_image(image, dir.path("a.exr"));
    const Image loaded = load_image(dir.path("a.exr"));
    CHECK(std::isnan(loaded(0, 0).g));
    CHECK(loaded(1, 0).b == -std::numeric_limits<float>::infinity());
    CHECK(loaded(1, 0).r == 0.0f);
}

TEST_CASE("writing replaces the file that is there", "[image_io]") {
    const TempDir dir;
    const std::string path = dir.write("a.png", "old");
    save_image(make_image({4, 4}), path);
    CHECK(load_image(path).size() == Extent{4, 4});
    CHECK(dir.names() == std::set<std::string>{"a.png"});
}

TEST_CASE("the same frame makes the same bytes", "[image_io]") {
    const TempDir dir;
    const Frame frame = make_frame({64, 65}, Planes::all());
    for (const std::string extension : {".exr", ".hdr", ".tif", ".png", ".bmp"}) {
        CAPTURE(extension);
        save_frame(frame, dir.path("a" + extension));
        save_frame(frame, dir.path("b" + extension));
        CHECK(dir.read("a" + extension) == dir.read("b" + extension));
    }
}

TEST_CASE("the extensions that can be written are listed and accepted", "[image_io]") {
    CHECK(writable_extensions() == ".exr, .hdr, .tif, .tiff, .png, .bmp");
    CHECK_NOTHROW(require_writable_extension("out/image.PNG"));
}
