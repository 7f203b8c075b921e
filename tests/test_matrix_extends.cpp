// SPDX-License-Identifier: Apache-2.0
//
// Matrices that extend others, methods beside schemes, ceilings and budgets.
#include <algorithm>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "eval/frame_jobs.h"
#include "eval/matrix.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/temp_dir.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;
namespace fs = std::filesystem;

Json base_matrix() {
    return Json::parse(R"({
        "name": "base",
        "axes": {"scene": ["../scenes/box.json", "../scenes/hall.json"], "scheme": ["nearest", "mean"],
                 "reduction": 2, "window": [3, 5]},
        "exclude": [{"scheme": "mean", "window": 5}],
        "include": [{"scheme": "distance2d", "window": 3}],
        "fixed": {"size": [8, 6], "spp": 4},
        "reference": {"spp": 64, "light_sampling": "nee", "seed": 1000},
        "measure": {"repeat": 3}})");
}

/// A folder of matrices; scenes are named, and not there.
struct Folder {
    TempDir temp;

    std::string write(const std::string& name, const Json& json) const {
        fs::create_directories(fs::path(temp.path(name)).parent_path());
        return temp.write(name, json.dump());
    }
    /// Of base_matrix() and a matrix that extends it.
    [[nodiscard]] Matrix extended(Json own, const std::string& name = "configs/own.json") const {
        write("configs/base.json", base_matrix());
        if (!own.contains("extends")) own["extends"] = "base.json";
        own["name"] = "own";
        return load_matrix(write(name, own));
    }
};

Matrix matrix_of(const Json& json) {
    Matrix matrix;
    matrix.file = "configs/test.json";
    matrix.document = json;
    return matrix;
}

Names names_of(const std::vector<Cell>& cells) {
    Names names;
    for (const Cell& cell : cells) names.push_back(cell.name);
    std::ranges::sort(names);
    return names;
}

Names names_with(const std::vector<Cell>& cells, const std::string& part) {
    Names names = names_of(cells);
    std::erase_if(names, [&](const auto& name) { return name.find(part) == std::string::npos; });
    return names;
}

std::string message_of(const auto& call) {
    const Error error = error_of(call);
    CHECK(error.code() == ExitCode::usage);
    return error.what();
}

}  // namespace

TEST_CASE("axes, fixed, reference and measure are extended key by key", "[matrix_extends]") {
    const Folder folder;
    const Matrix own = folder.extended({{"axes", {{"reduction", 3}, {"seed", {1, 2}}}},
                                        {"fixed", {{"spp", 16}}},
                                        {"reference", {{"spp", 128}}},
                                        {"measure", {{"repeat", 5}}}});
    CHECK(own.name == "own");
    CHECK(own.repeat == 5);
    CHECK(own.reference.spp == 128);
    CHECK(own.reference.seed == 1000);
    CHECK(own.reference.light_sampling == LightSampling::nee);
    CHECK_FALSE(own.document.contains("extends"));
    const auto cells = expand(own);
    for (const Cell& cell : cells) {
        CHECK(cell.settings.size == Extent{8, 6});
        if (cell.kind != CellKind::blocky_ceiling) CHECK(cell.settings.spp == 16);
    }
    CHECK(names_with(cells, "box.nearest") == Names{"box.nearest.f3.s1", "box.nearest.f3.s2"});
    CHECK(names_with(cells, "hall.mean") == Names{"hall.mean.f3.w3.s1", "hall.mean.f3.w3.s2"});
    CHECK(names_with(cells, "box.distance2d").size() == 2);
}

TEST_CASE("the other parts of an extended matrix are replaced as a whole", "[matrix_extends]") {
    const Folder folder;
    const auto cells = expand(
        folder.extended({{"exclude", Json::array({{{"scheme", "nearest"}}})},
                         {"include", Json::array({{{"scheme", "distance3d"}, {"window", 7}}})}}));
    CHECK(names_with(cells, "box.nearest").empty());
    CHECK(names_with(cells, "box.mean") == Names{"box.mean.f2.w3.s1", "box.mean.f2.w5.s1"});
    CHECK(names_with(cells, "box.distance") == Names{"box.distance3d.f2.w7.s1"});
}

