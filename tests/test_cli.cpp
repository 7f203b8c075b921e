// SPDX-License-Identifier: Apache-2.0
//
// The program as a script sees it: exit codes, what stands on stdout, one line per error.
#include <sys/wait.h>

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/files.h"
#include "core/image_io.h"
#include "core/planes.h"
#include "tests/catch.h"
#include "tests/region_frames.h"
#include "tests/temp_dir.h"

using namespace vecino;

namespace {

struct Outcome {
    int code = -1;
    std::string out, err;
};

Outcome run(const TempDir& dir, const std::string& arguments) {
    const std::string out = dir.path("stdout.txt");
    const std::string err = dir.path("stderr.txt");
    const std::string command = "cd '" + dir.path(".") + "' && exec '" VECINO_PROGRAM "' " +
                                arguments + " >'" + out + "' 2>'" + err + "'";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(out), read_file(err)};
}

const std::string kScene = "'" VECINO_SOURCE_DIR "/scenes/cornell_sphere.json'";
const std::string kRender = "render " + kScene + " ";

Image noise(Extent size, float scale) {
    Image image(size);
    std::uint32_t state = 1;
    for (glm::vec3& value : image.values()) {
        for (int c = 0; c < 3; ++c) {
            state = state * 1664525u + 1013904223u;
            value[c] = scale * static_cast<float>(state >> 8) * 0x1p-24f;
        }
    }
    return image;
}

}  // namespace

TEST_CASE("render, upsample and compare make a pipeline of files", "[cli]") {
    const TempDir dir;
    const Outcome low = run(dir, kRender + "-o low.exr --size 48x32 --reduction 2 --spp 8 --json");
    REQUIRE(low.code == 0);
    const auto json = nlohmann::json::parse(low.out);
    CHECK(json["samples"] == 24 * 16 * 8);
    CHECK(json["dropped_samples"] == 0);
    CHECK(json["time_s"]["total"].get<double>() >= json["time_s"]["trace"].get<double>());
    const Frame frame = load_frame(dir.path("low.exr"));
    CHECK(frame.size() == Extent{24, 16});
    CHECK(planes_of(frame) == Planes::all());
    REQUIRE(run(dir, kRender + "-o ref.exr --size 48x32 --spp 64").code == 0);
    for (const char* scheme :
         {"nearest", "mean", "distance2d", "distance3d", "distance3d_normal"}) {
        CAPTURE(scheme);
        const Outcome up =
            run(dir,
                std::string("upsample low.exr -o up.exr --size 48x32 --window 5 --json --scheme ") +
                    scheme);
        REQUIRE(up.code == 0);
        CHECK(nlohmann::json::parse(up.out).contains("fallback_pixels"));
        const Outcome compared = run(dir, "compare up.exr ref.exr --json --error-map map.png");
        REQUIRE(compared.code == 0);
        const auto metrics = nlohmann::json::parse(compared.out);
        CHECK(metrics["psnr_float_db"].get<double>() > 8.0);
        CHECK(metrics["non_finite"]["count"] == 0);
        CHECK(std::filesystem::exists(dir.path("map.png")));
    }
}

TEST_CASE("limits decide between 0 and 2, and say which one failed", "[cli]") {
    const TempDir dir;
    save_image(noise({32, 32}, 1.0f), dir.path("a.exr"));
    save_image(noise({32, 32}, 0.9f), dir.path("b.exr"));
    CHECK(run(dir, "compare a.exr b.exr --min-psnr 10 --min-ssim 0.5 --max-relmse 1").code == 0);
    const Outcome worse = run(dir, "compare a.exr b.exr --min-psnr 60");
    CHECK(worse.code == 2);
    CHECK(worse.err.find("failed: psnr_db is") == 0);
    CHECK(run(dir, "compare a.exr b.exr --min-ssim 0.9999").code == 2);
    CHECK(run(dir, "compare a.exr b.exr --max-relmse 1e-9").code == 2);
    CHECK(run(dir, "compare a.exr a.exr --min-psnr 200").code == 0);  // identical passes any
    save_image(noise({8, 8}, 1.0f), dir.path("small.exr"));
    const Outcome small = run(dir, "compare small.exr small.exr --min-ssim 0.1");
    CHECK(small.code == 2);  // no ssim below 11 pixels: a missing value cannot pass
}

