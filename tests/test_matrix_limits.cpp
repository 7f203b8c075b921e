// SPDX-License-Identifier: Apache-2.0
//
// Matrices that are sound but for what they would come to on a disk or in memory.
#include <nlohmann/json.hpp>

#include "eval/matrix.h"
#include "tests/catch.h"
#include "tests/error_of.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;

Json document_of(const std::string& scene) {
    return {{"name", "m"},
            {"axes", {{"scene", scene}, {"scheme", "mean"}, {"seed", {1, 2}}}},
            {"reference", {{"spp", 16}}}};
}

Error error_of_cells(const Json& document) {
    const Matrix matrix = matrix_of(document, "m.json");
    return error_of([&] { (void)expand(matrix); });
}

}  // namespace

TEST_CASE("axes that come to more cells than could ever run are refused at once", "[matrix]") {
    Json document = document_of("a.json");
    for (const char* axis : {"seed", "spp", "max_depth"}) {
        document["axes"][axis] = Json::array();
        for (int i = 1; i <= 100; ++i) document["axes"][axis].push_back(i);
    }
    const Error error = error_of_cells(document);
    CHECK(error.code() == ExitCode::usage);
    CHECK(std::string(error.what()) ==
          "m.json: /axes: found 1000000 cells, allowed: at most 100000");
    std::swap(document["axes"], document["include"][0]);
    document["axes"] = document_of("a.json")["axes"];
    CHECK(std::string(error_of_cells(document).what()) ==
          "m.json: /include/0: found 1000000 cells, allowed: at most 100000");
}

TEST_CASE("a cell's name has to do as that of a folder", "[matrix]") {
    const Error is_long = error_of_cells(document_of(std::string(190, 'a') + ".json"));
    CHECK(is_long.code() == ExitCode::usage);
    CHECK(std::string(is_long.what()) == "m.json: /axes: found the cell name " +
                                             std::string(60, 'a') +
                                             "... of 208 bytes, allowed: at most 200");
    const Error control = error_of_cells(document_of(std::string("a\0b.json", 8)));
    CHECK(control.code() == ExitCode::usage);
    CHECK(std::string(control.what()) ==
          "m.json: /axes: found the cell name a b.path.s1, allowed: names without control "
          "characters");
    CHECK_NOTHROW(expand(matrix_of(document_of(std::string(150, 'a') + ".json"), "m.json")));
}
