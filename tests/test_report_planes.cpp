// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "core/files.h"
#include "core/image_io.h"
#include "eval/html_text.h"
#include "eval/report.h"
#include "eval/report_pictures.h"
#include "eval/report_planes.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/page_text.h"
#include "tests/tiny_run.h"

using namespace vecino;

namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInf = std::numeric_limits<float>::infinity();

std::string decoded(const std::string& base64) {
    const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string bytes;
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : base64) {
        if (c == '=') break;
        bits = bits << 6 | static_cast<std::uint32_t>(digits.find(c));
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes += static_cast<char>(bits >> count & 0xffu);
    }
    return bytes;
}

std::uint32_t word(const std::string& bytes, std::size_t at, int size) {
    std::uint32_t value = 0;
    for (int i = size - 1; i >= 0; --i)
        value = value << 8 | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
    return value;
}

/// IEEE 754 binary16, written out: what the page's script does, too.
float from_half(std::uint32_t bits) {
    const float sign = (bits & 0x8000u) != 0 ? -1.0f : 1.0f;
    const auto exponent = static_cast<int>(bits >> 10 & 31u);
    const auto fraction = static_cast<float>(bits & 1023u) / 1024;
    if (exponent == 31) return fraction > 0 ? kNan : sign * kInf;
    return sign *
           (exponent == 0 ? std::ldexp(fraction, -14) : std::ldexp(1 + fraction, exponent - 15));
}

std::string plane_data(const std::string& script) {
    return decoded(between(script, "},\"", "\");"));
}

/// Pixels of all kinds.
Image odd_image() {
    Image image({3, 1});
    image(0, 0) = {0.1f, -2.5f, 1e-40f};
    image(1, 0) = {kNan, kInf, -kInf};
    image(2, 0) = {123456.789f, 0.0f, -0.0f};
    return image;
}

}  // namespace

TEST_CASE("a plane holds the very bits of its image", "[report][planes]") {
    const Image image = odd_image();
    const std::string bytes = decoded(plane_base64(image));
    REQUIRE(bytes.size() == 3 * 12);
    for (int x = 0; x < 3; ++x) {
        for (int c = 0; c < 3; ++c) {
            CAPTURE(x, c);
            const auto at = static_cast<std::size_t>(12 * x + 4 * c);
            CHECK(word(bytes, at, 4) == std::bit_cast<std::uint32_t>(image(x, 0)[c]));
        }
    }
}

TEST_CASE("differences in half precision are as exact as halves are", "[report][planes]") {
    const Image image = odd_image();
    Image reference({3, 1}, {0.25f, 0.5f, 0.75f});
    reference(2, 0) = {1.0f, kNan, 3e5f};
    const std::string bytes = decoded(difference_base64(image, reference));
    REQUIRE(bytes.size() == 3 * 6);
    const auto half = [&](int x, int c) {
        return from_half(word(bytes, static_cast<std::size_t>(6 * x + 2 * c), 2));
    };
    for (int c = 0; c < 3; ++c) {
        const float difference = image(0, 0)[c] - reference(0, 0)[c];
        CHECK(std::abs(half(0, c) - difference) <= std::ldexp(std::abs(difference), -11));
    }
    CHECK(std::isnan(half(1, 0)));
    CHECK(half(1, 1) == kInf);
    CHECK(half(1, 2) == -kInf);
    CHECK(half(2, 0) == 65504.0f);  // finite, though out of reach
    CHECK(half(2, 1) == 0.0f);      // the value itself: the reference is no number
    CHECK(half(2, 2) == -65504.0f);
}

TEST_CASE("what the page shows lies beside it as scripts with the files' floats",
          "[report][planes]") {
    const TinyMatrix matrix;
    matrix.run();
    const ReportData data = read_report_data(matrix.directory);
    write_report(data);
    const std::string planes = matrix.directory + "/planes/";
    for (const GroupSummary& group : data.groups) {
        const std::string& cell = group.cells.front();
        CAPTURE(cell);
        const std::string script = read_file(planes + "cells/" + cell + ".js");
        CHECK(
            has(script, "vecinoPlane({\"height\":12,\"id\":\"cells/" + cell + "\",\"width\":16},"));
        CHECK((plane_data(script) == decoded(plane_base64(load_image(matrix.image_file(cell))))));
    }
    const std::string file = data.rows[0]["reference_file"];
    CHECK((plane_data(read_file(planes + file + ".js")) ==
           decoded(plane_base64(load_image(matrix.directory + "/" + file + ".exr")))));
}

