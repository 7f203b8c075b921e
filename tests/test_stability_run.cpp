// SPDX-License-Identifier: Apache-2.0
//
// "stability" of a matrix: from its cells to the report.
#include <nlohmann/json.hpp>

#include "eval/report_data.h"
#include "eval/report_sections.h"
#include "eval/report_tables.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/page_text.h"
#include "tests/tiny_run.h"

using namespace vecino;
using nlohmann::json;

namespace {

struct StableMatrix : TinyMatrix {
    StableMatrix() { json["stability"] = nlohmann::json::object(); }
};

const GroupStability& stability_of(const ReportData& data, const std::string& group) {
    const auto found = std::ranges::find(data.groups, group, &GroupSummary::group);
    REQUIRE(found != data.groups.end());
    REQUIRE(found->stability);
    return *found->stability;
}

}  // namespace

TEST_CASE("a run measures the stability that its matrix asks for", "[stability]") {
    const StableMatrix tiny;
    CHECK(tiny.run().done == 7);
    const auto rows = tiny.rows();
    const json& mean = rows.at("box.mean.f2.w3.s1")["stability"];
    REQUIRE(mean["shimmer"].size() == 2);
    CHECK(mean["shimmer"][0]["shift"] == 0.25);
    CHECK(mean["shimmer"][0]["change"] > 0);
    CHECK(mean["shimmer"][1]["reference_change"] > mean["shimmer"][0]["reference_change"]);
    CHECK(mean["elasticity"]["window"]["low"]["value"] == 1);
    CHECK(rows.at("box.nearest.f2.s1")["stability"]["elasticity"] == json::object());
    CHECK_FALSE(rows.at("box.blocky_ceiling.f2").contains("stability"));
    // A window of 1 is nearest.
    const double nearest_mse =
        std::pow(10, -0.1 * rows.at("box.nearest.f2.s1")["metrics"]["psnr_float_db"].get<double>());
    CHECK(mean["elasticity"]["window"]["low"]["mse"].get<double>() == Approx(nearest_mse));

    const ReportData data = read_report_data(tiny.directory);
    const GroupStability& s = stability_of(data, "box.mean.f2.w3");
    REQUIRE(s.shimmer.size() == 2);
    CHECK(s.shimmer[0].without_noise);
    CHECK(s.spread_db);
    CHECK(tiny.run().done == 0);
}

TEST_CASE("what the matrix asks for later is measured then, and nothing else", "[stability]") {
    StableMatrix tiny;
    tiny.json.erase("stability");
    CHECK(tiny.run().done == 7);
    CHECK_FALSE(has_stability(read_report_data(tiny.directory)));
    tiny.json["stability"] = {{"shifts", {0.5}}, {"elasticity", false}};
    CHECK(tiny.run().done == 6);  // all but the ceiling
    const json row = tiny.rows().at("box.mean.f2.w3.s1");
    CHECK(row["stability"]["shimmer"].size() == 1);
    CHECK_FALSE(row["stability"].contains("elasticity"));
    CHECK(tiny.run().done == 0);
    tiny.json["stability"] = {{"shifts", json::array()}};
    CHECK(tiny.run().done == 6);
    CHECK(tiny.rows().at("box.mean.f2.w3.s1")["stability"]["elasticity"].contains("window"));
}

TEST_CASE("the measured image is the same whether stability is asked for or not", "[stability]") {
    const StableMatrix with;
    with.run();
    TinyMatrix without;
    without.run();
    auto a = with.rows();
    for (const auto& [name, row] : without.rows()) {
        INFO(name);
        CHECK(a.at(name)["metrics"] == row["metrics"]);
        json params = row["params"];
        params["scene"] = a.at(name)["params"]["scene"];  // which lies elsewhere
        CHECK(a.at(name)["params"] == params);
        CHECK(a.at(name)["counts"] == row["counts"]);
    }
}

TEST_CASE("the report shows stability beside time and error", "[stability]") {
    const StableMatrix tiny;
    tiny.run();
    const ReportData data = read_report_data(tiny.directory);
    const std::string html = stability_html(data);
    for (const char* text : {"shimmer", "0.25 px", "0.5 px (noise)", "elasticity", "spread",
                             "worst seed", "fallback", "mean.<wbr>f2.<wbr>w3", "psnr_float_db"}) {
        INFO(text);
        CHECK(html.find(text) != std::string::npos);
    }
    CHECK(html.find("blocky_ceiling") == std::string::npos);
    const std::string markdown = report_markdown(data);
    CHECK(markdown.find("## Stability") != std::string::npos);
    CHECK(markdown.find("elasticity, window") != std::string::npos);
    const std::string jsonl = summary_jsonl(data);
    CHECK(jsonl.find("\"without_noise\"") != std::string::npos);
    // Without the images that tell noise from the rest, what the rows say is left.
    for (const auto& [name, row] : tiny.rows())
        std::filesystem::remove(tiny.directory + "/cells/" + name + "/shift_0.25.exr");
    const ReportData later = read_report_data(tiny.directory);
    const auto& shimmer = stability_of(later, "box.mean.f2.w3").shimmer;
    CHECK_FALSE(shimmer[0].without_noise);
    CHECK(shimmer[1].without_noise);
    CHECK(shimmer[0].with_noise ==
          Approx(stability_of(data, "box.mean.f2.w3").shimmer[0].with_noise));
}

TEST_CASE("a matrix may move the camera of cells and of what they are held against",
          "[stability]") {
    TinyMatrix tiny;
    tiny.json["axes"]["camera_shift"] = {{0, 0}, {0.5, -0.25}};
    tiny.run();
    const auto rows = tiny.rows();
    const json& moved = rows.at("box.mean.f2.w3.shift0.5_-0.25.s1");
    CHECK(moved["params"]["camera_shift"] == json({0.5, -0.25}));
    CHECK(moved["reference"]["camera_shift"] == json({0.5, -0.25}));
    const json& still = rows.at("box.mean.f2.w3.shift0_0.s1");
    CHECK_FALSE(still["params"].contains("camera_shift"));
    CHECK(still["reference_file"] != moved["reference_file"]);
    // Against its own reference, a moved camera errs as a still one does.
    const auto psnr = [](const json& row) { return row["metrics"]["psnr_float_db"].get<double>(); };
    CHECK(psnr(rows.at("box.path.shift0.5_-0.25.s1")) ==
          Approx(psnr(rows.at("box.path.shift0_0.s1"))).margin(3));
}
