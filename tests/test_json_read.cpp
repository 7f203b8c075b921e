// SPDX-License-Identifier: Apache-2.0
#include "core/json_read.h"

#include <limits>

#include "core/error.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/temp_dir.h"

using namespace vecino;
using nlohmann::json;

namespace {

const std::string kScene = R"({
  "camera": {"position": [0, 1, 4.2], "vertical_fov_degrees": 34.5, "size": [1, 2]},
  "materials": {"a/b": {"albedo": "red"}, "m~n": {"albedo": [0, 1, "x"]}},
  "spp": 64, "seed": 3.0, "ratio": 1.5, "mirror": true, "name": "box", "minus": -3,
  "objects": [{"material": "white"}, {"materiel": "white"}]
})";

const json& scene_json() {
    static const json document = parse_json_text(kScene, "scene.json");
    return document;
}

JsonValue scene() {
    return {scene_json(), "scene.json"};
}

/// What the call says, given the root of the scene; its code must be that of bad content.
template <class Call>
std::string complaint(Call&& call) {
    const Error error = error_of([&] { call(scene()); });
    CHECK(error.code() == ExitCode::usage);
    return error.what();
}

std::string parse_complaint(const std::string& text) {
    const Error error = error_of([&] { parse_json_text(text, "s.json"); });
    CHECK(error.code() == ExitCode::usage);
    std::string message = error.what();
    CHECK(message.find('\n') == std::string::npos);
    return message;
}

}  // namespace

TEST_CASE("values of the right type and range are read", "[json]") {
    const JsonValue root = scene();
    CHECK(root.at("spp").integer(1, 100) == 64);
    CHECK(root.at("seed").integer(0, 10) == 3);
    CHECK(root.at("ratio").number() == 1.5);
    CHECK(root.at("minus").real({-3, 0}) == -3.0f);
    CHECK(root.at("mirror").boolean());
    CHECK(root.at("name").string() == "box");
    CHECK(root.at("camera").at("position").vec3() == glm::vec3(0.0f, 1.0f, 4.2f));
    CHECK(root.has("spp"));
    CHECK_FALSE(root.has("ssp"));
    CHECK_FALSE(root.at("spp").has("anything"));
}

TEST_CASE("elements and members know where they stand", "[json]") {
    const std::vector<JsonValue> objects = scene().at("objects").elements();
    REQUIRE(objects.size() == 2);
    CHECK(objects[1].pointer() == "/objects/1");
    CHECK(objects[1].file() == "scene.json");
    const auto materials = scene().at("materials").members();
    REQUIRE(materials.size() == 2);
    CHECK(materials[0].first == "a/b");
    CHECK(materials[0].second.pointer() == "/materials/a~1b");
    CHECK(materials[1].second.pointer() == "/materials/m~0n");
}

TEST_CASE("an unknown key is named beside the allowed ones", "[json]") {
    CHECK(complaint([](const JsonValue& root) {
              root.at("objects").elements()[1].require_keys({"quad", "material"});
          }) == "scene.json: /objects/1: found unknown key \"materiel\", allowed: quad, material");
    CHECK(complaint([](const JsonValue& root) {
              root.at("objects").elements()[0].require_keys({});
          }) == "scene.json: /objects/0: found unknown key \"material\", allowed: none");
}

TEST_CASE("known keys pass", "[json]") {
    CHECK_NOTHROW(scene().at("objects").elements()[0].require_keys({"quad", "material"}));
}

TEST_CASE("a missing key is named with the object that lacks it", "[json]") {
    CHECK(complaint([](const JsonValue& root) { return root.at("camera").at("look_at"); }) ==
          "scene.json: /camera: found no key \"look_at\", allowed: an object that has it");
    CHECK(complaint([](const JsonValue& root) { return root.at("camara"); }) ==
          "scene.json: /: found no key \"camara\", allowed: an object that has it");
}