TEST_CASE("a non-finite pixel is reported and never scored", "[cli]") {
    const TempDir dir;
    Image image = noise({16, 16}, 1.0f);
    save_image(image, dir.path("good.exr"));
    image(3, 2).y = std::numeric_limits<float>::quiet_NaN();
    image(9, 5).x = std::numeric_limits<float>::infinity();
    save_image(image, dir.path("bad.exr"));
    const Outcome compared =
        run(dir, "compare bad.exr good.exr --json --error-map map.png --min-psnr 0");
    CHECK(compared.code == 5);
    const auto json = nlohmann::json::parse(compared.out);
    CHECK(json["psnr_db"].is_null());
    CHECK(json["non_finite"]["count"] == 2);
    CHECK(json["non_finite"]["first"] == nlohmann::json({3, 2, 1}));
    CHECK(std::filesystem::exists(dir.path("map.png")));
    const Outcome up = run(dir, "upsample bad.exr -o up.exr --size 32x32 --scheme nearest --json");
    CHECK(up.code == 5);
    CHECK(nlohmann::json::parse(up.out)["non_finite_pixels"] == 2);
    CHECK(load_image(dir.path("up.exr"))(6, 4) == glm::vec3(0.0f));
    const Outcome mean = run(dir, "upsample bad.exr -o up.exr --size 32x32 --scheme mean --json");
    CHECK(mean.code == 0);
    CHECK(nlohmann::json::parse(mean.out)["dropped_samples"] == 2);
    CHECK(mean.err.find("warning: bad.exr: 2 low-res pixels are not finite") == 0);
}

TEST_CASE("a reference with first hits gives metrics per region", "[cli]") {
    const TempDir dir;
    Frame frame = flat_frame({32, 32});
    frame.radiance = noise({32, 32}, 1.0f);
    frame.object_id(16, 16) = 1;
    save_frame(frame, dir.path("planes.exr"));
    save_image(frame.radiance, dir.path("plain.exr"));
    save_image(noise({32, 32}, 0.9f), dir.path("test.png"));
    const Outcome text = run(dir, "compare test.png planes.exr");
    CHECK(text.out.find("region              emitter         edge     interior\n") !=
          std::string::npos);
    CHECK(text.out.find("pixels                    0           25          999\n") !=
          std::string::npos);
    const auto json = nlohmann::json::parse(run(dir, "compare test.png planes.exr --json").out);
    CHECK(json["regions"]["edge"]["pixels"] == 25);
    CHECK(json["regions"]["edge"]["ssim"].is_number());
    CHECK(json["regions"]["emitter"]["ssim"].is_null());
    auto plain = nlohmann::json::parse(run(dir, "compare planes.exr plain.exr --json").out);
    CHECK_FALSE(plain.contains("regions"));
    CHECK(plain["identical_8bit"] == true);
    CHECK(run(dir, "compare test.png plain.exr").out.find("region") == std::string::npos);
    CHECK(run(dir, "compare --help").out.find("emitter: within width/32 px") != std::string::npos);
}

