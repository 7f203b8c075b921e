// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "core/error.h"
#include "eval/colour_map.h"
#include "eval/error_map.h"
#include "eval/text.h"
#include "tests/catch.h"

using namespace vecino;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
using Picture = Grid<glm::u8vec3>;

std::size_t count(const Picture& picture, glm::u8vec3 colour) {
    return static_cast<std::size_t>(
        std::count(picture.values().begin(), picture.values().end(), colour));
}

/// Drawn text and lines are dark; maps in these tests are not.
bool has_ink(const Picture& picture) {
    return std::any_of(picture.values().begin(), picture.values().end(),
                       [](glm::u8vec3 c) { return c.r < 128; });
}

const TextStyle kText{10.0, {0, 0, 0}, false};

}  // namespace

TEST_CASE("a small map is enlarged to at least 384 pixels by a whole factor", "[error_picture]") {
    struct Case {
        Extent size;
        std::size_t scale;
    };
    const auto c =
        GENERATE(Case{{1, 1}, 384}, Case{{21, 21}, 19}, Case{{64, 64}, 6}, Case{{300, 40}, 2},
                 Case{{40, 300}, 2}, Case{{384, 200}, 1}, Case{{512, 512}, 1});
    CAPTURE(c.size.width, c.size.height);
    const Picture picture = error_picture(Grid<float>(c.size, kNaN), {});
    const std::size_t map_pixels = c.size.area() * c.scale * c.scale;
    const std::size_t swatch_pixels = count(picture, kNonFiniteColour) - map_pixels;
    CHECK(swatch_pixels == 100);
}

TEST_CASE("an enlarged pixel is a square of one colour", "[error_picture]") {
    Grid<float> values({2, 1}, 0.05f);
    values(1, 0) = kNaN;
    CHECK(count(error_picture(values, {}), kNonFiniteColour) == 192 * 192 + 100);
}

TEST_CASE("a picture has room for more than its map", "[error_picture]") {
    const auto size = GENERATE(Extent{1, 1}, Extent{600, 400}, Extent{2000, 100}, Extent{3, 1500});
    const Picture picture = error_picture(Grid<float>(size, 0.0f), {});
    CHECK(picture.size().width > size.width + 80);
    CHECK(picture.size().height > size.height + 60);
}

TEST_CASE("the colour bar shows both ends of the range whatever the map holds", "[error_picture]") {
    const auto kind = GENERATE(ErrorKind::magnitude, ErrorKind::sign);
    const ErrorPictureStyle style{kind, 0.5f, ""};
    const float bottom = kind == ErrorKind::sign ? -0.5f : 0.0f;
    const Picture picture = error_picture(Grid<float>({8, 8}, 0.2f), style);
    for (const float value : {bottom, 0.5f})
        CHECK(count(picture, error_colours(Grid<float>({1, 1}, value), style)(0, 0)) > 0);
}

TEST_CASE("a picture has a swatch for non-finite pixels only if there are any", "[error_picture]") {
    Grid<float> values({400, 20}, 0.05f);
    CHECK(count(error_picture(values, {}), kNonFiniteColour) == 0);
    values(399, 19) = kNaN;
    CHECK(count(error_picture(values, {}), kNonFiniteColour) == 1 + 100);
}

TEST_CASE("a picture tells how many pixels are not finite", "[error_picture]") {
    Grid<float> one({400, 20}, 0.05f);
    one(0, 0) = kNaN;
    Grid<float> two = one;
    two(1, 0) = kNaN;
    const Picture first = error_picture(one, {}), second = error_picture(two, {});
    REQUIRE(first.size() == second.size());
    std::size_t differing = 0;
    for (std::size_t i = 0; i < first.values().size(); ++i)
        differing += first.values()[i] == second.values()[i] ? 0u : 1u;
    CHECK(differing > 1);  // the pixel itself, and the count below
}

TEST_CASE("values beyond the range look like the range but are reported", "[error_picture]") {
    const ErrorPictureStyle style{ErrorKind::magnitude, 0.1f, ""};
    const Grid<float> at({4, 4}, 0.1f);
    Grid<float> beyond = at;
    beyond(2, 2) = 0.3f;
    CHECK(error_colours(at, style) == error_colours(beyond, style));
    CHECK_FALSE(error_picture(at, style) == error_picture(beyond, style));
}

TEST_CASE("the tick values follow the range", "[error_picture]") {
    const Grid<float> zero({4, 4}, 0.0f);
    CHECK_FALSE(error_picture(zero, {ErrorKind::magnitude, 0.1f, ""}) ==
                error_picture(zero, {ErrorKind::magnitude, 0.2f, ""}));
}

