// SPDX-License-Identifier: Apache-2.0
//
// .vti files, read back by a reader that shares nothing with the writer; VTK's own is in
// test_vti.py.
#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/image_io.h"
#include "eval/comparison_vti.h"
#include "eval/metrics.h"
#include "eval/metrics_json.h"
#include "eval/pixel_maps.h"
#include "eval/vti.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/region_frames.h"
#include "tests/temp_dir.h"
#include "tests/vti_file.h"

using namespace vecino;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

/// Every value differs.
Image numbered(Extent size, float first) {
    Image image(size);
    for (glm::vec3& pixel : image.values())
        for (int c = 0; c < 3; ++c) pixel[c] = first = first + 0.0078125f;
    return image;
}

Frame numbered_frame(Extent size, float first) {
    Frame frame = flat_frame(size);
    frame.radiance = numbered(size, first);
    frame.position_world = numbered(size, -first);
    return frame;
}

bool same_bits(float a, float b) {
    return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
}

/// Over the values that are numbers.
double mean_of(const std::vector<float>& values) {
    double sum = 0;
    std::size_t count = 0;
    for (const float value : values) {
        if (std::isnan(value)) continue;
        sum += double(value);
        ++count;
    }
    return sum / static_cast<double>(count);
}

}  // namespace

TEST_CASE("a .vti file holds every value at its place, the bottom row first", "[vti]") {
    const TempDir dir;
    const Extent size{5, 3};
    Frame test = numbered_frame(size, 0.1f);
    Frame reference = numbered_frame(size, 0.4f);
    reference.object_id(4, 2) = 7;
    test.radiance(3, 0).y = kNaN;
    test.radiance(1, 2).z = -kInf;
    test.radiance(0, 1).x = -0.0f;
    const RegionMap regions = regions_of(reference);
    save_comparison_vti({test, reference, &regions, {}}, dir.path("a.vti"));
    const VtiRead read = read_vti(dir.path("a.vti"));
    CHECK(read.size == size);
    CHECK(read.tail == "\n  </AppendedData>\n</VTKFile>\n");
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            CAPTURE(x, y);
            for (std::size_t c = 0; c < 3; ++c) {
                const int channel = static_cast<int>(c);
                const float value = test.radiance(x, y)[channel];
                CHECK(same_bits(read.at("test", x, y, c), value));
                CHECK(read.at("reference", x, y, c) == reference.radiance(x, y)[channel]);
                CHECK(read.at("test_position", x, y, c) == test.position_world(x, y)[channel]);
                CHECK(read.at("reference_position", x, y, c) ==
                      reference.position_world(x, y)[channel]);
                const float error = value - reference.radiance(x, y)[channel];
                CHECK(same_bits(read.at("error", x, y, c), error));
            }
            CHECK(read.at("reference_id", x, y) == float(reference.object_id(x, y)));
            CHECK(read.at("region", x, y) == float(region_index(regions(x, y))));
        }
    }
    CHECK(std::isnan(read.at("error_magnitude", 3, 0)));
    CHECK(std::isnan(read.at("absolute_error", 1, 2)));
    CHECK(std::isfinite(read.at("absolute_error", 3, 2)));
    CHECK(dir.names() == std::set<std::string>{"a.vti"});
}

TEST_CASE("a .vti file says how it is to be read", "[vti]") {
    const TempDir dir;
    const Frame test = numbered_frame({4, 2}, 0.1f);
    const Frame reference = numbered_frame({4, 2}, 0.2f);
    save_comparison_vti({test, reference, nullptr, {{"psnr_db", 31.25}, {"ssim", nullptr}}},
                        dir.path("a.vti"));
    const VtiRead read = read_vti(dir.path("a.vti"));
    const std::string order =
        std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
    CHECK(
        read.head.starts_with("<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" "
                              "version=\"1.0\" byte_order=\"" +
                              order + "\" header_type=\"UInt64\">\n"));
    CHECK(read.head.find("<PointData Scalars=\"error_magnitude\">") != std::string::npos);
    CHECK(read.head.find("Name=\"psnr_db\" NumberOfTuples=\"1\" format=\"ascii\">31.25<") !=
          std::string::npos);
    CHECK(read.head.find("Name=\"ssim\" NumberOfTuples") == std::string::npos);  // null: no number
    for (const auto& [name, array] : read.arrays) {
        CAPTURE(name);
        CHECK(attribute_of(array.tag, "type") == "Float32");
        CHECK(array.values.size() == 8 * array.components);
    }
    CHECK(attribute_of(read.arrays.at("test").tag, "ComponentName2") == "B");
    CHECK(attribute_of(read.arrays.at("test_normal").tag, "ComponentName0") == "X");
    CHECK_FALSE(read.arrays.contains("region"));
    CHECK_FALSE(read.arrays.contains("test_variance"));
}

