// SPDX-License-Identifier: Apache-2.0
//
// Times to equal error, against power laws that are known.
#include <cmath>
#include <string>

#include "eval/equal_error.h"
#include "tests/catch.h"
#include "tests/group_summaries.h"

using namespace vecino;
using Kind = EqualErrorFactor::Kind;

namespace {

constexpr double kSecondsPerSample = 0.01;

GroupSummary finished(const std::string& method, const nlohmann::json& more, double error,
                      double time_s) {
    GroupSummary group = group_of(method, more, {error, error});
    group.psnr_float_db = Estimate{-10 * std::log10(error), {}, {}};
    group.time_s = time_s;
    return group;
}

/// error = 1 / spp at 4, 16 and 64 spp.
void add_paths(Groups& groups, const nlohmann::json& params) {
    for (const int spp : {4, 16, 64}) {
        nlohmann::json own = params;
        own["spp"] = spp;
        groups.push_back(finished("path", own, 1.0 / spp, kSecondsPerSample * spp));
    }
}

GroupSummary budget(double seconds, double error) {
    return finished("auto", {{"time_budget", seconds}}, error, seconds);
}

}  // namespace

TEST_CASE("a budget is held against the time in which others reach its error", "[equal_error]") {
    Groups groups;
    add_paths(groups, {{"sampler", "independent"}});
    groups.push_back(budget(0.02, 1.0 / 32));
    groups.push_back(budget(0.05, 1.0 / 640));
    groups.push_back(budget(0.01, 1.0 / 2));
    const EqualErrorTable table = equal_error(groups);
    REQUIRE(table.rivals == std::vector<std::string>{"path"});
    REQUIRE(table.rows.size() == 3);
    const auto factor = [&](std::size_t row) { return table.rows[row].factors.at(0).value(); };
    CHECK(factor(0).kind == Kind::measured);
    CHECK(factor(0).factor == Approx(0.32 / 0.02));
    CHECK(factor(1).kind == Kind::extrapolated);
    CHECK(factor(1).factor == Approx(6.4 / 0.05));
    CHECK(factor(2).kind == Kind::at_most);
    CHECK(factor(2).factor == Approx(0.04 / 0.01));
    CHECK(equal_error_text(table.rows[0].factors[0]) == "× 16.0");
    CHECK(equal_error_text(table.rows[1].factors[0]) == "× 128 e");
    CHECK(equal_error_text(table.rows[2].factors[0]) == "≤ × 4.00");
    CHECK(equal_error_text(std::nullopt) == "–");
}

TEST_CASE("rivals are told apart by what varies among them, and keep to their scene",
          "[equal_error]") {
    Groups groups;
    add_paths(groups, {{"sampler", "independent"}});
    add_paths(groups, {{"sampler", "sobol"}});
    groups.push_back(budget(0.02, 1.0 / 32));
    groups.push_back(
        finished("auto", {{"time_budget", 0.02}, {"scene", "scenes/other.json"}}, 1.0 / 32, 0.02));
    const EqualErrorTable table = equal_error(groups);
    CHECK(table.rivals == std::vector<std::string>{"path, independent", "path, sobol"});
    REQUIRE(table.rows.size() == 2);
    CHECK(table.rows[0].factors[1].has_value());
    CHECK_FALSE(table.rows[1].factors[0].has_value());
}

TEST_CASE("without budgets, or with one spp alone, nothing is compared", "[equal_error]") {
    Groups groups;
    add_paths(groups, {});
    CHECK(equal_error(groups).rows.empty());
    groups.erase(groups.begin() + 1, groups.end());
    groups.push_back(budget(0.02, 1.0 / 32));
    CHECK(equal_error(groups).rivals.empty());
    CHECK(equal_error(groups).rows.size() == 1);
}