TEST_CASE("the same values give the same picture", "[error_picture]") {
    Grid<float> values({31, 17});
    for (std::size_t i = 0; i < values.values().size(); ++i)
        values.values()[i] = static_cast<float>(i % 97) / 800.0f;
    const ErrorPictureStyle style{ErrorKind::sign, 0.1f, "cornell"};
    CHECK(error_picture(values, style) == error_picture(values, style));
}

TEST_CASE("a title of any length neither widens the picture nor takes more than three lines",
          "[error_picture]") {
    const Grid<float> values({64, 64}, 0.05f);
    const auto size_with = [&](const std::string& title) {
        return error_picture(values, {ErrorKind::magnitude, 0.1f, title}).size();
    };
    std::string long_title, endless_title;
    for (int i = 0; i < 20; ++i) long_title += "word ";
    for (int i = 0; i < 50; ++i) endless_title += long_title;
    CHECK(size_with("").height < size_with("cornell").height);
    CHECK(size_with("cornell").height < size_with(long_title).height);
    CHECK(size_with(endless_title).height == size_with(long_title + long_title).height);
    CHECK(size_with(endless_title).width == size_with("").width);
}

TEST_CASE("the title is written on the picture", "[error_picture]") {
    const Grid<float> values({64, 64}, 0.05f);
    CHECK_FALSE(error_picture(values, {ErrorKind::magnitude, 0.1f, "nearest"}) ==
                error_picture(values, {ErrorKind::magnitude, 0.1f, "mean"}));
}

TEST_CASE("a map without pixels has no picture", "[error_picture]") {
    CHECK_THROWS_AS(error_picture(Grid<float>{}, {}), Error);
}

TEST_CASE("wrapped lines fit the box and lose nothing that has room", "[text]") {
    const std::string text =
        "cornell_sphere.distance3d_normal.f2.w7.s1 against the reference of 4096 samples";
    const int width = GENERATE(120, 200, 300, 2000);
    CAPTURE(width);
    const std::vector<std::string> lines = wrap_text(text, {width, 20}, kText);
    std::string joined;
    for (const std::string& line : lines) {
        CHECK(text_width(line, kText) <= width);
        joined += line;
    }
    const auto without_spaces = [](std::string s) {
        s.erase(std::remove(s.begin(), s.end(), ' '), s.end());
        return s;
    };
    CHECK(without_spaces(joined) == without_spaces(text));
    CHECK((lines.size() == 1) == (width == 2000));
}

TEST_CASE("lines break after spaces and punctuation, not within words", "[text]") {
    const int width = text_width("alpha beta ga", kText);
    CHECK(wrap_text("alpha beta gamma", {width, 3}, kText) ==
          std::vector<std::string>{"alpha beta", "gamma"});
    CHECK(wrap_text("alpha.beta.gamma", {width, 3}, kText) ==
          std::vector<std::string>{"alpha.beta.", "gamma"});
}

TEST_CASE("text that does not fit its lines ends in dots, inside the box", "[text]") {
    const std::vector<std::string> lines = wrap_text(std::string(500, 'm'), {150, 2}, kText);
    REQUIRE(lines.size() == 2);
    CHECK(lines[1].substr(lines[1].size() - 3) == "...");
    CHECK(text_width(lines[0], kText) <= 150);
    CHECK(text_width(lines[1], kText) <= 150);
}

TEST_CASE("wrapping ends for empty text and for boxes narrower than a letter", "[text]") {
    CHECK(wrap_text("", {100, 3}, kText).empty());
    CHECK(wrap_text(" \n ", {100, 3}, kText).empty());
    CHECK(wrap_text("abcdefgh", {1, 3}, kText) == std::vector<std::string>{"a", "b", "c..."});
}

TEST_CASE("text stands on its baseline and is cut where the picture ends", "[text]") {
    const glm::u8vec3 white{255, 255, 255};
    Picture picture({60, 40}, white);
    draw_text(picture, "H", {10, 30}, kText);
    int top = 40, bottom = -1;
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 60; ++x)
            if (picture(x, y).r < 128) {
                top = std::min(top, y);
                bottom = std::max(bottom, y);
            }
    CHECK(std::abs(bottom - 30) <= 1);
    CHECK(std::abs(top - 20) <= 1);

    Picture corner({8, 8}, white), outside({8, 8}, white);
    draw_text(corner, "HHHHHH", {-4, 10}, kText);
    CHECK(has_ink(corner));
    draw_text(outside, "H", {100, 100}, kText);
    CHECK_FALSE(has_ink(outside));
}
