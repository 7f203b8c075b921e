// SPDX-License-Identifier: Apache-2.0
//
// What stands in the rows of a run, against the images that it left.
#include <string>
#include <vector>

#include "eval/ceiling.h"
#include "eval/metrics_json.h"
#include "tests/catch.h"
#include "tests/tiny_run.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;

struct SchemesRun : TinyMatrix {
    SchemesRun() {
        copy_scene("hall");
        json["axes"] = {
            {"scene", {"box.json", "hall.json"}},
            {"scheme", {"nearest", "mean", "distance2d", "distance3d", "distance3d_normal"}},
            {"reduction", {2, 3}},
            {"window", {3, 5}},
            {"seed", {1}}};
        json["fixed"] = {{"size", {32, 32}}, {"spp", 64}};
        run();
    }
};

std::vector<std::string> parts() {
    std::vector<std::string> names{""};
    for (const RegionInfo& info : kRegions) names.emplace_back(info.name);
    return names;
}

double psnr_of(const Json& row, const std::string& region) {
    const Json& metrics = row["metrics"];
    const Json& part = region.empty() ? metrics : metrics["regions"][region];
    return part["psnr_float_db"];
}

}  // namespace

TEST_CASE("the metrics of a row are those of its image, whole and by region", "[run_results]") {
    const SchemesRun run;
    std::size_t compared = 0;
    for (const auto& [name, row] : run.rows()) {
        if (row["method"] == "blocky_ceiling") continue;
        CAPTURE(name);
        const Frame reference = run.reference(row);
        const RegionMap regions = regions_of(reference);
        const Image image = load_image(run.image_file(name));
        CHECK(row["metrics"] == comparison_json(compare(image, reference.radiance, &regions)));
        const auto pixels = region_pixels(regions);
        for (const RegionInfo& info : kRegions) {
            const Json& part = row["metrics"]["regions"][std::string(info.name)];
            CHECK(part["pixels"] == pixels[region_index(info.region)]);
            CHECK(part["pixels"] > 0);
        }
        ++compared;
    }
    CHECK(compared == 2 * (1 + 2 + 4 * 2 * 2));
}

TEST_CASE("no scheme beats the ceiling of its reduction, whole or in any region", "[run_results]") {
    const SchemesRun run;
    const auto rows = run.rows();
    std::size_t beaten = 0;
    for (const auto& [name, row] : rows) {
        if (!row["params"].contains("window") && row["method"] != "nearest") continue;
        CAPTURE(name);
        const std::string factor = std::to_string(row["params"]["reduction"].get<int>());
        const Json& ceiling =
            rows.at(row["scene"].get<std::string>() + ".blocky_ceiling.f" + factor);
        for (const std::string& part : parts()) {
            CAPTURE(part);
            CHECK(psnr_of(ceiling, part) > psnr_of(row, part));
            ++beaten;
        }
    }
    CHECK(beaten == 4 * 2 * (2 + 4 * 2 * 2));
}

TEST_CASE("a ceiling takes no time and no samples, and its regions are those of their own best",
          "[run_results]") {
    const SchemesRun run;
    const Json row = run.rows().at("box.blocky_ceiling.f3");
    CHECK(row["time_s"]["total"] == 0);
    CHECK(row["counts"]["samples"] == 0);
    CHECK(row["samples_ratio"] == 0);
    const Frame reference = run.reference(row);
    const RegionMap regions = regions_of(reference);
    const Image whole = load_image(run.image_file("box.blocky_ceiling.f3"));
    CHECK(whole == blocky_ceiling(reference.radiance, {10, 10}));
    const Image by_region = blocky_ceiling(reference.radiance, {10, 10}, &regions);
    CHECK(row["metrics"]["regions"] ==
          comparison_json(compare(by_region, reference.radiance, &regions))["regions"]);
    CHECK(row["metrics"]["psnr_float_db"] ==
          compare(whole, reference.radiance).metrics->psnr_float_db.value());
}

TEST_CASE("ceilings of several depths and sizes are each held against their own reference",
          "[run_results]") {
    TinyMatrix run;
    run.json["axes"]["scheme"] = "nearest";
    run.json["axes"]["max_depth"] = {0, 2};
    run.json["axes"]["size"] = {{16, 12}, {8, 8}};
    CHECK(run.run().failed == 0);
    std::size_t ceilings = 0;
    for (const auto& [name, row] : run.rows()) {
        if (row["method"] != "blocky_ceiling") continue;
        CAPTURE(name);
        ++ceilings;
        const Image reference = run.reference(row).radiance;
        const Json& size = row["params"]["size"];
        CHECK(reference.size() == Extent{size[0], size[1]});
        CHECK(row["reference"]["max_depth"] == row["params"]["max_depth"]);
        const Extent low = reduced(reference.size(), 2);
        CHECK(load_image(run.image_file(name)) == blocky_ceiling(reference, low));
        const std::string suffix = name.substr(std::string("box.blocky_ceiling.f2").size());
        CHECK(row["reference_file"] ==
              run.rows().at("box.path" + suffix + ".s1")["reference_file"]);
    }
    CHECK(ceilings == 4);
}