TEST_CASE("a value of the wrong type is shown with the type that is allowed", "[json]") {
    CHECK(complaint([](const JsonValue& root) { return root.at("name").number(); }) ==
          "scene.json: /name: found \"box\", allowed: a number");
    CHECK(complaint([](const JsonValue& root) { return root.at("mirror").number(); }) ==
          "scene.json: /mirror: found true, allowed: a number");
    CHECK(complaint([](const JsonValue& root) { return root.at("mirror").integer(0, 1); }) ==
          "scene.json: /mirror: found true, allowed: an integer from 0 to 1");
    CHECK(complaint([](const JsonValue& root) { return root.at("spp").boolean(); }) ==
          "scene.json: /spp: found 64, allowed: true or false");
    CHECK(complaint([](const JsonValue& root) { return root.at("spp").string(); }) ==
          "scene.json: /spp: found 64, allowed: a string");
    CHECK(complaint([](const JsonValue& root) { return root.at("spp").elements(); }) ==
          "scene.json: /spp: found 64, allowed: an array");
    CHECK(complaint([](const JsonValue& root) { return root.at("spp").members(); }) ==
          "scene.json: /spp: found 64, allowed: an object");
    CHECK(complaint([](const JsonValue& root) { return root.at("spp").at("x"); }) ==
          "scene.json: /spp: found 64, allowed: an object");
    CHECK(complaint([](const JsonValue& root) { root.at("name").require_keys({"x"}); }) ==
          "scene.json: /name: found \"box\", allowed: an object");
}

TEST_CASE("a number out of range is shown with the range", "[json]") {
    CHECK(complaint([](const JsonValue& root) {
              return root.at("minus").number({0, 10});
          }) == "scene.json: /minus: found -3, allowed: a number from 0 to 10");
    CHECK(complaint([](const JsonValue& root) { return root.at("minus").number({.least = 0}); }) ==
          "scene.json: /minus: found -3, allowed: a number of at least 0");
    CHECK(complaint([](const JsonValue& root) { return root.at("spp").number({.most = 0.5}); }) ==
          "scene.json: /spp: found 64, allowed: a number of at most 0.5");
    CHECK(complaint([](const JsonValue& root) { return root.at("spp").integer(1, 32); }) ==
          "scene.json: /spp: found 64, allowed: an integer from 1 to 32");
    constexpr int most = std::numeric_limits<int>::max();
    CHECK(complaint([](const JsonValue& root) { return root.at("minus").integer(1, most); }) ==
          "scene.json: /minus: found -3, allowed: an integer of at least 1");
}

TEST_CASE("the bounds themselves are in range", "[json]") {
    CHECK(scene().at("spp").number({64, 64}) == 64.0);
    CHECK(scene().at("spp").integer(64, 64) == 64);
}

TEST_CASE("an integer has no fraction and no more than 32 bits", "[json]") {
    CHECK(complaint([](const JsonValue& root) { return root.at("ratio").integer(0, 10); }) ==
          "scene.json: /ratio: found 1.5, allowed: an integer from 0 to 10");
    const json large = 18446744073709551615u;
    constexpr int most = std::numeric_limits<int>::max();
    CHECK_THROWS_AS(JsonValue(large, "f").integer(-most, most), Error);
    CHECK(JsonValue(json(1e4), "f").integer(0, 100000) == 10000);
}

TEST_CASE("a real fits a finite float", "[json]") {
    const json huge = 1e39, tiny = 1e-60, double_range = 3.2e38;
    CHECK(std::string(error_of([&] { return JsonValue(huge, "f").real(); }).what()) ==
          "f: /: found 1e+39, allowed: a number from -3e+38 to 3e+38");
    CHECK_THROWS_AS(JsonValue(huge, "f").real({.most = 1e300}), Error);
    CHECK(JsonValue(double_range, "f").real({.most = 1e300}) == 3.2e38f);
    CHECK(JsonValue(tiny, "f").real() == 0.0f);
    CHECK_THROWS_AS(JsonValue(tiny, "f").real({.least = 1e-300}), Error);
}

TEST_CASE("a vector is three numbers", "[json]") {
    CHECK(complaint([](const JsonValue& root) { return root.at("camera").at("size").vec3(); }) ==
          "scene.json: /camera/size: found 2 elements, allowed: 3 numbers");
    CHECK(complaint([](const JsonValue& root) { return root.at("name").vec3(); }) ==
          "scene.json: /name: found \"box\", allowed: 3 numbers");
    CHECK(complaint([](const JsonValue& root) {
              return root.at("materials").at("m~n").at("albedo").vec3({0, 1});
          }) == "scene.json: /materials/m~0n/albedo/2: found \"x\", allowed: a number from 0 to 1");
}

TEST_CASE("a long value is shortened between characters", "[json]") {
    const json value = std::string(58, 'a') + "\u00e9\u00e9";  // the 60th byte would cut the first
    const std::string message = error_of([&] { return JsonValue(value, "f").number(); }).what();
    CHECK(message == "f: /: found \"" + std::string(58, 'a') + "..., allowed: a number");
}