TEST_CASE("a matrix that says nothing new makes the cells of the one it extends",
          "[matrix_extends]") {
    const Folder folder;
    const auto own = expand(folder.extended(Json::object()));
    const auto base = expand(load_matrix(folder.temp.path("configs/base.json")));
    REQUIRE(own.size() == base.size());
    for (std::size_t i = 0; i < own.size(); ++i) {
        CHECK(own[i].name == base[i].name);
        CHECK(own[i].parameters_json() == base[i].parameters_json());
    }
}

TEST_CASE("scenes of an extended matrix stay where they are", "[matrix_extends]") {
    const std::string name = GENERATE(
        values<std::string>({"own.json", "else/own.json", "else/deep/own.json",
                             "configs/deep/../own.json", "else/../configs/deep/own.json"}));
    CAPTURE(name);
    const Folder folder;
    fs::create_directories(folder.temp.path("else"));
    fs::create_directories(folder.temp.path("configs/deep"));
    const auto own_folder = fs::path(folder.temp.path(name)).parent_path();
    const auto relative = [&](const std::string& file) {
        return fs::path(folder.temp.path(file)).lexically_relative(own_folder.lexically_normal());
    };
    const Json own = {{"extends", relative("configs/base.json").string()}};
    std::set<std::string> scenes;
    for (const Cell& cell : expand(folder.extended(own, name))) scenes.insert(cell.scene);
    CHECK(scenes == std::set<std::string>{folder.temp.path("scenes/box.json"),
                                          folder.temp.path("scenes/hall.json")});
    // Excludes and includes of one's own meet the base's scenes.
    Json other = own;
    other["exclude"] = Json::array({{{"scene", relative("scenes/box.json").string()}}});
    other["include"] = Json::array({{{"scene", relative("scenes/hall.json").string()}}});
    const auto cells = expand(folder.extended(other, name));
    CHECK(names_with(cells, "box.").empty());
    CHECK(names_with(cells, "hall.mean") == Names{"hall.mean.f2.w3.s1", "hall.mean.f2.w5.s1"});
}

TEST_CASE("a matrix may extend one that extends another", "[matrix_extends]") {
    const Folder folder;
    REQUIRE(folder.extended({{"fixed", {{"spp", 16}, {"max_depth", 1}}}}).name == "own");
    const Json third = {
        {"extends", "../configs/own.json"}, {"name", "third"}, {"fixed", {{"spp", 64}}}};
    for (const Cell& cell : expand(load_matrix(folder.write("else/third.json", third)))) {
        CHECK(cell.settings.max_depth == 1);
        CHECK(cell.settings.size == Extent{8, 6});
        if (cell.kind == CellKind::path) CHECK(cell.settings.spp == 64);
        CHECK(fs::path(cell.scene).parent_path() == folder.temp.path("scenes"));
    }
}

TEST_CASE("a matrix that leads back to itself is refused", "[matrix_extends]") {
    const Folder folder;
    const auto loop = [&](const std::string& file, const std::string& next) {
        return folder.write(file, {{"extends", next}, {"name", file}});
    };
    const std::string tail = ", allowed: a matrix that does not lead back to this one";
    const std::string self = loop("self.json", "./self.json");
    CHECK(message_of([&] { load_matrix(self); }) ==
          self + ": /extends: found \"./self.json\"" + tail);
    const std::string a = loop("a.json", "sub/b.json");
    loop("sub/b.json", "../c.json");
    const std::string c = loop("c.json", "a.json");
    CHECK(message_of([&] { load_matrix(a); }) == c + ": /extends: found \"a.json\"" + tail);
}

TEST_CASE("what a matrix extends has to be there, and the matrix has a name of its own",
          "[matrix_extends]") {
    const Folder folder;
    const std::string lost = folder.write("own.json", {{"extends", "lost.json"}, {"name", "own"}});
    const Error error = error_of([&] { load_matrix(lost); });
    CHECK(error.code() == ExitCode::file);
    CHECK(std::string(error.what()).starts_with(folder.temp.path("lost.json") + ": "));

    folder.write("base.json", base_matrix());
    const std::string nameless = folder.write("own.json", {{"extends", "base.json"}});
    CHECK(message_of([&] { load_matrix(nameless); }) ==
          nameless + ": /: found no key \"name\", allowed: an object that has it");
    const std::string number = folder.write("own.json", {{"extends", 3}, {"name", "own"}});
    CHECK(message_of([&] { load_matrix(number); }) ==
          number + ": /extends: found 3, allowed: a string");
}

