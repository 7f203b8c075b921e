// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>
#include <vector>

#include "eval/summary.h"
#include "tests/catch.h"
#include "tests/result_rows.h"

using namespace vecino;

namespace {

using Rows = std::vector<nlohmann::json>;

/// One group, one seed per value of a metric.
GroupSummary summary_of(const std::string& metric, const std::vector<nlohmann::json>& values) {
    Rows rows;
    for (const nlohmann::json& value : values) {
        rows.push_back(result_row("mean", static_cast<int>(rows.size()) + 1));
        rows.back()["metrics"][metric] = value;
    }
    return summarise(rows).at(0);
}

nlohmann::json row_taking(const std::string& method, int seed, double seconds) {
    nlohmann::json row = result_row(method, seed);
    row["time_s"]["total"] = seconds;
    return row;
}

}  // namespace

TEST_CASE("decibels are averaged as mean squared errors", "[summary]") {
    // 10 dB and 20 dB stand for errors of 0.1 and 0.01.
    const auto psnr = summary_of("psnr_float_db", {10.0, 20.0}).psnr_float_db;
    REQUIRE(psnr);
    CHECK(psnr->mean == Approx(-10 * std::log10(0.055)));
    CHECK(psnr->mean < 15.0);
}

TEST_CASE("the interval of four seeds is 3.182 standard errors to each side", "[summary]") {
    const auto ssim = summary_of("ssim", {1.0, 2.0, 3.0, 4.0}).ssim;
    REQUIRE(ssim);
    CHECK(ssim->mean == Approx(2.5));
    const double half = 3.182 * std::sqrt(5.0 / 3.0) / 2.0;
    CHECK(ssim->low.value() == Approx(2.5 - half));
    CHECK(ssim->high.value() == Approx(2.5 + half));
}

TEST_CASE("the interval of two seeds is 12.706 standard errors to each side", "[summary]") {
    const auto relmse = summary_of("relmse", {1.0, 3.0}).relmse;
    REQUIRE(relmse);
    CHECK(relmse->high.value() - relmse->mean == Approx(12.706));
}

TEST_CASE("an interval in decibels has the ends of the errors that it stands for", "[summary]") {
    const auto psnr = summary_of("psnr_db", {20.0, 20.1, 20.2, 20.3}).psnr_db;
    REQUIRE(psnr);
    std::vector<nlohmann::json> errors;
    for (const double db : {20.0, 20.1, 20.2, 20.3}) errors.emplace_back(std::pow(10.0, -0.1 * db));
    const auto mse = summary_of("relmse", errors).relmse;
    CHECK(psnr->low.value() == Approx(-10 * std::log10(*mse->high)));
    CHECK(psnr->high.value() == Approx(-10 * std::log10(*mse->low)));
}

TEST_CASE("an interval of errors that reaches below zero is open above in decibels", "[summary]") {
    const auto psnr = summary_of("psnr_float_db", {10.0, 40.0}).psnr_float_db;
    REQUIRE(psnr);
    CHECK(psnr->low.value() < psnr->mean);
    CHECK_FALSE(psnr->high);
}

TEST_CASE("equal seeds have an interval of no width", "[summary]") {
    const auto psnr = summary_of("psnr_float_db", {30.0, 30.0, 30.0}).psnr_float_db;
    REQUIRE(psnr);
    CHECK(psnr->low.value() == Approx(30.0));
    CHECK(psnr->high.value() == Approx(30.0));
}

TEST_CASE("one seed has a mean but no interval", "[summary]") {
    const auto ssim = summary_of("ssim", {0.75}).ssim;
    REQUIRE(ssim);
    CHECK(ssim->mean == 0.75);
    CHECK_FALSE(ssim->low);
    CHECK_FALSE(ssim->high);
}

TEST_CASE("a metric that one seed lacks has no mean, and the other metrics keep theirs",
          "[summary]") {
    const GroupSummary group = summary_of("ssim", {0.5, nullptr, 0.7});
    CHECK_FALSE(group.ssim);
    CHECK(group.psnr_db);
    CHECK(group.seeds == 3);
}

TEST_CASE("the time of a group is the median over its seeds", "[summary]") {
    const auto groups = summarise(
        {row_taking("mean", 1, 1.0), row_taking("mean", 2, 9.0), row_taking("mean", 3, 2.0)});
    CHECK(groups.at(0).time_s == 2.0);
}

TEST_CASE("the time share is a part of the time of the path tracing that a row names",
          "[summary]") {
    nlohmann::json elsewhere = row_taking("path", 1, 100.0);
    elsewhere["scene"] = "hall";
    elsewhere["group"] = "hall.path";
    elsewhere["cell"] = "hall.path.s1";
    const auto groups =
        summarise({elsewhere, row_taking("mean", 1, 1.0), row_taking("path", 1, 4.0)});
    CHECK(groups.at(1).time_share == 0.25);
    CHECK(groups.at(2).time_share == 1.0);
}

TEST_CASE("without path tracing on the scene there is no time share", "[summary]") {
    CHECK(summarise({result_row("mean", 1)}).at(0).time_share == 0.0);
    CHECK(summarise({failed_row("path", 1, ""), result_row("mean", 1)}).at(1).time_share == 0.0);
}

TEST_CASE("failed seeds are counted and enter no mean", "[summary]") {
    nlohmann::json good = row_taking("mean", 1, 3.0);
    good["metrics"]["ssim"] = 0.9;
    const GroupSummary group = summarise({failed_row("mean", 2, "no light"), good}).at(0);
    CHECK(group.seeds == 1);
    CHECK(group.failed == 1);
    CHECK(group.time_s == 3.0);
    REQUIRE(group.ssim);
    CHECK(group.ssim->mean == 0.9);
    CHECK(group.cells == std::vector<std::string>{"box.mean.s2", "box.mean.s1"});
}

TEST_CASE("a group whose seeds all failed has no numbers", "[summary]") {
    const GroupSummary group =
        summarise({failed_row("mean", 1, "a"), failed_row("mean", 2, "b")}).at(0);
    CHECK(group.seeds == 0);
    CHECK(group.failed == 2);
    CHECK_FALSE(group.psnr_float_db);
    CHECK_FALSE(group.relmse);
    CHECK(group.time_s == 0.0);
}

TEST_CASE("groups stand in the order of their first rows", "[summary]") {
    const auto groups = summarise({result_row("path", 1), result_row("mean", 1),
                                   result_row("path", 2), result_row("distance2d", 1)});
    REQUIRE(groups.size() == 3);
    CHECK(groups[0].group == "box.path");
    CHECK(groups[0].seeds == 2);
    CHECK(groups[1].group == "box.mean");
    CHECK(groups[2].group == "box.distance2d");
}

TEST_CASE("a summary's JSON says null where there is no number", "[summary]") {
    const auto json = summary_json(summary_of("ssim", {nullptr}));
    CHECK(json["ssim"].is_null());
    CHECK(json["psnr_float_db"]["mean"] == 20.0);
    CHECK(json["psnr_float_db"]["low"].is_null());
}

TEST_CASE("the table for a terminal has a line for each group below its heading", "[summary]") {
    const std::string table =
        summary_table(summarise({result_row("path", 1), failed_row("mean", 1, "no light")}));
    CHECK(std::count(table.begin(), table.end(), '\n') == 3);
    CHECK(table.find("box.path") != std::string::npos);
    CHECK(table.find("box.mean") != std::string::npos);
    CHECK(table.find("20.00") != std::string::npos);
}
