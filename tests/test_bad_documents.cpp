// SPDX-License-Identifier: Apache-2.0
//
// Scenes and matrices that are sound but for one thing, from tables that test_schemas.py reads too;
// and files that are no JSON.
#include <nlohmann/json.hpp>
#include <vector>

#include "core/files.h"
#include "tests/bad_input.h"
#include "tests/catch.h"

using namespace vecino;
using namespace vecino::test;
using nlohmann::json;

namespace {

json table(const std::string& name) {
    return json::parse(read_file(std::string(VECINO_SOURCE_DIR) + "/tests/data/" + name));
}

/// The document with the fault's value at its place, or without what stands there.
json changed(json document, const json& fault) {
    const json::json_pointer place(fault.at("at").get<std::string>());
    if (fault.contains("put")) {
        document[place] = fault.at("put");
    } else {
        document.at(place.parent_pointer()).erase(place.back());
    }
    return document;
}

/// Writes a file for each fault of a table and lists what the program must say to it, given the
/// words before and after the file's name.
std::vector<Mistake> write_faults(const TempDir& dir, const json& faulty, const std::string& before,
                                  const std::string& after) {
    std::vector<Mistake> mistakes;
    for (const json& fault : faulty.at("faults")) {
        const std::string file = "faulty-" + std::to_string(mistakes.size()) + ".json";
        dir.write(file, changed(faulty.at("sound"), fault).dump());
        const auto error = fault.at("error").get<std::string>();
        mistakes.push_back({error, before + file + after, 64, file + ": " + error});
    }
    return mistakes;
}

}  // namespace

TEST_CASE("a faulty scene is refused: where, what was found, what is allowed", "[bad_input]") {
    const TempDir dir;
    const json faulty = table("faulty_scenes.json");
    check_mistakes(dir, write_faults(dir, faulty, "render ", " -o out.exr --size 4x4 --spp 1"));
    dir.write("sound.json", faulty.at("sound").dump());
    check_success(dir, "render sound.json -o out.exr --size 4x4 --spp 1");
}

TEST_CASE("a faulty matrix is refused: where, what was found, what is allowed", "[bad_input]") {
    const TempDir dir;
    const json faulty = table("faulty_matrices.json");
    dir.write("scene.json", table("faulty_scenes.json").at("sound").dump());
    check_mistakes(dir, write_faults(dir, faulty, "run ", " -o out"));
    dir.write("sound.json", faulty.at("sound").dump());
    check_success(dir, "run sound.json -o out --only path.s1");
}

TEST_CASE("a faulty failure is refused: where, what was found, what is allowed", "[bad_input]") {
    const TempDir dir;
    const json faulty = table("faulty_failures.json");
    dir.write("scene.json", table("faulty_scenes.json").at("sound").dump());
    json matrix{
        {"name", "m"}, {"axes", {{"scheme", "nearest"}, {"seed", 1}}}, {"reference", {{"spp", 1}}}};
    auto mistakes = write_faults(dir, faulty, "", "");
    for (Mistake& mistake : mistakes) {
        matrix["failures"] = {mistake.line};
        dir.write("of-" + mistake.line, matrix.dump());
        mistake.line = "run of-" + mistake.line + " -o out";
    }
    check_mistakes(dir, mistakes);
    dir.write("sound.failure.json", faulty.at("sound").dump());
    matrix["failures"] = {"sound.failure.json"};
    dir.write("sound.json", matrix.dump());
    check_success(dir, "run sound.json -o out --dry-run");
}

TEST_CASE("a file that is no JSON is refused with line, column and reason", "[bad_input]") {
    const TempDir dir;
    dir.write("empty.json", "");
    dir.write("letter.json", "This is a letter to my landlord.\n");
    dir.write("cut.json", "{\"camera\": {\"position\": [0, ");
    dir.write("twice.json", "{\"camera\": 1, \"camera\": 2}");
    dir.write("nan.json", "{\"background\": [NaN, 0, 0]}");
    dir.write("infinity.json", "{\"background\": [0, Infinity, 0]}");
    dir.write("huge.json", "{\"background\": [0, 0, 1e999]}");
    dir.write("deep.json", std::string(100000, '['));
    dir.write("bytes.json", "{\"name\": \"\xff\xfe\"}");
    dir.write("comment.json", "{} // a scene");
    const std::vector<Mistake> faults = {
        {"nothing", "empty.json", 64, ": line 1, column 1: unexpected end of input"},
        {"prose", "letter.json", 64, ": line 1, column 1: "},
        {"half a file", "cut.json", 64, ": line 1, column 29: "},
        {"a doubled key", "twice.json", 64, ": /: found the key \"camera\" twice"},
        {"not a number", "nan.json", 64, ": line 1, column 17: "},
        {"infinity", "infinity.json", 64, ": line 1, column 20: "},
        {"a number beyond all range", "huge.json", 64, ": line 1, column 27: number overflow"},
        {"bottomless nesting", "deep.json", 64, ": /: found values nested deeper than 100"},
        {"bytes that are no text", "bytes.json", 64, ": line 1, column 11: "},
        {"a comment", "comment.json", 64, ": line 1, column 4: "},
        {"no file", "missing.json", 4, ": cannot be read: No such file or directory"},
        {"a folder", ".", 4, ": cannot be read: it is a directory"},
    };
    std::vector<Mistake> mistakes;
    for (const auto& [name, file, code, reason] : faults) {
        mistakes.push_back({name, "render " + file + " -o out.exr", code, file + reason});
        mistakes.push_back({name, "run " + file + " -o out", code, file + reason});
        mistakes.push_back({name, "list cells " + file, code, file + reason});
    }
    check_mistakes(dir, mistakes);
}
