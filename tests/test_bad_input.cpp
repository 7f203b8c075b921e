// SPDX-License-Identifier: Apache-2.0
//
// Mistakes on the command line, but for those about images (test_bad_images.cpp) and about what
// stands in JSON files (test_bad_documents.cpp).
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "tests/bad_input.h"
#include "tests/catch.h"

using namespace vecino;
using namespace vecino::test;

namespace {

std::string sound(const char* table) {
    const std::string path = std::string(VECINO_SOURCE_DIR) + "/tests/data/" + table;
    return nlohmann::json::parse(read_file(path)).at("sound").dump();
}

void write_documents(const TempDir& dir) {
    const std::string matrix = sound("faulty_matrices.json");
    const auto with = [&](const std::string& from, const std::string& to) {
        std::string text = matrix;
        return text.replace(text.find(from), from.size(), to);
    };
    dir.write("scene.json", sound("faulty_scenes.json"));
    dir.write("bad_scene.json", "{\"camera\": 1}");
    dir.write("matrix.json", matrix);
    dir.write("no_scene.json", with("scene.json", "missing.json"));
    dir.write("bad_matrix.json", with("scene.json", "bad_scene.json"));
    dir.write("old.exr", "an older result");
    for (const char* folder : {"folder.exr", "empty", "other", "no_rows", "broken"})
        std::filesystem::create_directory(dir.path(folder));
    dir.write("other/run.json", "{\"name\": \"other\"}");
    dir.write("other/results.jsonl", "{\"cell\": \"a.path.s1\"}\n");
    dir.write("other/.lock", "");
    dir.write("no_rows/results.jsonl", "");
    dir.write("broken/results.jsonl", "{\"cell\": 7}\n[]\nno JSON\n");
}

}  // namespace

// clang-format off
TEST_CASE("mistakes in what to do", "[bad_input]") {
    const TempDir dir;
    write_documents(dir);
    const Mistake mistakes[] = {
        {"no command", "", 64, "A subcommand is required"},
        {"an unknown command", "paint", 64, "found \"paint\", allowed: render, upsample, resize, merge, compare, run, report, check, accept, list, schema"},
        {"an unknown flag", "--loud", 64, "command line: "},
        {"a command in two lines", "\"paint\nit\"", 64, "found \"paint it\""},
        {"nothing to list", "list", 64, "WHAT is required"},
        {"an unknown list", "list colours", 64, "colours"},
        {"cells of no matrix", "list cells", 64, "list cells: found no CONFIG"},
        {"schemes of a matrix", "list schemes matrix.json", 64, "list schemes: found CONFIG \"matrix.json\", allowed: with cells only"},
        {"no schema", "schema", 64, "WHAT is required"},
        {"an unknown schema", "schema report", 64, "report"},
        {"two schemas", "schema scene matrix", 64, "matrix"},
    };
    check_mistakes(dir, mistakes);
}

