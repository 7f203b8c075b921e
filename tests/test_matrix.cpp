// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "core/files.h"
#include "core/image_io.h"
#include "eval/matrix.h"
#include "eval/run_directory.h"
#include "eval/run_matrix.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/temp_dir.h"

using namespace vecino;

namespace {

const std::string kScenes = std::string(VECINO_SOURCE_DIR) + "/scenes/";

std::string tiny_matrix(const std::string& more = "") {
    return R"({"name": "tiny", "axes": {"scene": [")" + kScenes +
           R"(cornell.json"], "scheme": ["nearest", "mean"],
        "reduction": [2], "window": [3, 5], "seed": [1, 2]})" +
           more + R"(, "fixed": {"size": [8, 6], "spp": 4, "sampler": "independent"},
        "reference": {"spp": 64, "light_sampling": "nee", "sampler": "sobol", "seed": 1000}, "measure": {"repeat": 2}})";
}

Matrix write_and_load(const TempDir& dir, const std::string& text) {
    const std::string path = dir.path("matrix.json");
    std::ofstream(path) << text;
    return load_matrix(path);
}

std::vector<std::string> names_of(const std::vector<Cell>& cells) {
    std::vector<std::string> names;
    for (const Cell& cell : cells) names.push_back(cell.name);
    return names;
}

/// Rows without what differs from run to run.
std::map<std::string, nlohmann::json> lasting(std::map<std::string, nlohmann::json> rows) {
    for (auto& [name, row] : rows) row.erase("time_s");
    return rows;
}

}  // namespace

TEST_CASE("a matrix expands into named cells, path tracing included, unread axes left out",
          "[matrix]") {
    const TempDir dir;
    const auto cells = expand(write_and_load(dir, tiny_matrix()));
    const std::vector<std::string> expected = {
        "cornell.path.s1",       "cornell.nearest.f2.s1", "cornell.path.s2",
        "cornell.nearest.f2.s2", "cornell.mean.f2.w3.s1", "cornell.mean.f2.w3.s2",
        "cornell.mean.f2.w5.s1", "cornell.mean.f2.w5.s2", "cornell.blocky_ceiling.f2"};
    auto names = names_of(cells);
    CHECK(names.size() == expected.size());
    for (const std::string& name : expected) CHECK(std::ranges::count(names, name) == 1);
}