TEST_CASE("an error is told of the file that it stands in", "[matrix_extends]") {
    const Folder folder;
    Json base = base_matrix();
    base["fixed"]["spp"] = 0;
    const std::string base_file = folder.write("base.json", base);
    const std::string own = folder.write(
        "own.json", {{"extends", "base.json"}, {"name", "own"}, {"fixed", {{"spp", 4}}}});
    CHECK(message_of([&] { load_matrix(own); }) ==
          base_file + ": /fixed/spp: found 0, allowed: an integer of at least 1");
    folder.write("base.json", base_matrix());
    folder.write("own.json", {{"extends", "base.json"}, {"name", "own"}, {"fixed", {{"spp", -1}}}});
    CHECK(message_of([&] { load_matrix(own); }) ==
          own + ": /fixed/spp: found -1, allowed: an integer of at least 1");
    folder.write("own.json", {{"extends", "base.json"}, {"name", "own"}, {"axes", 3}});
    CHECK(message_of([&] { load_matrix(own); }) == own + ": /axes: found 3, allowed: an object");
}

TEST_CASE("a method is included without the keys of schemes", "[matrix_extends]") {
    Json json = base_matrix();
    json["include"] = Json::array({{{"method", "path"}, {"spp", {1, 16}}}});
    const auto cells = expand(matrix_of(json));
    CHECK(names_with(cells, "box.path") ==
          Names{"box.path.s1", "box.path.spp1.s1", "box.path.spp16.s1"});
    const auto more = std::ranges::find(cells, "hall.path.spp16.s1", &Cell::name);
    REQUIRE(more != cells.end());
    CHECK(more->settings.spp == 16);
    CHECK(more->spp_asked == 16);
    CHECK(more->against == "hall.path.spp16");
    json["axes"].erase("scheme");
    json["axes"]["method"] = "path";
    json.erase("exclude");
    json.erase("include");
    CHECK(names_of(expand(matrix_of(json))) == Names{"box.path.s1", "hall.path.s1"});
}

TEST_CASE("a cell has a scheme or a method", "[matrix_extends]") {
    const std::string part = GENERATE(values<std::string>({"axes", "fixed", "include", "exclude"}));
    const Folder folder;
    Json json = base_matrix();
    std::string pointer = "/" + part;
    if (part == "axes" || part == "fixed") {
        json[part]["scheme"] = "mean";
        json[part]["method"] = "path";
    } else {
        json[part] = Json::array({{{"scheme", "mean"}, {"method", "path"}}});
        pointer += "/0";
    }
    const std::string file = folder.write("m.json", json);
    CHECK(message_of([&] { load_matrix(file); }) ==
          file + ": " + pointer +
              ": found both \"method\" and \"scheme\", allowed: one of them: a cell has either");
}

TEST_CASE("path tracing has no reduction, nor any option of schemes", "[matrix_extends]") {
    Json json = base_matrix();
    json["axes"]["reduction"] = {2, 3};
    json["axes"]["weighting"] = {"proportional", "inverse"};
    const auto cells = expand(matrix_of(json));
    CHECK(names_with(cells, ".path") == Names{"box.path.s1", "hall.path.s1"});
    for (const Cell& cell : cells) {
        const Json params = cell.parameters_json();
        CHECK(params.contains("reduction") == (cell.kind != CellKind::path));
        CHECK(params.contains("window") ==
              (cell.method() == "mean" || cell.method() == "distance2d"));
        if (cell.kind != CellKind::path) continue;
        CHECK(cell.settings.reduction == 1);
        CHECK(cell.samples_ratio() == 1.0);
    }
}

TEST_CASE("there is one ceiling per scene, reduction, size and depth", "[matrix_extends]") {
    Json json = base_matrix();
    json["axes"]["reduction"] = {2, 3};
    json["axes"]["seed"] = {1, 2, 3};
    json["axes"]["light_sampling"] = {"none", "nee"};
    json["axes"]["max_depth"] = {1, 2};
    json["axes"]["size"] = {{8, 6}, {16, 12}};
    json["axes"]["spp"] = {1, 4};
    json["axes"]["budget"] = {"same_spp", "equal_samples"};
    const auto cells = expand(matrix_of(json));
    std::set<Json> different;
    std::size_t count = 0;
    for (const Cell& cell : cells) {
        if (cell.kind != CellKind::blocky_ceiling) continue;
        ++count;
        different.insert(cell.parameters_json());
        CHECK(cell.samples_ratio() == 0);
        CHECK(cell.against.empty());
    }
    CHECK(count == 2 * 2 * 2 * 2);
    CHECK(different.size() == count);
}

