// SPDX-License-Identifier: Apache-2.0
//
// Images that vecino does not make, as methods of a matrix: files, and what commands make.
#include "eval/image_source.h"

#include <filesystem>
#include <limits>

#include "eval/summary.h"
#include "tests/catch.h"
#include "tests/program.h"
#include "tests/tiny_run.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;

Image plain(float value, Extent size = {4, 3}) {
    return Image(size, glm::vec3(value));
}

/// A matrix of files alone, without any scene of vecino's: two methods against a file.
struct FileMatrix {
    TempDir temp;
    std::string directory = temp.path("run");
    Json json = {{"name", "files"},
                 {"axes", {{"scene", "attic"}, {"image", {"first", "second"}}, {"seed", {1, 2}}}},
                 {"images",
                  {{"first", {{"file", "{scene}_first_{seed}.exr"}, {"time_s", 2.5}}},
                   {"second", {{"file", "{scene}_second.png"}}}}},
                 {"reference", {{"file", "{scene}.exr"}}}};

    FileMatrix() {
        save_image(plain(0.5f), temp.path("attic.exr"));
        save_image(plain(0.25f), temp.path("attic_first_1.exr"));
        save_image(plain(0.5f), temp.path("attic_first_2.exr"));
        save_image(plain(1.0f), temp.path("attic_second.png"));
    }
    [[nodiscard]] Matrix load() const { return load_matrix(temp.write("files.json", json.dump())); }
    RunSummary run(const RunOptions& options = {}) const {
        return run_matrix(load(), directory, options);
    }
    [[nodiscard]] std::map<std::string, Json> rows() const {
        return RunDirectory::open(directory).rows();
    }
    void expect_fault(const std::string& fault) const {
        CHECK_THROWS_WITH(load(), Catch::Matchers::Contains(fault));
    }
    /// The fault of one image's row, by another entry for it.
    [[nodiscard]] std::string reason(const Json& entry) {
        json["axes"]["image"] = "first";
        json["axes"]["seed"] = 1;
        json["images"] = {{"first", entry}};
        CHECK(run().failed == 1);
        const Json row = rows().begin()->second;
        CHECK(row["status"] == "failed");
        return row["reason"];
    }
};

/// The Cornell box and what a command makes beside it.
struct CommandRun : TinyMatrix {
    CommandRun() {
        json["axes"] = {{"scene", "box.json"}, {"image", "made"}, {"seed", {1, 2}}};
        json["fixed"]["reduction"] = 2;
        save_image(plain(0.5f, {16, 12}), temp.path("box.exr"));
        command({"cp", "{scene}.exr", "{output}"});
    }
    void command(const Json& arguments) { json["images"]["made"]["command"] = arguments; }
    [[nodiscard]] Json row() const { return rows().begin()->second; }
};

}  // namespace

TEST_CASE("a matrix of files needs no scene of vecino's", "[image_source]") {
    const FileMatrix matrix;
    CHECK(matrix.run().failed == 0);
    const auto rows = matrix.rows();
    REQUIRE(rows.size() == 3);  // the second method's file does not depend on the seed
    const Json first = rows.at("attic.first.s1");
    CHECK(first["method"] == "first");
    CHECK(first["scene"] == "attic");
    CHECK(first["metrics"]["mae"].get<double>() == Approx(0.25));
    CHECK(first["time_s"]["trace"] == 2.5);
    CHECK(rows.at("attic.first.s2")["metrics"]["psnr_float_db"].is_null());  // identical
    const Json second = rows.at("attic.second.s1");
    CHECK(second["metrics"]["mae"].get<double>() == Approx(0.5));  // decoded from sRGB
    CHECK(second["time_s"]["total"] == 0.0);                       // unknown
    CHECK_FALSE(second["metrics"].contains("regions"));

    CHECK(matrix.run().kept == 3);
    save_image(plain(0.125f), matrix.temp.path("attic_first_1.exr"));
    const RunSummary changed = matrix.run({.only = "", .rerun = Rerun::stale});
    CHECK(changed.done == 1);
    CHECK(matrix.rows().at("attic.first.s1")["metrics"]["mae"].get<double>() == Approx(0.375));

    save_image(plain(0.25f), matrix.temp.path("attic.exr"));
    CHECK(matrix.run({.only = "", .rerun = Rerun::stale}).done == 3);
    CHECK(matrix.rows().at("attic.first.s1")["metrics"]["mae"].get<double>() == Approx(0.125));
}