TEST_CASE("planes that cannot be read cost a comparison its regions only", "[cli]") {
    const TempDir dir;
    const OIIO::ImageSpec spec = [] {
        OIIO::ImageSpec s(12, 12, 4, OIIO::TypeDesc::FLOAT);
        s.channelnames = {"R", "G", "B", "N.X"};
        return s;
    }();
    const auto output = OIIO::ImageOutput::create(dir.path("part.exr"));
    REQUIRE(output->open(dir.path("part.exr"), spec));
    REQUIRE(output->write_image(spec.format, std::vector<float>(12 * 12 * 4, 0.5f).data()));
    REQUIRE(output->close());
    const Outcome outcome = run(dir, "compare part.exr part.exr --json");
    CHECK(outcome.code == 0);
    CHECK(nlohmann::json::parse(outcome.out)["mae"] == 0.0);
    CHECK(outcome.err.find("warning: no regions: part.exr: ") == 0);
}

TEST_CASE("a mistake is one line on stderr, nothing on stdout, its own exit code, and no file",
          "[cli]") {
    struct Mistake {
        std::string arguments;
        int code;
        std::string message;
    };
    const TempDir dir;
    std::ofstream(dir.path("broken.json")) << "{\"camera\": ";
    std::ofstream(dir.path("text.exr")) << "no image";
    save_image(noise({8, 8}, 1.0f), dir.path("rgb.exr"));
    save_image(noise({8, 9}, 1.0f), dir.path("tall.exr"));
    const std::vector<Mistake> mistakes = {
        {"", 64, "A subcommand is required"},
        {"paint", 64, "paint"},
        {kRender, 64, "-o is required"},
        {kRender + "-o out.exr --method path", 64, "--method"},
        {kRender + "-o out.exr --time-budget 1", 64, "--time-budget"},
        {kRender + "-o out.exr --size 0x5", 64, "command line: --size/0: found 0"},
        {kRender + "-o out.exr --size 64", 64, "command line: --size: found 64, allowed: WxH"},
        {kRender + "-o out.exr --spp 0", 64, "command line: --spp: found 0"},
        {kRender + "-o out.exr --spp many", 64, "command line: --spp: found \"many\""},
        {kRender + "-o out.exr --max-depth -1", 64, "command line: --max-depth: found -1"},
        {kRender + "-o out.exr --light-sampling mis", 64, "found \"mis\", allowed: none, nee"},
        {kRender + "-o out.exr --planes colour", 64,
         "--planes: found \"colour\", allowed: all, radiance"},
        {kRender + "-o out.exr --threads 0", 64, "--threads"},
        {kRender + "-o out.gif", 64, "out.gif"},
        {kRender + "-o none/out.png --size 4x4 --spp 1", 4, "none/out.png"},
        {"render missing.json -o out.exr", 4, "missing.json"},
        {"render broken.json -o out.exr", 64, "broken.json"},
        {"upsample rgb.exr -o out.exr --size 16x16 --scheme bicubic", 64, "bicubic"},
        {"upsample rgb.exr -o out.exr --size 16x16 --scheme mean --window 4", 64,
         "--window: found 4, allowed: an odd"},
        {"upsample rgb.exr -o out.exr --size 16x16 --scheme mean --guide rgb.exr", 64, "--guide"},
        {"upsample rgb.exr -o out.exr --size 16x16 --scheme distance3d", 3, "position"},
        {"upsample rgb.exr -o out.exr --size 4x4 --scheme mean", 3, "4x4"},
        {"upsample text.exr -o out.exr --size 16x16 --scheme mean", 4, "text.exr"},
        {"compare rgb.exr tall.exr", 3, "rgb.exr is 8x8, tall.exr is 8x9"},
        {"compare rgb.exr missing.exr", 4, "missing.exr"},
        {"compare rgb.exr rgb.exr --error-map out.vti", 64, "out.vti"},
        {"compare rgb.exr rgb.exr --min-psnr high", 64, "--min-psnr"},
        {"list cells", 64, "CONFIG"},
        {"list colours", 64, "colours"},
        {"run missing.json -o out", 4, "missing.json"},
        {"run missing.json -o out --rerun some", 64,
         "--rerun: found \"some\", allowed: failed, stale, all"},
        {"report nowhere", 4, "nowhere"},
    };
    for (const Mistake& mistake : mistakes) {
        CAPTURE(mistake.arguments);
        const Outcome outcome = run(dir, mistake.arguments);
        CHECK(outcome.code == mistake.code);
        CHECK(outcome.out.empty());
        CHECK(outcome.err.find("vecino: ") == 0);
        CHECK(outcome.err.find(mistake.message) != std::string::npos);
        CHECK(std::ranges::count(outcome.err, '\n') == 1);
        CHECK_FALSE(std::filesystem::exists(dir.path("out.exr")));
        CHECK_FALSE(std::filesystem::exists(dir.path("out")));
    }
}

