// SPDX-License-Identifier: Apache-2.0
//
// Surroundings that fail under the program: full disks, files that vanish, a second run. Each has a
// defined outcome; what SIGKILL leaves is tested by kill_nine.py.
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "tests/catch.h"
#include "tests/program.h"
#include "tests/tiny_run.h"

using namespace vecino;

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Where no file grows beyond 512-byte blocks: a full disk for one command.
Outcome run_with_room(const TempDir& dir, int blocks, const std::string& arguments) {
    return run_line(dir, "( ulimit -f " + std::to_string(blocks) + "; exec '" VECINO_PROGRAM "' " +
                             arguments + " )");
}

bool is_one_line(const std::string& text) {
    return text.find('\n') == text.size() - 1;
}

/// A process that is gone.
pid_t dead_process() {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(0);
    ::waitpid(child, nullptr, 0);
    return child;
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("results that standard output has no room for are no success", "[hostile]") {
    const TempDir dir;
    for (const std::string arguments : {"list schemes --json", "--version", "schema matrix"}) {
        CAPTURE(arguments);
        const Outcome outcome =
            run_line(dir, "( exec '" VECINO_PROGRAM "' " + arguments + " >/dev/full )");
        CHECK(outcome.code == 4);
        CHECK(outcome.err.starts_with("vecino: standard output: cannot be written: "));
        CHECK(is_one_line(outcome.err));
    }
}

TEST_CASE("on a full disk every command says so and leaves the old file", "[hostile]") {
    const TinyMatrix matrix;
    const TempDir& dir = matrix.temp;
    REQUIRE(run_in(dir, "render box.json -o low.exr --size 32x32 --spp 4").code == 0);
    REQUIRE(run_in(dir, "render box.json -o noise.exr --size 32x32 --spp 4 --seed 2").code == 0);
    REQUIRE(run_in(dir, "render box.json -o a.exr --size 16x12 --spp 128 --samples 0:64").code ==
            0);
    REQUIRE(run_in(dir, "render box.json -o b.exr --size 16x12 --spp 128 --samples 64:128").code ==
            0);
    (void)matrix.run();
    dir.write("old.exr", "an older result");
    dir.write("old.md", "an older result");
    struct Case {
        std::string arguments, output;
    };
    const Case cases[] = {
        {"render box.json -o old.exr --size 32x32 --spp 4", "old.exr"},
        {"render box.json -o old.exr --size 16x12 --spp 128 --samples 0:64", "old.exr"},
        {"merge a.exr b.exr -o old.exr", "old.exr"},
        {"upsample low.exr -o old.exr --size 64x64 --scheme mean", "old.exr"},
        {"compare low.exr noise.exr --error-map old.exr", "old.exr"},
        {"report run -o old.md", "old.md"},
    };
    for (const Case& c : cases) {
        CAPTURE(c.arguments);
        const std::set<std::string> names = dir.names();
        const Outcome outcome = run_with_room(dir, 1, c.arguments);
        CHECK(outcome.code == 4);
        CHECK(is_one_line(outcome.err));
        CHECK(contains(outcome.err, ": cannot be written: "));
        CHECK(dir.read(c.output) == "an older result");
        std::set<std::string> expected = names;
        expected.insert({"stdout.txt", "stderr.txt"});
        CHECK(dir.names() == expected);
    }
}

TEST_CASE("a run that a full disk ended goes on once there is room", "[hostile]") {
    const TinyMatrix matrix;
    (void)matrix.load();
    const auto expect_full = [&](int blocks) {
        const Outcome outcome = run_with_room(matrix.temp, blocks, "run tiny.json -o run");
        CHECK(outcome.code == 4);
        CHECK(is_one_line(outcome.err));
        CHECK(contains(outcome.err, "cannot be written: "));
        if (fs::exists(matrix.temp.path("run/results.jsonl"))) CHECK(matrix.rows().empty());
    };
    expect_full(1);  // too few for a reference
    REQUIRE(run_in(matrix.temp, "run tiny.json -o run --only ceiling").code == 0);
    fs::remove(matrix.temp.path("run/results.jsonl"));
    expect_full(3);  // the reference is there: too few for the image of a cell
    CHECK(fs::exists(matrix.temp.path("run/cells")));
    REQUIRE(run_in(matrix.temp, "run tiny.json -o run").code == 0);
    TinyMatrix whole;
    (void)whole.run();
    CHECK(matrix.rows().size() == whole.rows().size());
    for (const auto& [cell, row] : matrix.rows()) {
        CAPTURE(cell);
        CHECK(row["status"] == "ok");
        CHECK(row["metrics"] == whole.rows().at(cell)["metrics"]);
    }
}

TEST_CASE("a run directory that cannot hold results is refused before any work", "[hostile]") {
    const TinyMatrix matrix;
    (void)matrix.load();
    fs::create_directories(matrix.temp.path("run/results.jsonl"));
    const Outcome outcome = run_in(matrix.temp, "run tiny.json -o run");
    CHECK(outcome.code == 4);
    CHECK(outcome.err == "vecino: run/results.jsonl: cannot be written: it is a directory\n");
    CHECK_FALSE(fs::exists(matrix.temp.path("run/references")));
}

TEST_CASE("one run at a time writes to a directory", "[hostile]") {
    const TinyMatrix matrix;
    (void)matrix.run();
    const auto rows = matrix.rows();
    {
        const RunDirectory held = RunDirectory::create(matrix.directory);
        const Outcome second = run_in(matrix.temp, "run tiny.json -o run --rerun all");
        CHECK(second.code == 4);
        CHECK(second.err == "vecino: run: another run is writing to this directory\n");
        CHECK(second.out.empty());
    }
    CHECK(matrix.rows() == rows);
    CHECK(run_in(matrix.temp, "run tiny.json -o run").code == 0);
}

TEST_CASE("scenes are read before the first frame, and may vanish then", "[hostile]") {
    TinyMatrix matrix;
    matrix.copy_scene("hall");
    save_image(Image({16, 12}, glm::vec3(0.5f)), matrix.temp.path("grey.exr"));
    matrix.json["axes"] = {{"scene", {"box.json", "hall.json"}}, {"image", "made"}};
    matrix.json["images"]["made"] = {
        {"command", {"sh", "-c", "rm -f hall.json; cp grey.exr \"$0\"", "{output}"}}};
    (void)matrix.load();
    const Outcome outcome = run_in(matrix.temp, "run tiny.json -o run");
    CHECK(outcome.code == 0);
    CHECK_FALSE(fs::exists(matrix.temp.path("hall.json")));
    CHECK(matrix.rows().size() == 2);
}

TEST_CASE("a reference that vanishes in mid-run fails the cells that it is for, and no other",
          "[hostile]") {
    TinyMatrix matrix;
    const Image grey({16, 12}, glm::vec3(0.5f));
    for (const char* file : {"grey.exr", "ref_first.exr", "ref_second.exr", "ref_third.exr"})
        save_image(grey, matrix.temp.path(file));
    matrix.json = {
        {"name", "tiny"},
        {"axes", {{"scene", {"first", "second", "third"}}, {"image", "made"}}},
        {"images",
         {{"made",
           {{"command", {"sh", "-c", "rm -f ref_second.exr; cp grey.exr \"$0\"", "{output}"}}}}}},
        {"reference", {{"file", "ref_{scene}.exr"}}}};
    (void)matrix.load();
    const Outcome outcome = run_in(matrix.temp, "run tiny.json -o run");
    CHECK(outcome.code == 2);
    CHECK(contains(outcome.err, "failed: second.made.s1: ref_second.exr: cannot be read: "));
    const auto rows = matrix.rows();
    CHECK(rows.at("first.made.s1")["status"] == "ok");
    CHECK(rows.at("second.made.s1")["status"] == "failed");
    CHECK(rows.at("third.made.s1")["status"] == "ok");
    save_image(grey, matrix.temp.path("ref_second.exr"));
    // It is no file of before: the same command would keep the failure, and --rerun failed asks.
    matrix.json["images"]["made"]["command"] = {"cp", "grey.exr", "{output}"};
    (void)matrix.load();
    CHECK(run_in(matrix.temp, "run tiny.json -o run --rerun failed").code == 0);
    CHECK(matrix.rows().at("second.made.s1")["status"] == "ok");
}

TEST_CASE("temporary files of killed runs are removed by the next, those of others are not",
          "[hostile]") {
    const TinyMatrix matrix;
    (void)matrix.run();
    const std::string dead = ".vecino." + std::to_string(dead_process()) + ".0.tmp.exr";
    const std::string alive = ".vecino." + std::to_string(::getpid()) + ".9.tmp.exr";
    const std::string folder = "run/cells/box.mean.f2.w3.s1/";
    for (const std::string& name : {dead, alive, std::string(".vecino.notes.tmp")})
        matrix.temp.write(folder + name, "half");
    matrix.temp.write("run/" + dead, "half");
    CHECK(matrix.run().done == 0);
    CHECK_FALSE(fs::exists(matrix.temp.path(folder + dead)));
    CHECK_FALSE(fs::exists(matrix.temp.path("run/" + dead)));
    CHECK(matrix.temp.read(folder + alive) == "half");
    CHECK(matrix.temp.read(folder + ".vecino.notes.tmp") == "half");
}