TEST_CASE("files are run, accepted, checked and reported on from the command line",
          "[image_source]") {
    const FileMatrix matrix;
    (void)matrix.load();
    const auto code_of = [&](const std::string& line) { return run_in(matrix.temp, line).code; };
    CHECK(code_of("run files.json -o run") == 0);
    CHECK(code_of("accept run --baseline baseline.json --yes") == 0);
    CHECK(code_of("check run --baseline baseline.json") == 0);
    CHECK(code_of("report run") == 0);
    CHECK_THAT(read_file(matrix.directory + "/report.html"),
               Catch::Matchers::Contains("file {scene}.exr"));
    save_image(plain(0.0f), matrix.temp.path("attic_second.png"));
    CHECK(code_of("run files.json -o run") == 0);
    const Outcome stale = run_in(matrix.temp, "check run --baseline baseline.json");
    CHECK(stale.code == 2);
    CHECK_THAT(stale.out, Catch::Matchers::Contains("stale cell"));
    CHECK(code_of("run files.json -o run --rerun stale") == 0);
    CHECK(code_of("check run --baseline baseline.json") == 2);
}

TEST_CASE("a scene of another program goes to its command as it is", "[image_source]") {
    FileMatrix matrix;
    matrix.temp.write("attic.xml", "<scene/>");
    matrix.json["axes"] = {{"scene", "attic.xml"}, {"image", "theirs"}};
    matrix.json["images"] = {{"theirs",
                              {{"command",
                                {"sh", "-c", "grep -q '<scene/>' \"$0\" && cp attic.exr \"$1\"",
                                 "{scene_file}", "{output}"}}}}};
    (void)matrix.load();
    CHECK(run_in(matrix.temp, "run files.json -o run").code == 0);
    CHECK(matrix.rows().at("attic.theirs.s1")["metrics"]["psnr_float_db"].is_null());
}

TEST_CASE("colours come from the channels that are named", "[image_source]") {
    FileMatrix matrix;
    Frame frame;
    frame.radiance = plain(0.0f);
    frame.albedo = plain(0.5f);
    save_frame(frame, matrix.temp.path("attic_first_1.exr"));
    matrix.json["axes"]["seed"] = 1;
    matrix.json["images"]["first"]["channels"] = {"Albedo.R", "Albedo.G", "Albedo.B"};
    CHECK(matrix.run().failed == 0);
    CHECK(matrix.rows().at("attic.first.s1")["metrics"]["psnr_float_db"].is_null());
    CHECK(matrix.reason({{"file", "attic.exr"}, {"channels", {"R", "G", "X"}}}) ==
          matrix.temp.path("attic.exr") + ": found no channel X, allowed: R, G, B");
}

TEST_CASE("a file that is no image of the reference's size fails its row alone", "[image_source]") {
    FileMatrix matrix;
    CHECK_THAT(matrix.reason({{"file", "nowhere.exr"}}),
               Catch::Matchers::Contains("nowhere.exr: cannot be read"));
    save_image(plain(0.5f, {5, 3}), matrix.temp.path("wide.exr"));
    CHECK_THAT(matrix.reason({{"file", "wide.exr"}}), Catch::Matchers::Contains("5x3"));
    save_image(plain(std::numeric_limits<float>::quiet_NaN()), matrix.temp.path("nan.exr"));
    CHECK_THAT(matrix.reason({{"file", "nan.exr"}}), Catch::Matchers::Contains("found nan"));
    CHECK_THAT(matrix.reason({{"file", "attic.exr"}, {"time_attribute", "seconds"}}),
               Catch::Matchers::Contains("found no attribute \"seconds\""));
}

TEST_CASE("a file tells its time by an attribute", "[image_source]") {
    FileMatrix matrix;
    Frame frame;
    frame.radiance = plain(0.25f);
    save_frame(frame, matrix.temp.path("attic_first_1.exr"), {{"took", "01:02.5"}});
    save_frame(frame, matrix.temp.path("attic_first_2.exr"), {{"took", 3.5f}});
    matrix.json["images"]["first"] = {{"file", "attic_first_{seed}.exr"},
                                      {"time_attribute", "took"}};
    CHECK(matrix.run().failed == 0);
    CHECK(matrix.rows().at("attic.first.s1")["time_s"]["total"].get<double>() >= 62.5);
    CHECK(matrix.rows().at("attic.first.s2")["time_s"]["trace"] == 3.5);
}

TEST_CASE("times are seconds, or minutes and hours before them", "[image_source]") {
    CHECK(seconds_of("12.5") == 12.5);
    CHECK(seconds_of("01:02.5") == 62.5);
    CHECK(seconds_of("1:01:02.5") == 3662.5);
    for (const char* text : {"", ":", "1:", ":1", "x", "1:2:3:4", "-1", "nan", "inf", "1 s"}) {
        CAPTURE(text);
        CHECK_FALSE(seconds_of(text));
    }
}

