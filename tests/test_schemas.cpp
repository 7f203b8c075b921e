// SPDX-License-Identifier: Apache-2.0
//
// The JSON Schemas against the readers that they stand beside. test_schemas.py holds them against
// documents.
#include <algorithm>
#include <set>
#include <sstream>

#include "core/files.h"
#include "core/scene.h"
#include "eval/failure.h"
#include "eval/matrix.h"
#include "eval/matrix_schema.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/temp_dir.h"

using namespace vecino;
using nlohmann::json;

namespace {

using Names = std::set<std::string>;

json sound_matrix() {
    const std::string path = VECINO_SOURCE_DIR "/tests/data/faulty_matrices.json";
    return json::parse(read_file(path)).at("sound");
}

/// What the matrix reader names as allowed where the value at a place is a wrong one.
Names allowed_by_reader(const std::string& place, const json& wrong) {
    const TempDir dir;
    json matrix = sound_matrix();
    matrix[json::json_pointer(place)] = wrong;
    const std::string path = dir.write("m.json", matrix.dump());
    const std::string message = error_of([&] { expand(load_matrix(path)); }).what();
    const std::string mark = "allowed: ";
    std::istringstream list(message.substr(message.find(mark) + mark.size()));
    Names names;
    for (std::string name; std::getline(list >> std::ws, name, ',');) names.insert(name);
    return names;
}

/// Where the schema describes what stands at a place of a matrix.
std::string place_in_schema(const std::string& place) {
    std::string schema;
    std::istringstream parts(place.substr(1));
    for (std::string part; std::getline(parts, part, '/');)
        schema += part == "0" ? "/items" : "/properties/" + part;
    return schema;
}

/// The keys of the object that a schema describes at a place of its own.
Names keys_at(const std::string& place) {
    const json whole = matrix_schema();
    const json* schema = &whole.at(json::json_pointer(place));
    if (schema->contains("$ref")) {
        schema = &whole.at(json::json_pointer(schema->at("$ref").get<std::string>().substr(1)));
    }
    Names names;
    for (const auto& [key, value] : schema->at("properties").items()) names.insert(key);
    return names;
}

}  // namespace

TEST_CASE("the schemas that editors read are those of the program", "[schema]") {
    INFO(
        "remake: vecino schema scene > scenes/scene.schema.json, the same for configs/matrix, "
        "scenes/failure");
    CHECK(json::parse(read_file(VECINO_SOURCE_DIR "/scenes/scene.schema.json")) == scene_schema());
    CHECK(json::parse(read_file(VECINO_SOURCE_DIR "/configs/matrix.schema.json")) ==
          matrix_schema());
    CHECK(json::parse(read_file(VECINO_SOURCE_DIR "/scenes/failure.schema.json")) ==
          failure_schema());
}

TEST_CASE("the schema of matrices has the keys that the reader allows", "[schema]") {
    CHECK(allowed_by_reader("/?", 1) == keys_at(""));
    for (const std::string part :
         {"/axes", "/exclude/0", "/include/0", "/fixed", "/reference", "/measure", "/reproduction",
          "/reproduction/times_at", "/reproduction/variants/0", "/reproduction/variants/0/where",
          "/reproduction/items/0", "/reproduction/claims/0", "/reproduction/claims/0/tests/0",
          "/reproduction/graphs/0", "/reproduction/figures/0"}) {
        CAPTURE(part);
        CHECK(allowed_by_reader(part + "/?", 1) == keys_at(place_in_schema(part)));
    }
}

TEST_CASE("the schema of matrices has the names that the reader allows", "[schema]") {
    const json schema = matrix_schema();
    const json& fixed = schema.at("properties").at("fixed").at("properties");
    std::size_t choices = 0;
    for (const auto& [key, value] : fixed.items()) {
        if (!value.contains("enum") || !value.at("enum").front().is_string()) continue;
        CAPTURE(key);
        CHECK(allowed_by_reader("/fixed/" + key, "?") == value.at("enum").get<Names>());
        ++choices;
    }
    CHECK(choices >= 7);
    for (const std::string choice :
         {"items/0/unit", "items/0/quantity", "claims/0/tests/0/quantity", "claims/0/tests/0/is",
          "figures/0/kind"}) {
        const std::string place = "/reproduction/" + choice;
        CAPTURE(place);
        const json names = schema.at(json::json_pointer(place_in_schema(place))).at("enum");
        CHECK(allowed_by_reader(place, "?") == names.get<Names>());
    }
}