TEST_CASE("names in a .vti file stay within their attributes", "[vti]") {
    const TempDir dir;
    const VtiImage image{{1, 1},
                         {{"a\"<&", "m>", "", {}, [](std::size_t, std::size_t) { return 2.5f; }}},
                         {},
                         "a\"<&"};
    save_vti(image, dir.path("a.vti"));
    const VtiRead read = read_vti(dir.path("a.vti"));
    REQUIRE(read.order == std::vector<std::string>{"a&quot;&lt;&amp;"});
    CHECK(read.at("a&quot;&lt;&amp;", 0, 0) == 2.5f);
    CHECK(read.head.find(">m&gt;</InformationKey>") != std::string::npos);
}

TEST_CASE("the maps of a pair have the metrics as their means", "[vti]") {
    const Extent size{24, 17};
    const Image test = numbered(size, 0.0f);
    Image reference = numbered(size, 0.003f);
    reference(20, 9) = {0.9f, 0.1f, 3.0f};
    const Metrics metrics = *compare(test, reference).metrics;
    std::map<std::string, std::vector<float>> maps;
    for (const PixelMap& map : all_pixel_maps())
        maps[std::string(map.name)] = map.values(test, reference).values();
    CHECK(mean_of(maps.at("absolute_error")) == Approx(metrics.mae).epsilon(1e-6));
    CHECK(mean_of(maps.at("relative_squared_error")) == Approx(metrics.relmse).epsilon(1e-6));
    CHECK(mean_of(maps.at("ssim")) == Approx(*metrics.ssim).epsilon(1e-6));
    CHECK(std::ranges::count_if(maps.at("ssim"), [](float v) { return !std::isnan(v); }) == 14 * 7);
    std::vector<float> squares = maps.at("error_magnitude");
    for (float& value : squares) value *= value;
    CHECK(-10 * std::log10(mean_of(squares)) == Approx(*metrics.psnr_float_db).epsilon(1e-6));
    CHECK(std::ranges::all_of(maps,
                              [&](const auto& map) { return map.second.size() == size.area(); }));
}

TEST_CASE("a pixel without a number takes the ssim of the windows around it", "[vti]") {
    const Extent size{30, 14};
    Image test = numbered(size, 0.0f);
    const Image reference = numbered(size, 0.1f);
    const Grid<float> whole = ssim_values(test, reference);
    test(9, 6).z = kNaN;
    const Grid<float> holed = ssim_values(test, reference);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            CAPTURE(x, y);
            const bool is_inside = x >= 5 && y >= 5 && x < size.width - 5 && y < size.height - 5;
            const bool is_reached = std::abs(x - 9) <= 5 && std::abs(y - 6) <= 5;
            CHECK(std::isnan(whole(x, y)) != is_inside);
            CHECK(std::isnan(holed(x, y)) == (!is_inside || is_reached));
            if (is_inside && !is_reached) CHECK(holed(x, y) == whole(x, y));
        }
    }
    CHECK(std::isnan(ssim_values(Image({8, 8}), Image({8, 8}))(4, 4)));
}

TEST_CASE("a .vti file is whole or not there", "[vti]") {
    const TempDir dir;
    const Frame small = numbered_frame({4, 2}, 0.1f);
    const Frame large = numbered_frame({4, 3}, 0.1f);
    CHECK(error_of([&] {
              save_comparison_vti({small, large, nullptr, {}}, dir.path("a.vti"));
          }).code() == ExitCode::mismatch);
    CHECK(error_of([&] {
              save_comparison_vti({small, small, nullptr, {}}, dir.path("no/a.vti"));
          }).code() == ExitCode::file);
    CHECK(error_of([&] { save_vti({}, dir.path("a.vti")); }).code() == ExitCode::mismatch);
    CHECK(dir.names().empty());
}
