// SPDX-License-Identifier: Apache-2.0
#include "eval/gate_classes.h"
#include "tests/catch.h"
#include "tests/error_of.h"

using namespace vecino;
using nlohmann::json;

namespace {

std::vector<GateClass> read(const json& gates) {
    const json matrix{{"gates", gates}};
    return read_gate_classes(JsonValue(matrix, "m.json"));
}

std::string error_text(const json& gates) {
    const Error error = error_of([&] { read(gates); });
    CHECK(error.code() == ExitCode::usage);
    return error.what();
}

const json kPath{{"class", "path tracing"}, {"where", {{"method", "path"}}}};

}  // namespace

TEST_CASE("a cell is of the first class that matches, else of the default one", "[gate]") {
    const auto classes =
        read({kPath, {{"class", "all at 16"}, {"where", {{"spp", 16}}}, {"k_sigma", 2}}});
    REQUIRE(classes.size() == 3);
    const auto name = [&](const json& params) { return class_of(classes, params).name; };
    CHECK(name({{"method", "path"}, {"spp_asked", 16}}) == "path tracing");
    CHECK(name({{"method", "mean"}, {"spp_asked", 16}}) == "all at 16");
    CHECK(name({{"method", "mean"}, {"spp_asked", 4}}) == "default");
}

TEST_CASE("without gates, all cells are of the default class: mean, edges, worst tile, tail",
          "[gate]") {
    const json matrix = json::object();
    const auto classes = read_gate_classes(JsonValue(matrix, "m.json"));
    REQUIRE(classes.size() == 1);
    std::vector<std::string> names;
    for (const auto& [metric, tolerance] : classes.front().tolerance_db) {
        names.push_back(metric.name);
        CHECK(tolerance > 0);
    }
    CHECK(names == std::vector<std::string>{"psnr_float_db", "edge.psnr_float_db",
                                            "worst_tile_psnr_db", "p99_error"});
    CHECK(classes.front().k_sigma == 3);
    CHECK_FALSE(classes.front().time_tolerance);
}

TEST_CASE("a tolerance is one number, or one per metric that is judged", "[gate]") {
    json gate = kPath;
    gate["tolerance_db"] = 0.7;
    const GateClass one_number = read(json::array({gate})).front();
    for (const auto& [metric, tolerance] : one_number.tolerance_db) CHECK(tolerance == 0.7);
    gate["tolerance_db"] = {{"interior.relmse", 0.3}};
    gate["time_tolerance_percent"] = 25;
    const GateClass read_back = read(json::array({gate})).front();
    REQUIRE(read_back.tolerance_db.size() == 1);
    CHECK(read_back.tolerance_db.front().first.name == "interior.relmse");
    CHECK(read_back.time_tolerance.value() == 0.25);
    gate["tolerance_db"] = json::object();
    CHECK(read(json::array({gate})).front().tolerance_db.empty());
}

TEST_CASE("a faulty gate is named with its place", "[gate]") {
    const auto changed = [](const char* key, const json& value) {
        json gate = kPath;
        gate[key] = value;
        return json::array({gate});
    };
    CHECK(error_text(changed("tolerance_db", -1)).find("m.json: /gates/0/tolerance_db: found -1") ==
          0);
    CHECK(error_text(changed("tolerance_db", {{"psnr", 1}})).find("found \"psnr\", allowed: ") !=
          std::string::npos);
    CHECK(error_text(changed("class", "default")).find("/gates/0/class") != std::string::npos);
    CHECK(error_text(changed("where", {{"methods", "path"}})).find("methods") != std::string::npos);
    CHECK(error_text(changed("sigma", 3)).find("sigma") != std::string::npos);
    CHECK(error_text({kPath, kPath}).find("/gates/1/class") != std::string::npos);
    CHECK(error_text(json::array({json::object()})).find("class") != std::string::npos);
}