TEST_CASE("mistakes of render", "[bad_input]") {
    const TempDir dir;
    write_documents(dir);
    const std::string to = "render scene.json -o old.exr ";
    const Mistake mistakes[] = {
        {"no scene", "render", 64, "required"},
        {"no output", "render scene.json", 64, "-o is required"},
        {"two scenes", "render scene.json scene.json -o old.exr", 64, "scene.json"},
        {"an unknown method", to + "--method best", 64, "method: found \"best\", allowed: path"},
        {"a flag that is not built", to + "--time-budget 1", 64, "--time-budget"},
        {"a flag of upsample", to + "--window 3", 64, "--window"},
        {"a flag without its value", to + "--spp", 64, "--spp"},
        {"a doubled flag", to + "--spp 4 --spp 8", 64, "--spp"},
        {"a doubled output", to + "-o out.exr", 64, "-o"},

        {"an empty size", to + "--size \"\"", 64, "--size"},
        {"one number as size", to + "--size 64", 64, "--size: found 64, allowed: WxH"},
        {"half a size", to + "--size 512x", 64, "--size: found \"512x\", allowed: WxH"},
        {"the other half", to + "--size x512", 64, "--size: found \"x512\", allowed: WxH"},
        {"a size of three", to + "--size 8x8x8", 64, "--size: found \"8x8x8\", allowed: WxH"},
        {"a size with a fraction", to + "--size 8.5x8", 64, "--size: found \"8.5x8\", allowed: WxH"},
        {"a size of zero", to + "--size 0x0", 64, "--size/0: found 0, allowed: an integer from 1 to 65536"},
        {"a negative size", to + "--size -1x5", 64, "--size/0: found -1, allowed: an integer from 1 to 65536"},
        {"a monstrous size", to + "--size 99999999x99999999", 64, "--size/0: found 99999999, allowed: an integer from 1 to 65536"},
        {"a size beyond 64 bits", to + "--size 99999999999999999999x1", 64, "--size: found \"99999999999999999999x1\""},
        {"too many pixels", to + "--size 65536x65536", 64, "--size: found [65536,65536], allowed: at most 2147483647 pixels"},

        {"no samples", to + "--spp 0", 64, "--spp: found 0, allowed: an integer of at least 1"},
        {"negative samples", to + "--spp -4", 64, "--spp: found -4, allowed: an integer of at least 1"},
        {"half a sample", to + "--spp 0.5", 64, "--spp: found 0.5, allowed: an integer of at least 1"},
        {"samples in words", to + "--spp many", 64, "--spp: found \"many\", allowed: an integer of at least 1"},
        {"samples and a letter", to + "--spp 4k", 64, "--spp: found \"4k\", allowed: an integer of at least 1"},
        {"an empty number of samples", to + "--spp \"\"", 64, "--spp"},
        {"samples beyond 31 bits", to + "--spp 2147483648", 64, "--spp: found 2147483648, allowed: an integer of at least 1"},
        {"samples beyond 64 bits", to + "--spp 99999999999999999999", 64, "--spp: found 1e+20, allowed: an integer of at least 1"},
        {"infinite samples", to + "--spp inf", 64, "--spp: found \"inf\", allowed: an integer of at least 1"},
        {"a negative depth", to + "--max-depth -1", 64, "--max-depth: found -1, allowed: an integer from 0 to 1000"},
        {"a huge depth", to + "--max-depth 1001", 64, "--max-depth: found 1001, allowed: an integer from 0 to 1000"},
        {"no reduction", to + "--reduction 0", 64, "--reduction: found 0, allowed: an integer from 1 to 65536"},
        {"a reduction with a fraction", to + "--reduction 1.5", 64, "--reduction: found 1.5"},
        {"a negative seed", to + "--seed -1", 64, "--seed: found -1, allowed: an integer of at least 0"},
        {"an unknown light sampling", to + "--light-sampling mis", 64, "--light-sampling: found \"mis\", allowed: none, nee"},
        {"an unknown sampler", to + "--sampler halton", 64, "--sampler: found \"halton\", allowed: independent, sobol"},
        {"an unknown first hit", to + "--first-hit last", 64, "--first-hit: found \"last\", allowed: first_sample, centre"},
        {"an unknown plane", to + "--planes colour", 64, "--planes: found \"colour\", allowed: all, radiance"},
        {"an empty plane", to + "--planes radiance,,id", 64, "--planes: found \"\", allowed: all, radiance"},
        {"no planes", to + "--planes \"\"", 64, "--planes"},
        {"no threads", to + "--threads 0", 64, "--threads"},
        {"too many threads", to + "--threads 1025", 64, "--threads"},
        {"an odd packet width", to + "--simd-width 5", 64, "--simd-width"},

        {"an unknown extension", "render scene.json -o out.gif", 64, "out.gif: found extension .gif, allowed: .exr"},
        {"no extension", "render scene.json -o out", 64, "out: found no extension, allowed: .exr"},
        {"a folder as output", "render scene.json -o folder.exr", 4, "folder.exr: cannot be written: it is a directory"},
        {"no folder for the output", "render scene.json -o none/out.png", 4, "none/out.png: cannot be written: none: No such file or directory"},
        {"a folder that makes no files", "render scene.json -o /proc/out.png", 4, "/proc/out.png: cannot be written: /proc: "},
        {"a name in two lines", "render \"no\nscene.json\" -o out.exr", 4, "no scene.json: cannot be read: "},
        {"usage before a missing file", "render missing.json -o out.gif", 64, "out.gif"},
        {"usage before a missing file", "render missing.json -o out.exr --spp 0", 64, "--spp"},
        {"bad content before an output that cannot be", "render bad_scene.json -o none/out.exr", 64, "bad_scene.json: /camera: found 1"},
    };
    check_mistakes(dir, mistakes);
}