TEST_CASE("exclude removes cells, include adds them, budgets are spent", "[matrix]") {
    const TempDir dir;
    const auto cells =
        expand(write_and_load(dir, tiny_matrix(
                                       R"(, "exclude": [{"scheme": "mean", "window": 5}],
            "include": [{"scheme": "distance3d_normal", "window": 7, "weighting": "inverse", "budget": "equal_samples", "seed": 1}])")));
    const auto names = names_of(cells);
    CHECK(std::ranges::count(names, "cornell.mean.f2.w5.s1") == 0);
    CHECK(std::ranges::count(names, "cornell.mean.f2.w3.s2") == 1);
    const std::string added = "cornell.distance3d_normal.f2.w7.inverse.equal_samples.s1";
    const auto cell = std::ranges::find(cells, added, &Cell::name);
    REQUIRE(cell != cells.end());
    CHECK(cell->settings.spp == 16);  // 4 * (8*6) / (4*3)
    CHECK(cell->samples_ratio() == 1.0);
    CHECK(cell->parameters.weighting == Weighting::inverse);
    CHECK(std::ranges::find(cells, "cornell.nearest.f2.s1", &Cell::name)->samples_ratio() == 0.25);
}

TEST_CASE("equal samples round where the factor does not divide, and say so", "[matrix]") {
    const TempDir dir;
    std::string text = tiny_matrix();
    text.replace(text.find("[2]"), 3, "[3]");
    text.replace(text.find("[8, 6]"), 6, "[8, 8]");
    text.replace(text.find("\"seed\": [1, 2]"), 14, "\"seed\": 1, \"budget\": \"equal_samples\"");
    const auto cells = expand(write_and_load(dir, text));
    const auto cell = std::ranges::find(cells, "cornell.nearest.f3.equal_samples.s1", &Cell::name);
    REQUIRE(cell != cells.end());
    CHECK(cell->settings.spp == 64);  // 4 * 64 / 4
    CHECK(cell->samples_ratio() == 1.0);
}

TEST_CASE("a run leaves a row, an image and an error image per cell", "[matrix]") {
    const TempDir dir;
    const Matrix matrix = write_and_load(dir, tiny_matrix());
    const std::string out = dir.path("out");
    const RunSummary summary = run_matrix(matrix, out);
    CHECK(summary.cells == 9);
    CHECK(summary.done == 9);
    CHECK(summary.kept == 0);
    CHECK(summary.missing == 0);
    CHECK(summary.failed == 0);
    const auto rows = RunDirectory::open(out).rows();
    REQUIRE(rows.size() == 9);
    for (const auto& [name, row] : rows) {
        CHECK(row["status"] == "ok");
        CHECK(row["metrics"]["psnr_float_db"].get<double>() > 5.0);
        CHECK(row["metrics"]["non_finite"]["count"] == 0);
        const bool takes_time = row["method"] != "blocky_ceiling";
        CHECK((row["time_s"]["total"].get<double>() > 0.0) == takes_time);
        CHECK(load_image(out + "/cells/" + name + "/image.exr").size() == Extent{8, 6});
        CHECK(std::filesystem::exists(out + "/cells/" + name + "/image.png"));
        CHECK(std::filesystem::exists(out + "/cells/" + name + "/image.exr"));
        CHECK(
            std::filesystem::exists(out + "/" + row["reference_file"].get<std::string>() + ".exr"));
    }
    const std::string csv = read_file(out + "/results.csv");
    CHECK(std::ranges::count(csv, '\n') == 10);
    CHECK(csv.find("metrics.psnr_float_db") != std::string::npos);
    CHECK(nlohmann::json::parse(read_file(out + "/run.json"))["name"] == "tiny");
}

TEST_CASE("a second run redoes nothing, a changed matrix what changed", "[matrix]") {
    const TempDir dir;
    const Matrix matrix = write_and_load(dir, tiny_matrix());
    const std::string out = dir.path("out");
    run_matrix(matrix, out);
    const auto before = RunDirectory::open(out).rows();
    CHECK(run_matrix(matrix, out).kept == 9);
    CHECK(RunDirectory::open(out).rows() == before);
    std::string text = tiny_matrix();
    text.replace(text.find("[3, 5]"), 6, "[3, 7]");
    const RunSummary changed = run_matrix(write_and_load(dir, text), out);
    CHECK(changed.kept == 7);
    CHECK(changed.done == 2);
}

TEST_CASE("a run that lost its end goes on, and ends as if it had not", "[matrix]") {
    const TempDir dir;
    const Matrix matrix = write_and_load(dir, tiny_matrix());
    const std::string whole = dir.path("whole");
    const std::string cut = dir.path("cut");
    run_matrix(matrix, whole);
    run_matrix(matrix, cut);
    std::string lines = read_file(cut + "/results.jsonl");
    lines.resize(lines.size() * 2 / 3);  // in the middle of a line
    std::ofstream(cut + "/results.jsonl", std::ios::trunc) << lines;
    const RunSummary summary = run_matrix(matrix, cut);
    CHECK(summary.kept > 0);
    CHECK(summary.kept < 8);
    CHECK(lasting(RunDirectory::open(cut).rows()) == lasting(RunDirectory::open(whole).rows()));
}

TEST_CASE("only the cells that are asked for are run, and the rest stays", "[matrix]") {
    const TempDir dir;
    const Matrix matrix = write_and_load(dir, tiny_matrix());
    const std::string out = dir.path("out");
    const RunSummary part = run_matrix(matrix, out, {.only = "mean.*w3"});
    CHECK(part.done == 2);
    CHECK(part.missing == 7);
    const RunSummary rest = run_matrix(matrix, out);
    CHECK(rest.done == 7);
    CHECK(rest.kept == 2);
    const Error none = error_of([&] { run_matrix(matrix, out, {.only = "bicubic"}); });
    CHECK(none.code() == ExitCode::usage);
    const Error broken = error_of([&] { run_matrix(matrix, out, {.only = "(["}); });
    CHECK(std::string(broken.what()).find("--only: found \"([\"") != std::string::npos);
}

TEST_CASE("failed and stale cells are done again when asked, not before", "[matrix]") {
    const TempDir dir;
    const Matrix matrix = write_and_load(dir, tiny_matrix());
    const std::string out = dir.path("out");
    run_matrix(matrix, out);
    auto rows = RunDirectory::open(out).rows();
    rows["cornell.path.s1"]["build"] = "another";
    rows["cornell.path.s2"]["status"] = "failed";
    rows["cornell.path.s2"]["reason"] = "a test says so";
    std::string lines;
    for (const auto& [name, row] : rows) lines += row.dump() + "\n";
    std::ofstream(out + "/results.jsonl", std::ios::trunc) << lines;
    const RunSummary plain = run_matrix(matrix, out);
    CHECK(plain.done == 0);
    CHECK(plain.stale == 1);
    CHECK(plain.failed == 1);
    const RunSummary failed = run_matrix(matrix, out, {.only = "", .rerun = Rerun::failed});
    CHECK(failed.done == 1);
    CHECK(failed.failed == 0);
    CHECK(run_matrix(matrix, out, {.only = "", .rerun = Rerun::stale}).done == 1);
    CHECK(run_matrix(matrix, out, {.only = "", .rerun = Rerun::stale}).done == 0);
    CHECK(run_matrix(matrix, out, {.only = "", .rerun = Rerun::all}).done == 9);
}

TEST_CASE("a cell that another build failed at is done again with failed and with stale ones",
          "[matrix]") {
    const TempDir dir;
    const Matrix matrix = write_and_load(dir, tiny_matrix());
    const std::string out = dir.path("out");
    const Rerun rerun = GENERATE(Rerun::failed, Rerun::stale);
    run_matrix(matrix, out);
    auto rows = RunDirectory::open(out).rows();
    rows["cornell.path.s1"]["build"] = "another";
    rows["cornell.path.s1"]["status"] = "failed";
    std::string lines;
    for (const auto& [name, row] : rows) lines += row.dump() + "\n";
    std::ofstream(out + "/results.jsonl", std::ios::trunc) << lines;
    CHECK(run_matrix(matrix, out).failed == 1);
    const RunSummary again = run_matrix(matrix, out, {.only = "", .rerun = rerun});
    CHECK(again.done == 1);
    CHECK(again.failed == 0);
}

TEST_CASE("an estimate names what is to do and touches nothing", "[matrix]") {
    const TempDir dir;
    const Matrix matrix = write_and_load(dir, tiny_matrix());
    const RunEstimate estimate = estimate_run(matrix, dir.path("out"), {.only = "path"});
    CHECK(estimate.cells == std::vector<std::string>{"cornell.path.s1", "cornell.path.s2"});
    CHECK(estimate.samples == 2 * 48 * 4 + 48 * 64);
    CHECK(estimate.time_s > 0.0);
    CHECK_FALSE(std::filesystem::exists(dir.path("out")));
}

TEST_CASE("a directory is written by one run at a time, and belongs to one matrix", "[matrix]") {
    const TempDir dir;
    const std::string out = dir.path("out");
    const Matrix matrix = write_and_load(dir, tiny_matrix());
    {
        const RunDirectory held = RunDirectory::create(out);
        const Error error = error_of([&] { run_matrix(matrix, out); });
        CHECK(std::string(error.what()) == out + ": another run is writing to this directory");
        CHECK(error.code() == ExitCode::file);
    }
    run_matrix(matrix, out);
    std::string text = tiny_matrix();
    text.replace(text.find("\"tiny\""), 6, "\"other\"");
    const Matrix other = write_and_load(dir, text);
    const Error error = error_of([&] { run_matrix(other, out); });
    CHECK(std::string(error.what()) ==
          out + ": found results of the matrix \"tiny\", allowed: \"other\" or an empty directory");
    CHECK(error.code() == ExitCode::usage);
}

TEST_CASE("the matrices of the repository expand", "[matrix]") {
    const std::string file = GENERATE(values<std::string>({"thesis", "thesis-quick"}));
    const auto cells =
        expand(load_matrix(std::string(VECINO_SOURCE_DIR) + "/configs/" + file + ".json"));
    // Per scene and seed: path, nearest at 2 factors, 4 schemes at 2 factors and 3 windows, one
    // scheme at 3 budgets; all of it by chance and by nee. As the prose means it: 3 schemes and the
    // budgets. Path tracing at more spp. Per scene: 2 ceilings.
    const std::size_t printed = 1 + 2 + 4 * 2 * 3 + 3;
    const std::size_t prose = 3 * 2 * 3 + 3;
    const std::size_t quick = 4 * (2 * printed + prose + 4 + 3);
    // By chance one seed at full spp, without a measured budget, and 4 at a tenth.
    const std::size_t whole = (printed - 1 + prose - 1) + 4 * (2 * printed + prose) + 3 + 2;
    CHECK(cells.size() == 2 * ((file == "thesis" ? whole : quick) + 2));
}
