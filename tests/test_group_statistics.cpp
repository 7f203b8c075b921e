// SPDX-License-Identifier: Apache-2.0
//
// Noise and bias of a run's groups: computed from its images, kept, and computed anew when need be.
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "eval/group_statistics.h"
#include "eval/summary.h"
#include "tests/catch.h"
#include "tests/tiny_run.h"

using namespace vecino;

namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

const std::string kGroup = "box.nearest.f2";

struct SeedRun : TinyMatrix {
    SeedRun() {
        json["axes"]["seed"] = {1, 2, 3};
        run();
    }

    [[nodiscard]] StatisticsByGroup statistics() const {
        return group_statistics(RunDirectory::open(directory), row_list());
    }
    /// From the images, without what is kept.
    [[nodiscard]] SeedStatisticsByRegion by_hand(const std::string& group) const {
        std::vector<Image> images;
        Frame reference_frame;
        for (const Json& row : row_list()) {
            if (row["group"] != group) continue;
            images.push_back(load_image(image_file(row["cell"])));
            reference_frame = reference(row);
        }
        const RegionMap regions = regions_of(reference_frame);
        return seed_statistics(images, reference_frame.radiance, &regions).value();
    }
    void blacken(const std::string& cell) const { save_image(Image({16, 12}), image_file(cell)); }
    void change_row(const std::string& cell, const std::string& key, const Json& value) const {
        auto changed = rows();
        changed.at(cell)[key] = value;
        write_rows(changed);
    }
};

}  // namespace

TEST_CASE("a group's statistics are those of its images", "[group_statistics]") {
    const SeedRun run;
    const auto statistics = run.statistics();
    REQUIRE(statistics.size() == 4);  // path tracing, two schemes, a ceiling
    for (const auto& [group, found] : statistics) {
        CAPTURE(group);
        CHECK(found == run.by_hand(group));
        CHECK(found.regions);
    }
    CHECK(statistics.at(kGroup).whole.mse.size() == 3);
    CHECK(statistics.at(kGroup).whole.noise.value() > 0);
    CHECK(statistics.at(kGroup).whole.noise_by_seed.size() == 3);
    CHECK(statistics.at("box.blocky_ceiling.f2").whole.mse.size() == 1);
}

TEST_CASE("statistics are kept, and read without the images", "[group_statistics]") {
    const SeedRun run;
    const auto first = run.statistics();
    const std::string kept = run.temp.read("run/statistics.json");
    fs::remove_all(run.directory + "/cells");
    fs::remove_all(run.directory + "/references");
    CHECK(run.statistics() == first);
    CHECK(run.temp.read("run/statistics.json") == kept);
    fs::remove(run.directory + "/statistics.json");
    CHECK(run.statistics().empty());
}

TEST_CASE("a group whose row changed is computed anew, and no other", "[group_statistics]") {
    const SeedRun run;
    const auto before = run.statistics();
    run.blacken(kGroup + ".s2");
    run.blacken("box.path.s2");
    CHECK(run.statistics() == before);  // nothing says that images changed
    const auto [key, value] = GENERATE(table<std::string, Json>(
        {{"build", "another"}, {"scene_hash", "another"}, {"params", Json{{"spp", 9}}}}));
    CAPTURE(key);
    run.change_row(kGroup + ".s2", key, value);
    const auto after = run.statistics();
    CHECK(after.at(kGroup) == run.by_hand(kGroup));
    CHECK(after.at(kGroup) != before.at(kGroup));
    CHECK(after.at("box.path") == before.at("box.path"));
    CHECK(after.size() == before.size());
}

TEST_CASE("a group with a failed cell has no statistics", "[group_statistics]") {
    const SeedRun run;
    REQUIRE(run.statistics().contains(kGroup));
    const Json before = run.rows().at(kGroup + ".s2");
    run.change_row(kGroup + ".s2", "status", "failed");
    const auto statistics = run.statistics();
    CHECK_FALSE(statistics.contains(kGroup));
    CHECK(statistics.contains("box.path"));
    CHECK_FALSE(Json::parse(run.temp.read("run/statistics.json")).contains(kGroup));
    run.change_row(kGroup + ".s2", "status", "ok");
    CHECK(run.statistics().contains(kGroup));
}

TEST_CASE("a group without an image, or with one that is not finite, has no statistics",
          "[group_statistics]") {
    const SeedRun run;
    SECTION("no image") {
        fs::remove(run.image_file(kGroup + ".s2"));
    }
    SECTION("not finite") {
        Image image({16, 12});
        image(3, 3).y = std::numeric_limits<float>::infinity();
        save_image(image, run.image_file(kGroup + ".s2"));
    }
    const auto statistics = run.statistics();
    CHECK_FALSE(statistics.contains(kGroup));
    CHECK(statistics.size() == 3);
}

TEST_CASE("seeds that were held against two references have no statistics", "[group_statistics]") {
    const SeedRun run;
    run.change_row(kGroup + ".s2", "reference_file", "references/another");
    CHECK_FALSE(run.statistics().contains(kGroup));
    CHECK(run.statistics().contains("box.path"));
}

TEST_CASE("statistics that cannot be read are computed anew", "[group_statistics]") {
    const SeedRun run;
    const auto sound = run.statistics();
    Json file = Json::parse(run.temp.read("run/statistics.json"));
    SECTION("no JSON") {
        file = "gone";
    }
    SECTION("no object") {
        file = Json::array({1});
    }
    SECTION("no entry") {
        file[kGroup] = 3;
    }
    SECTION("another kind of key") {
        file[kGroup]["key"] = 3;
    }
    SECTION("no numbers") {
        file[kGroup].erase("statistics");
    }
    SECTION("a number less") {
        file[kGroup]["statistics"].erase("noise");
    }
    SECTION("a text for a number") {
        file[kGroup]["statistics"]["noise"] = "much";
    }
    const bool is_text = file == "gone";
    run.temp.write("run/statistics.json", is_text ? "{\"box" : file.dump());
    CHECK(run.statistics() == sound);
    // And kept again.
    CHECK(Json::parse(run.temp.read("run/statistics.json"))[kGroup]["statistics"]["noise"] ==
          sound.at(kGroup).whole.noise.value());
}