TEST_CASE("only the seed that is shown has a plane", "[report][planes]") {
    const TinyMatrix matrix;
    matrix.run();
    write_report(read_report_data(matrix.directory));
    const std::string cells = matrix.directory + "/planes/cells/";
    CHECK(std::filesystem::exists(cells + "box.nearest.f2.s1.js"));
    CHECK_FALSE(std::filesystem::exists(cells + "box.nearest.f2.s2.js"));
}

TEST_CASE("a plane is written again only when its image changed", "[report][planes]") {
    namespace fs = std::filesystem;
    const TinyMatrix matrix;
    matrix.run();
    write_report(read_report_data(matrix.directory));
    const std::string changed = matrix.directory + "/planes/cells/box.nearest.f2.s1.js";
    const std::string kept = matrix.directory + "/planes/cells/box.mean.f2.w3.s1.js";
    const auto long_ago = fs::last_write_time(kept) - std::chrono::hours(1);
    for (const std::string& path : {changed, kept}) fs::last_write_time(path, long_ago);
    Image image = load_image(matrix.image_file("box.nearest.f2.s1"));
    image(3, 4).y += 1;
    save_image(image, matrix.image_file("box.nearest.f2.s1"));
    write_report(read_report_data(matrix.directory));
    CHECK(fs::last_write_time(kept) == long_ago);
    CHECK(fs::last_write_time(changed) > long_ago);
    CHECK((plane_data(read_file(changed)) == decoded(plane_base64(image))));
}

TEST_CASE("a page names the planes' folder as seen from itself", "[report][planes]") {
    const TinyMatrix matrix;
    matrix.run();
    const ReportData data = read_report_data(matrix.directory);
    const auto folder = [&](const std::string& page) {
        std::filesystem::create_directories(std::filesystem::path(page).parent_path());
        return embedded_data(read_file(write_report(data, page)))["viewer"]["folder"];
    };
    CHECK(folder(matrix.directory + "/report.html") == "planes");
    CHECK(folder(matrix.temp.path("page.html")) == "run/planes");
    CHECK(folder(matrix.temp.path("a b/page.html")) == "../run/planes");
}

TEST_CASE("embedded values make a page that loads no script and writes no plane",
          "[report][planes]") {
    const TinyMatrix matrix;
    matrix.run();
    const ReportData data = read_report_data(matrix.directory);
    std::filesystem::remove_all(matrix.directory + "/planes");
    const std::string page = read_file(write_report(data, "", PlanePrecision::float32));
    CHECK_FALSE(std::filesystem::exists(matrix.directory + "/planes"));
    CHECK(has(page, "script-src 'unsafe-inline'\""));
    const std::string cell = "box.mean.f2.w3.s1";
    CHECK((decoded(between(between(page, "data-id=\"cells/" + cell, "/script>"), ">", "<")) ==
           decoded(plane_base64(load_image(matrix.image_file(cell))))));
    CHECK(embedded_data(page)["viewer"]["embedded"] == true);
    CHECK(embedded_data(page)["viewer"]["precision"] == "float32");

    const std::string beside = read_file(write_report(data));
    CHECK(has(beside, "script-src 'unsafe-inline' file: 'self'\""));
    CHECK_FALSE(has(beside, "class=\"plane\""));
}

TEST_CASE("a precision that there is not is refused with those that there are",
          "[report][planes]") {
    CHECK(parse_precision("float16") == PlanePrecision::float16);
    const auto error = error_of([] { parse_precision("float64"); });
    CHECK(error.code() == ExitCode::usage);
    CHECK(has(error.what(), "found \"float64\", allowed: float32, float16"));
}