TEST_CASE("names in braces are replaced, doubled braces are braces", "[image_source]") {
    CHECK(fill_template("{a}-{{{b}}}{a}", {{"a", "1"}, {"b", "two"}}) == "1-{two}1");
    const Placeholders values = placeholders_of("folder/box.json", RenderSettings{});
    CHECK(fill_template("{scene} {width}x{height} {spp} {sampler}", values) ==
          "box 512x512 64 sobol");
    CHECK(fill_template("{scene_file}", values) ==
          std::filesystem::absolute("folder/box.json").string());
}

TEST_CASE("a command makes the image, with the clock running", "[image_source]") {
    CommandRun run;
    CHECK(run.run().failed == 0);
    const Json row = run.row();
    CHECK(row["cell"] == "box.made.s1");  // of one seed: the command does not ask for it
    CHECK(run.rows().size() == 1);
    CHECK(row["time_s"]["trace"].get<double>() > 0);
    CHECK(load_image(run.image_file("box.made.s1")).values() == plain(0.5f, {16, 12}).values());
    const auto folder = std::filesystem::path(run.image_file("box.made.s1")).parent_path();
    CHECK_FALSE(std::filesystem::exists(folder / "made.exr"));

    CHECK(run.run().stale == 0);
    save_image(plain(0.25f, {16, 12}), run.temp.path("box.exr"));  // named by an argument
    CHECK(run.run({.only = "", .rerun = Rerun::stale}).done == 1);

    run.command({"sh", "-c", "echo seed $1; cp box.exr \"$2\"", "sh", "{seed}", "{output}"});
    CHECK(run.run().done == 2);
    CHECK(read_file((folder / "command.log").string()) == "seed 1\n");
}

TEST_CASE("a command that fails is told with its exit code", "[image_source]") {
    CommandRun run;
    run.command({"sh", "-c", "echo no light; exit 3", "{output}"});
    CHECK(run.run().failed == 1);
    const std::string log = run.directory + "/cells/box.made.s1/command.log";
    CHECK(run.row()["reason"] ==
          "command sh: found exit code 3, allowed: exit code 0 (" + log + ")");
    CHECK(read_file(log) == "no light\n");
    run.command({"./no_such_program", "{output}"});
    CHECK(run.run().failed == 1);
    CHECK_THAT(run.row()["reason"].get<std::string>(),
               Catch::Matchers::Contains("No such file or directory"));
    run.command({"true", "{output}"});
    CHECK(run.run().failed == 1);
    CHECK(run.row()["reason"] ==
          "command true: found no file at {output}, allowed: an image there (" + log + ")");
}

TEST_CASE("a command rebuilds a frame that vecino traces", "[image_source]") {
    CommandRun run;
    const std::string nearest = "\"$0\" upsample \"$1\" -o \"$2\" --size 16x12 --scheme nearest";
    run.command({"sh", "-c", nearest, VECINO_PROGRAM, "{input}", "{output}"});
    run.json["include"] = {{{"scheme", "nearest"}}};
    CHECK(run.run().failed == 0);
    const auto rows = run.rows();
    for (const std::string seed : {"1", "2"}) {
        const Json made = rows.at("box.made.s" + seed);
        const Json ours = rows.at("box.nearest.f2.s" + seed);
        CHECK(made["metrics"] == ours["metrics"]);
        CHECK(made["time_s"]["trace"].get<double>() > 0);
        CHECK(made["time_s"]["reconstruct"].get<double>() > 0);
    }
}

TEST_CASE("this program is at hand for commands", "[image_source]") {
    const Placeholders values = placeholders_of("box.json", {});
    CHECK(std::filesystem::equivalent(values.at("vecino"), "/proc/self/exe"));
}

TEST_CASE("resizing by colour alone says what it took", "[image_source]") {
    CommandRun run;
    run.command({VECINO_PROGRAM, "resize", "{input}", "-o", "{output}", "--size",
                 "{width}x{height}", "--filter", "nearest", "--repeat", "3"});
    run.json["images"]["made"]["time_attribute"] = "seconds";
    run.json["include"] = {{{"scheme", "nearest"}}};
    CHECK(run.run().failed == 0);
    const auto rows = run.rows();
    const Json made = rows.at("box.made.s1");
    CHECK(made["metrics"] == rows.at("box.nearest.f2.s1")["metrics"]);
    CHECK(made["time_s"]["reconstruct"].get<double>() > 0);
}

TEST_CASE("a command gets the planes that it asks for", "[image_source]") {
    CommandRun run;
    run.command({"cp", "{input}", "{output}"});
    run.json["images"]["made"]["planes"] = {"albedo_mean"};
    run.json["images"]["made"]["channels"] = {"AlbedoMean.R", "AlbedoMean.G", "AlbedoMean.B"};
    run.run();
    const std::string reason = run.row()["reason"].get<std::string>();
    CHECK_THAT(reason, Catch::Matchers::Contains("8x6"));  // read, and of the frame's size
    run.json["images"]["made"]["channels"] = {"N.X", "N.Y", "N.Z"};
    run.run();
    CHECK_THAT(run.row()["reason"].get<std::string>(), Catch::Matchers::Contains("N.X"));
}

