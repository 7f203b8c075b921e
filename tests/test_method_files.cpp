// SPDX-License-Identifier: Apache-2.0
//
// Render methods as the program and matrices know them.
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "core/channel_file.h"
#include "core/image_io.h"
#include "eval/matrix.h"
#include "tests/catch.h"
#include "tests/program.h"
#include "tests/temp_dir.h"

using namespace vecino;

namespace {

const std::string kRender =
    "render '" VECINO_SOURCE_DIR "/scenes/cornell_sphere.json' --size 40x32 --spp 16 ";

const Channel& channel(const ChannelFile& file, const std::string& name) {
    const auto found = std::ranges::find(file.channels, name, &Channel::name);
    REQUIRE(found != file.channels.end());
    return *found;
}

std::vector<std::string> names_in(const std::string& text) {
    const TempDir dir;
    std::vector<std::string> names;
    for (const Cell& cell : expand(load_matrix(dir.write("m.json", text))))
        names.push_back(cell.name);
    return names;
}

}  // namespace

TEST_CASE("a render tells which pixels its method traced", "[methods][cli]") {
    const TempDir dir;
    const Outcome outcome = run_in(
        dir, kRender + "-o x.exr --planes radiance --method adaptive --maps maps.exr --json");
    REQUIRE(outcome.code == 0);
    const auto facts = nlohmann::json::parse(outcome.out)["facts"];
    CHECK(facts["traced_share"] > 0.0);
    CHECK(facts["traced_share"].get<double>() + facts["interpolated_share"].get<double>() ==
          Approx(1));
    const ChannelFile maps = load_channels(dir.path("maps.exr"));
    const auto& counts = channel(maps, "SampleCount").values;
    const auto& traced = channel(maps, "Explicit").values;
    CHECK(channel(maps, "Calculated").values.size() == 40 * 32);
    double share = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        REQUIRE(counts[i] == 16 * traced[i]);
        share += static_cast<double>(traced[i]) / (40 * 32);
    }
    CHECK(facts["traced_share"] == Approx(share));
    // The frame has what it was asked for, and no more.
    CHECK(load_frame(dir.path("x.exr")).sample_count.empty());
}

TEST_CASE("maps are pictures side by side, one of path tracing", "[methods][cli]") {
    const TempDir dir;
    REQUIRE(run_in(dir, kRender + "-o x.png --method adaptive --maps maps.png").code == 0);
    CHECK(load_image(dir.path("maps.png")).size() == Extent{3 * 40 + 2 * 4, 32});
    REQUIRE(run_in(dir, kRender + "-o x.png --maps maps.png").code == 0);
    CHECK(load_image(dir.path("maps.png")).size() == Extent{40, 32});
}

TEST_CASE("what cannot be is one line, and no file", "[methods][cli]") {
    struct Fault {
        const char* arguments;
        const char* message;
    };
    const Fault faults[] = {
        {"-o x.exr --maps m.jpg",
         "vecino: m.jpg: found extension \".jpg\", allowed for --maps: .exr, .png, .bmp\n"},
        {"-o x.exr --maps m.png --samples 0:16",
         "vecino: command line: --maps: found with --samples, allowed: without\n"},
        {"-o x.exr --method adaptive --coarse-step 6",
         "vecino: command line: --coarse-step: found 6, allowed: 1, 2, 4, 8, 16, 32, 64\n"},
        {"-o x.exr --method adaptive --radius 2",
         "vecino: command line: --radius: found with --method adaptive, allowed: with reuse\n"},
        {"-o x.exr --method interleaved --interleaving subsequence --step 5",
         "vecino: spp: found 16, allowed with a subsequence for each of 25 pixels: 25 or more\n"},
    };
    for (const Fault& fault : faults) {
        CAPTURE(fault.arguments);
        const TempDir dir;
        const Outcome outcome = run_in(dir, kRender + fault.arguments);
        CHECK(outcome.code == 64);
        CHECK(outcome.err == fault.message);
        CHECK_FALSE(std::filesystem::exists(dir.path("x.exr")));
    }
}

TEST_CASE("a matrix sweeps options that schemes and methods share", "[methods][matrix]") {
    const std::string text = R"({"name": "m",
        "axes": {"scene": "s.json", "scheme": "mean", "reduction": 2, "window": 3},
        "include": [{"scheme": "distance3d", "weighting": ["inverse", "gaussian"]},
                    {"method": "reuse", "radius": [1, 2.5], "weighting": "gaussian"},
                    {"method": "adaptive", "coarse_step": 4, "spp": 8}],
        "fixed": {"weighting": "proportional"},
        "reference": {"spp": 16}})";
    CHECK(names_in(text) == std::vector<std::string>{
                                "s.path.s1", "s.blocky_ceiling.f2", "s.mean.f2.w3.s1",
                                "s.distance3d.f2.w3.inverse.s1", "s.distance3d.f2.w3.gaussian.s1",
                                "s.reuse.gaussian.r1.s1", "s.reuse.gaussian.r2.5.s1",
                                "s.path.spp8.s1", "s.adaptive.coarse4.spp8.s1"});
}