TEST_CASE("ceilings are made together if they have one reference", "[matrix_extends]") {
    Json json = base_matrix();
    json["axes"]["reduction"] = {2, 3};
    json["axes"]["max_depth"] = {1, 2};
    json["axes"]["size"] = {{8, 6}, {16, 12}};
    const auto cells = expand(matrix_of(json));
    std::vector<PlannedCell> plan;
    for (const Cell& cell : cells) plan.push_back({&cell, CellState::missing, true});
    std::size_t ceiling_jobs = 0;
    for (const FrameJob& job : frame_jobs(plan)) {
        for (const Cell* cell : job.cells) {
            CHECK(cell->scene == job.cells.front()->scene);
            CHECK(cell->settings.size == job.cells.front()->settings.size);
            CHECK(cell->settings.max_depth == job.cells.front()->settings.max_depth);
            CHECK((cell->kind == CellKind::blocky_ceiling) == !job.traces);
        }
        if (job.traces) continue;
        ++ceiling_jobs;
        CHECK(job.cells.size() == 2);
        CHECK(job.samples() == 0);
    }
    CHECK(ceiling_jobs == 2 * 2 * 2);
}

TEST_CASE("a budget is spent on the low-resolution frame", "[matrix_extends]") {
    struct Case {
        Budget budget;
        int spp;
        FrameSizes sizes;
        int budgeted;
    };
    const FrameSizes half{{512, 512}, {256, 256}}, third{{512, 512}, {170, 170}},
        odd{{10, 7}, {3, 2}};
    const Case c = GENERATE_COPY(values<Case>({{Budget::same_spp, 10000, half, 10000},
                                               {Budget::equal_samples, 10000, half, 40000},
                                               {Budget::thesis_equal_time, 10000, half, 48000},
                                               {Budget::thesis_equal_time, 10000, third, 48000},
                                               {Budget::thesis_equal_time, 1, half, 5},
                                               {Budget::thesis_equal_time, 3, half, 14},
                                               {Budget::equal_samples, 10000, third, 90707},
                                               {Budget::equal_samples, 4, odd, 47},
                                               {Budget::equal_samples, 1000000000, odd, 2147483647},
                                               {Budget::equal_time, 4, odd, 47}}));
    CAPTURE(budget_name(c.budget), c.spp, c.budgeted);
    CHECK(budgeted_spp(c.budget, c.spp, c.sizes) == c.budgeted);
}

TEST_CASE("the samples that a budget came to are told", "[matrix_extends]") {
    Json json = base_matrix();
    json["axes"]["reduction"] = 3;
    json["axes"]["budget"] = {"same_spp", "equal_samples", "thesis_equal_time"};
    json["fixed"]["size"] = {10, 7};
    const auto cells = expand(matrix_of(json));
    const auto ratio_of = [&](const std::string& name) {
        const auto cell = std::ranges::find(cells, name, &Cell::name);
        REQUIRE(cell != cells.end());
        CHECK(cell->spp_asked == 4);
        CHECK(cell->against == "box.path");
        return cell->samples_ratio();
    };
    CHECK(ratio_of("box.nearest.f3.s1") == Approx(6.0 / 70));
    CHECK(ratio_of("box.nearest.f3.equal_samples.s1") == Approx(47 * 6.0 / (4 * 70)));
    CHECK(ratio_of("box.nearest.f3.thesis_equal_time.s1") == Approx(19 * 6.0 / (4 * 70)));
    CHECK(ratio_of("box.path.s1") == 1.0);
}

TEST_CASE("an extending matrix replaces parts of a reproduction, and keeps the rest",
          "[matrix_extends]") {
    const Matrix quick = load_matrix(std::string(VECINO_SOURCE_DIR) + "/configs/thesis-quick.json");
    const Matrix thesis = load_matrix(std::string(VECINO_SOURCE_DIR) + "/configs/thesis.json");
    const Json& own = quick.document["reproduction"];
    const Json& base = thesis.document["reproduction"];
    CHECK(own["claims"] == base["claims"]);
    CHECK(own["items"] == base["items"]);
    CHECK(own["variants"] != base["variants"]);
    // The quick run has all of its seeds at one number of samples.
    for (const Json& variant : own["variants"]) CHECK_FALSE(variant.contains("tested_at"));
}