TEST_CASE("images stand beside schemes, held against the same reference", "[image_source]") {
    CommandRun run;
    run.json["axes"].erase("image");
    run.json["axes"]["scheme"] = "nearest";
    run.json["include"] = {{{"image", "made"}}};
    CHECK(run.run().failed == 0);
    const auto rows = run.rows();
    CHECK(rows.at("box.made.s1")["reference_file"] ==
          rows.at("box.nearest.f2.s1")["reference_file"]);
    const auto groups = summarise(run.row_list(), {});
    CHECK_THAT(summary_table(groups), Catch::Matchers::Contains("box.made"));
}

TEST_CASE("held against a render, an image is of its size and depth", "[image_source]") {
    CommandRun run;
    run.json["axes"]["max_depth"] = {1, 2};
    CHECK(run.run().failed == 0);
    const auto rows = run.rows();
    CHECK(rows.at("box.made.d1.s1")["reference_file"] !=
          rows.at("box.made.d2.s1")["reference_file"]);
}

TEST_CASE("a matrix may put a file in the place of a render that it extends", "[image_source]") {
    const FileMatrix matrix;
    (void)matrix.load();
    matrix.temp.write("render.json",
                      R"({"extends": "files.json", "name": "render", "reference": {"spp": 4}})");
    matrix.temp.write(
        "file.json",
        R"({"extends": "render.json", "name": "file", "reference": {"file": "attic.exr"}})");
    CHECK(load_matrix(matrix.temp.path("render.json")).reference.spp == 4);
    CHECK(load_matrix(matrix.temp.path("render.json")).reference_source == nullptr);
    CHECK(load_matrix(matrix.temp.path("file.json")).reference_source->file == "attic.exr");
}

TEST_CASE("faults of images are told before anything runs", "[image_source]") {
    FileMatrix matrix;
    Json& first = matrix.json["images"]["first"];
    SECTION("neither a file nor a command") {
        first = Json::object();
        matrix.expect_fault("/images/first: found neither \"file\" nor \"command\"");
    }
    SECTION("both") {
        first["command"] = {"cp", "{output}"};
        matrix.expect_fault("found both \"file\" and \"command\"");
    }
    SECTION("a command that is not told where to write") {
        first = {{"command", {"cp"}}};
        matrix.expect_fault("/images/first/command: found no {output}");
    }
    SECTION("a file with {output}") {
        first = {{"file", "{output}.exr"}};
        matrix.expect_fault("found {output}, allowed: {scene}, {scene_file}");
    }
    SECTION("braces that do not match") {
        first["file"] = GENERATE("{scene", "scene}", "{{scene}");
        matrix.expect_fault("found braces that do not match");
    }
    SECTION("two channels") {
        first["channels"] = {"R", "G"};
        matrix.expect_fault("allowed: the names of three channels");
    }
    SECTION("an unknown key") {
        first["chanels"] = {"R", "G", "B"};
        matrix.expect_fault("chanels");
    }
    SECTION("two times") {
        first["time_attribute"] = "seconds";
        matrix.expect_fault("found both \"time_s\" and \"time_attribute\"");
    }
    SECTION("an unknown plane") {
        first = {{"command", {"cp", "{input}", "{output}"}}, {"planes", {"normals"}}};
        matrix.expect_fault("/images/first/planes/0: found \"normals\", allowed: radiance, direct");
    }
    SECTION("planes of no frame") {
        first["planes"] = {"normal"};
        matrix.expect_fault("/images/first/planes: found planes, and no {input}");
    }
    SECTION("an output of no known kind") {
        first = {{"command", {"cp", "{output}"}}, {"output", ".jpg"}};
        matrix.expect_fault("/images/first/output: found \".jpg\"");
    }
    SECTION("a name of ours") {
        matrix.json["images"]["nearest"] = first;
        matrix.expect_fault("/images/nearest: found the name \"nearest\"");
    }
    SECTION("an image that is not there") {
        matrix.json["axes"]["image"] = {"first", "third"};
        matrix.expect_fault("/axes/image/1: found \"third\", allowed: first, second");
    }
    SECTION("an image and a scheme") {
        matrix.json["axes"]["scheme"] = "nearest";
        matrix.expect_fault("found both \"scheme\" and \"image\"");
    }
    SECTION("an unknown key of the reference") {
        matrix.json["reference"]["spp"] = 4;
        matrix.expect_fault("/reference");
    }
}
