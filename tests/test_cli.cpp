// SPDX-License-Identifier: Apache-2.0
//
// The program as a script sees it: exit codes, what stands on stdout. Its errors:
// test_bad_input.cpp.
#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/files.h"
#include "core/image_io.h"
#include "core/planes.h"
#include "filters/schemes.h"
#include "tests/catch.h"
#include "tests/program.h"
#include "tests/region_frames.h"
#include "tests/temp_dir.h"

using namespace vecino;

namespace {

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
    const Outcome low =
        run_in(dir, kRender + "-o low.exr --size 48x32 --reduction 2 --spp 8 --json");
    REQUIRE(low.code == 0);
    const auto json = nlohmann::json::parse(low.out);
    CHECK(json["samples"] == 24 * 16 * 8);
    CHECK(json["dropped_samples"] == 0);
    CHECK(json["time_s"]["total"].get<double>() >= json["time_s"]["trace"].get<double>());
    const Frame frame = load_frame(dir.path("low.exr"));
    CHECK(frame.size() == Extent{24, 16});
    CHECK(planes_of(frame) == Planes::all());
    REQUIRE(run_in(dir, kRender + "-o ref.exr --size 48x32 --spp 64").code == 0);
    for (const char* scheme :
         {"nearest", "mean", "distance2d", "distance3d", "distance3d_normal"}) {
        CAPTURE(scheme);
        const Outcome up = run_in(
            dir,
            std::string("upsample low.exr -o up.exr --size 48x32 --window 5 --json --scheme ") +
                scheme);
        REQUIRE(up.code == 0);
        CHECK(nlohmann::json::parse(up.out).contains("fallback_pixels"));
        const Outcome compared = run_in(dir, "compare up.exr ref.exr --json --error-map map.png");
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
    CHECK(run_in(dir, "compare a.exr b.exr --min-psnr 10 --min-ssim 0.5 --max-relmse 1").code == 0);
    const Outcome worse = run_in(dir, "compare a.exr b.exr --min-psnr 60");
    CHECK(worse.code == 2);
    CHECK(worse.err.find("failed: psnr_db is") == 0);
    CHECK(run_in(dir, "compare a.exr b.exr --min-ssim 0.9999").code == 2);
    CHECK(run_in(dir, "compare a.exr b.exr --max-relmse 1e-9").code == 2);
    CHECK(run_in(dir, "compare a.exr a.exr --min-psnr 200").code == 0);  // identical passes any
    save_image(noise({8, 8}, 1.0f), dir.path("small.exr"));
    const Outcome small = run_in(dir, "compare small.exr small.exr --min-ssim 0.1");
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
        run_in(dir, "compare bad.exr good.exr --json --error-map map.png --min-psnr 0");
    CHECK(compared.code == 5);
    const auto json = nlohmann::json::parse(compared.out);
    CHECK(json["psnr_db"].is_null());
    CHECK(json["non_finite"]["count"] == 2);
    CHECK(json["non_finite"]["first"] == nlohmann::json({3, 2, 1}));
    CHECK(std::filesystem::exists(dir.path("map.png")));
    const Outcome up =
        run_in(dir, "upsample bad.exr -o up.exr --size 32x32 --scheme nearest --json");
    CHECK(up.code == 5);
    CHECK(nlohmann::json::parse(up.out)["non_finite_pixels"] == 2);
    CHECK(load_image(dir.path("up.exr"))(6, 4) == glm::vec3(0.0f));
    const Outcome mean =
        run_in(dir, "upsample bad.exr -o up.exr --size 32x32 --scheme mean --json");
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
    const Outcome text = run_in(dir, "compare test.png planes.exr");
    CHECK(text.out.find("region              emitter         edge     interior\n") !=
          std::string::npos);
    CHECK(text.out.find("pixels                    0           25          999\n") !=
          std::string::npos);
    const auto json = nlohmann::json::parse(run_in(dir, "compare test.png planes.exr --json").out);
    CHECK(json["regions"]["edge"]["pixels"] == 25);
    CHECK(json["regions"]["edge"]["ssim"].is_number());
    CHECK(json["regions"]["emitter"]["ssim"].is_null());
    auto plain = nlohmann::json::parse(run_in(dir, "compare planes.exr plain.exr --json").out);
    CHECK_FALSE(plain.contains("regions"));
    CHECK(plain["identical_8bit"] == true);
    CHECK(run_in(dir, "compare test.png plain.exr").out.find("region") == std::string::npos);
    CHECK(run_in(dir, "compare --help").out.find("emitter: within width/32 px") !=
          std::string::npos);
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
    const Outcome outcome = run_in(dir, "compare part.exr part.exr --json");
    CHECK(outcome.code == 0);
    CHECK(nlohmann::json::parse(outcome.out)["mae"] == 0.0);
    CHECK(outcome.err.find("warning: no regions: part.exr: ") == 0);
}

TEST_CASE("the lists name what the tables hold", "[cli]") {
    const TempDir dir;
    const auto schemes = nlohmann::json::parse(run_in(dir, "list schemes --json").out);
    CHECK(schemes.size() == all_schemes().size());
    CHECK(schemes[0]["name"] == "nearest");
    CHECK(nlohmann::json::parse(run_in(dir, "list metrics --json").out)[0]["name"] ==
          "psnr_float_db");
    CHECK(run_in(dir, "list methods").out.find("path ") == 0);
    const Outcome cells =
        run_in(dir, "list cells '" VECINO_SOURCE_DIR "/configs/thesis-quick.json'");
    CHECK(cells.out.find("cornell_sphere.distance3d_normal.f2.w7.s1\n") != std::string::npos);
}

TEST_CASE("version and help answer with 0", "[cli]") {
    const TempDir dir;
    const Outcome version = run_in(dir, "--version");
    CHECK(version.code == 0);
    CHECK(version.out.find("vecino 0.") == 0);
    CHECK(version.out.find("Embree ") != std::string::npos);
    CHECK(run_in(dir, "render --help").out.find("--light-sampling") != std::string::npos);
}

TEST_CASE("a run that is killed or interrupted goes on and ends as if it had not been",
          "[cli][slow]") {
    const TempDir dir;
    dir.write("m.json",
              R"({"name": "m", "axes": {"scene": [")" VECINO_SOURCE_DIR R"(/scenes/cornell.json"],
        "scheme": ["nearest", "mean"], "reduction": [2, 3], "window": [3], "seed": [1, 2, 3, 4, 5, 6]},
        "fixed": {"size": [48, 48], "spp": 400}, "reference": {"spp": 256}})");
    REQUIRE(run_in(dir, "run m.json -o whole").code == 0);
    const Outcome stopped = run_in(dir, "run m.json -o cut & sleep 0.6; kill -INT $!; wait $!");
    CHECK((stopped.code == 130 || stopped.code == 0));
    run_in(dir, "run m.json -o cut & sleep 0.4; kill -KILL $!; wait $!");
    REQUIRE(run_in(dir, "run m.json -o cut").code == 0);
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
    CHECK(lasting("cut").size() == 6 * 5 + 2);  // and a ceiling for each reduction
    CHECK(lasting("cut") == lasting("whole"));
    CHECK(run_in(dir, "run m.json -o cut --dry-run").out.find("0 cells to do") == 0);
}

TEST_CASE("the number of threads does not change a file's pixels", "[cli]") {
    const TempDir dir;
    REQUIRE(run_in(dir, kRender + "-o one.exr --size 24x24 --spp 8 --threads 1").code == 0);
    REQUIRE(run_in(dir, kRender + "-o seven.exr --size 24x24 --spp 8 --threads 7").code == 0);
    CHECK(load_frame(dir.path("one.exr")).radiance == load_frame(dir.path("seven.exr")).radiance);
    CHECK(load_frame(dir.path("one.exr")).variance == load_frame(dir.path("seven.exr")).variance);
}