TEST_CASE("an error is one line whatever the keys are", "[json]") {
    const json value = {{"a\nb", 1}};
    const std::string message =
        error_of([&] { return JsonValue(value, "f\ng").at("a\nb").string(); }).what();
    CHECK(message == "f g: /a b: found 1, allowed: a string");
}

TEST_CASE("text that is no JSON is refused with line, column and reason", "[json]") {
    struct Fault {
        std::string text, place, reason;
    };
    const Fault faults[] = {
        {"", "line 1, column 1", "unexpected end of input"},
        {"{\n  \"a\": 1,\n}", "line 3, column 1", "unexpected '}'"},
        {"[1,\n2", "line 2, column 2", "unexpected end of input"},
        {"{} x", "line 1, column 4", "expected end of input"},
        {"[NaN]", "line 1, column 2", "invalid literal"},
        {"// note\n{}", "line 1, column 1", "invalid literal"},
        {"[\"\xff\"]", "line 1, column 3", "ill-formed UTF-8"},
        {"[\"a\nb\"]", "line 1, column 4", "control character U+000A"},
        {"[1,\n 1e999]", "line 2, column 6", "number overflow parsing '1e999'"},
    };
    for (const Fault& fault : faults) {
        const std::string message = parse_complaint(fault.text);
        CAPTURE(fault.text, message);
        CHECK(message.starts_with("s.json: " + fault.place + ": "));
        CHECK(message.find(fault.reason) != std::string::npos);
        CHECK(message.find("json.exception") == std::string::npos);
    }
}

TEST_CASE("a parse error stays short where the text is long", "[json]") {
    CHECK(parse_complaint("[\"" + std::string(1000000, 'x') + "\n").size() < 300);
}

TEST_CASE("a doubled key is named with its place", "[json]") {
    CHECK(parse_complaint(R"({"a": [0, {"b": 1, "c/d": 2, "b": 3}]})") ==
          "s.json: /a/1: found the key \"b\" twice, allowed: every key once");
    CHECK(parse_complaint(R"({"a": 1, "a": {}})") ==
          "s.json: /: found the key \"a\" twice, allowed: every key once");
}

TEST_CASE("a key may stand again in another object", "[json]") {
    const std::string text = R"({"a": {"a": 1}, "b": [{"a": 2}, {"a": []}]})";
    CHECK(parse_json_text(text, "s.json") == json::parse(text));
}

TEST_CASE("every kind of value is parsed as nlohmann parses it", "[json]") {
    const std::string text =
        R"([null, true, -1, 18446744073709551615, 2.5, "x\u00e9", {}, [], [[1]]])";
    CHECK(parse_json_text(text, "s.json") == json::parse(text));
    CHECK(parse_json_text("7", "s.json") == json(7));
}

TEST_CASE("bottomless nesting is refused, deep nesting is not", "[json]") {
    CHECK(parse_complaint(std::string(1000000, '[')) ==
          "s.json: /: found values nested deeper than 100, allowed: at most 100 levels");
    CHECK_NOTHROW(parse_json_text(std::string(100, '[') + std::string(100, ']'), "s.json"));
    CHECK_THROWS_AS(parse_json_text(std::string(101, '[') + std::string(101, ']'), "s.json"),
                    Error);
}

TEST_CASE("a JSON file that cannot be read is a file error with the system's reason", "[json]") {
    const TempDir dir;
    const std::string missing = dir.path("missing.json");
    const Error error = error_of([&] { parse_json_file(missing); });
    CHECK(error.code() == ExitCode::file);
    CHECK(std::string(error.what()) == missing + ": cannot be read: No such file or directory");
    const Error directory = error_of([&] { parse_json_file(dir.path("")); });
    CHECK(directory.code() == ExitCode::file);
    CHECK(std::string(directory.what()) == dir.path("") + ": cannot be read: it is a directory");
}

TEST_CASE("errors of a JSON file carry the path as it was given", "[json]") {
    const TempDir dir;
    const std::string path = dir.write("bad.json", "[1,]");
    const Error error = error_of([&] { parse_json_file(path); });
    CHECK(error.code() == ExitCode::usage);
    CHECK(std::string(error.what()).starts_with(path + ": line 1, column 4: "));
    CHECK(parse_json_file(dir.write("good.json", kScene)) == scene_json());
}

TEST_CASE("names are joined with commas", "[json]") {
    const std::vector<std::string_view> names = {"a", "b", "c"};
    CHECK(join(names) == "a, b, c");
    CHECK(join({}).empty());
}