TEST_CASE("the lists name what the tables hold", "[cli]") {
    const TempDir dir;
    const auto schemes = nlohmann::json::parse(run(dir, "list schemes --json").out);
    CHECK(schemes.size() == 5);
    CHECK(schemes[0]["name"] == "nearest");
    CHECK(nlohmann::json::parse(run(dir, "list metrics --json").out)[0]["name"] == "psnr_float_db");
    CHECK(run(dir, "list methods").out.find("path ") == 0);
    const Outcome cells = run(dir, "list cells '" VECINO_SOURCE_DIR "/configs/thesis-quick.json'");
    CHECK(cells.out.find("cornell_sphere.distance3d_normal.f2.w7.s1\n") != std::string::npos);
}

TEST_CASE("version and help answer with 0", "[cli]") {
    const TempDir dir;
    const Outcome version = run(dir, "--version");
    CHECK(version.code == 0);
    CHECK(version.out.find("vecino 0.") == 0);
    CHECK(version.out.find("Embree ") != std::string::npos);
    CHECK(run(dir, "render --help").out.find("--light-sampling") != std::string::npos);
}

TEST_CASE("a run that is killed or interrupted goes on and ends as if it had not been",
          "[cli][slow]") {
    const TempDir dir;
    dir.write("m.json",
              R"({"name": "m", "axes": {"scene": [")" VECINO_SOURCE_DIR R"(/scenes/cornell.json"],
        "scheme": ["nearest", "mean"], "reduction": [2, 3], "window": [3], "seed": [1, 2, 3, 4, 5, 6]},
        "fixed": {"size": [48, 48], "spp": 400}, "reference": {"spp": 256}})");
    REQUIRE(run(dir, "run m.json -o whole").code == 0);
    const Outcome stopped = run(dir, "run m.json -o cut & sleep 0.6; kill -INT $!; wait $!");
    CHECK((stopped.code == 130 || stopped.code == 0));
    run(dir, "run m.json -o cut & sleep 0.4; kill -KILL $!; wait $!");
    REQUIRE(run(dir, "run m.json -o cut").code == 0);
    const auto lasting = [&](const std::string& name) {
        std::map<std::string, nlohmann::json> rows;
        std::istringstream lines(read_file(dir.path(name + "/results.jsonl")));
        for (std::string line; std::getline(lines, line);) {
            auto row = nlohmann::json::parse(line);
            row.erase("time_s");
            rows[row["cell"]] = row;
        }
        return rows;
    };
    CHECK(lasting("cut").size() == 6 * 5);
    CHECK(lasting("cut") == lasting("whole"));
    CHECK(run(dir, "run m.json -o cut --dry-run").out.find("0 cells to do") == 0);
}

TEST_CASE("the number of threads does not change a file's pixels", "[cli]") {
    const TempDir dir;
    REQUIRE(run(dir, kRender + "-o one.exr --size 24x24 --spp 8 --threads 1").code == 0);
    REQUIRE(run(dir, kRender + "-o seven.exr --size 24x24 --spp 8 --threads 7").code == 0);
    CHECK(load_frame(dir.path("one.exr")).radiance == load_frame(dir.path("seven.exr")).radiance);
    CHECK(load_frame(dir.path("one.exr")).variance == load_frame(dir.path("seven.exr")).variance);
}