TEST_CASE("mistakes of run and report", "[bad_input]") {
    const TempDir dir;
    write_documents(dir);
    const Mistake mistakes[] = {
        {"no matrix", "run", 64, "required"},
        {"no directory", "run matrix.json", 64, "-o is required"},
        {"an empty directory name", "run matrix.json -o \"\"", 64, "-o: found nothing"},
        {"an unknown kind of cells", "run matrix.json -o out --rerun some", 64, "--rerun: found \"some\", allowed: failed, stale, all"},
        {"no regular expression", "run matrix.json -o out --only ([", 64, "--only: found \"([\", allowed: an ECMAScript regular expression"},
        {"a regular expression of nothing", "run matrix.json -o out --only bicubic", 64, "--only: found \"bicubic\", allowed: an expression that matches a cell"},
        {"the same without running", "run matrix.json -o out --dry-run --only bicubic", 64, "--only: found \"bicubic\""},
        {"a doubled flag", "run matrix.json -o out --only a --only b", 64, "--only"},
        {"the directory of another matrix", "run matrix.json -o other", 64, "other: found results of the matrix \"other\", allowed: \"sound\" or an empty directory"},
        {"a file as directory", "run matrix.json -o old.exr", 4, "old.exr: cannot make the directory: "},
        {"no such scene", "run no_scene.json -o out", 4, "missing.json: cannot be read: No such file or directory"},
        {"a scene that is not sound", "run bad_matrix.json -o out", 64, "bad_scene.json: /camera: found 1, allowed: an object"},
        {"a scene as matrix", "run scene.json -o out", 64, "scene.json: /: found unknown key \"background\""},
        {"usage before a missing file", "run missing.json -o out --rerun some", 64, "--rerun"},
        {"usage before a directory that cannot be", "run matrix.json -o old.exr --only bicubic", 64, "--only"},
        {"bad content before a directory that cannot be", "run bad_matrix.json -o old.exr", 64, "bad_scene.json"},

        {"nothing to report", "report", 64, "DIR is required"},
        {"an empty directory name", "report \"\"", 64, "DIR: found nothing"},
        {"no such directory", "report nowhere", 4, "nowhere/results.jsonl: cannot be read: No such file or directory"},
        {"an empty directory", "report empty", 4, "empty/results.jsonl: cannot be read: No such file or directory"},
        {"a file as directory", "report old.exr", 4, "old.exr/results.jsonl: cannot be read: Not a directory"},
        {"no results", "report no_rows", 4, "no_rows/results.jsonl: holds no results"},
        {"results that are none", "report broken", 4, "broken/results.jsonl: holds no results"},
        {"a precision without embedding", "report other --embed-precision float16", 64, "--embed-precision: found without --embed, allowed: with it"},
        {"a precision that there is not", "report other --embed --embed-precision double", 64, "--embed-precision: found \"double\", allowed: float32, float16"},
        {"values embedded into a table", "report other --embed -o a.md", 64, "--embed: found with a.md, allowed: with an HTML page"},
        {"half a result", "report other", 4, "other/results.jsonl: row of cell a.path.s1 lacks group"},
    };
    check_mistakes(dir, mistakes);
}
// clang-format on
