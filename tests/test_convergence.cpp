// SPDX-License-Identifier: Apache-2.0
//
// Slopes and speed-ups against power laws that are known.
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "eval/convergence.h"
#include "tests/catch.h"
#include "tests/group_summaries.h"
#include "tests/page_text.h"

using namespace vecino;

namespace {

/// error = factor spp^slope, at s_per_sample seconds a sample.
struct Law {
    double factor, slope, s_per_sample;
};

const std::vector<int> kLadder{1, 4, 16, 64, 256};

/// A finished group of path tracing on scene "box" whose error and time follow a law.
GroupSummary path_group(const nlohmann::json& params, int spp, const Law& law) {
    nlohmann::json own = params;
    own["spp"] = spp;
    own["spp_asked"] = spp;
    GroupSummary group = group_of("path", own, {1e-3, 1e-3});
    const double error = law.factor * std::pow(spp, law.slope);
    group.relmse = Estimate{error, 0.9 * error, 1.1 * error};
    group.trace_s = law.s_per_sample * spp;
    group.statistics->whole.relative.noise = 0.5 * error;
    group.psnr_float_db = Estimate{30, {}, {}};
    return group;
}

void add_ladder(Groups& groups, const nlohmann::json& params, const Law& law) {
    for (const int spp : kLadder) groups.push_back(path_group(params, spp, law));
}

nlohmann::json chance(const std::string& sampler = "independent") {
    return {{"light_sampling", "none"}, {"sampler", sampler}};
}
nlohmann::json nee(const std::string& sampler, const std::string& light_point = "area") {
    return {{"light_sampling", "nee"}, {"sampler", sampler}, {"light_point", light_point}};
}

const ConvergenceCurve& curve_named(const std::vector<ConvergenceCurve>& curves,
                                    const std::string& variant) {
    for (const ConvergenceCurve& curve : curves) {
        if (curve.variant == variant) return curve;
    }
    throw std::logic_error("no curve " + variant);
}

}  // namespace

TEST_CASE("a power law is fitted exactly", "[convergence]") {
    const double slope = GENERATE(-1.0, -1.5, 0.0, 0.7);
    std::vector<XY> points;
    for (const double x : {1.0, 3.0, 10.0, 400.0}) points.push_back({x, 5 * std::pow(x, slope)});
    const auto law = fit_power_law(points);
    REQUIRE(law);
    CHECK(law->slope == Approx(slope).margin(1e-12));
    CHECK(law->factor == Approx(5));
    CHECK(law->slope_error.value() == Approx(0).margin(1e-12));
    CHECK(law->at(20) == Approx(5 * std::pow(20, slope)));
}

TEST_CASE("a fit needs two different x, and its error a third point", "[convergence]") {
    CHECK_FALSE(fit_power_law({}));
    const std::vector<XY> same{{2, 1}, {2, 3}};
    CHECK_FALSE(fit_power_law(same));
    // What has no logarithm plays no part.
    const std::vector<XY> two{{1, 1}, {10, 0.1}, {100, 0}, {-1, 1}};
    const auto law = fit_power_law(two);
    REQUIRE(law);
    CHECK(law->slope == Approx(-1));
    CHECK_FALSE(law->slope_error);
}

TEST_CASE("the standard error of a slope is that of many noisy fits", "[convergence]") {
    std::mt19937 engine(7);
    constexpr int kFits = 4000;
    const double sigma = 0.2;
    double sum = 0, squares = 0, stated2 = 0;
    for (int i = 0; i < kFits; ++i) {
        std::vector<XY> points;
        for (const int spp : kLadder) {
            double noise = -6;  // of twelve uniform numbers: nearly normal, variance 1
            for (int k = 0; k < 12; ++k) noise += (static_cast<double>(engine()) + 0.5) * 0x1p-32;
            points.push_back({static_cast<double>(spp), std::exp(sigma * noise) / spp});
        }
        const PowerLaw law = fit_power_law(points).value();
        sum += law.slope;
        squares += law.slope * law.slope;
        stated2 += *law.slope_error * *law.slope_error;
    }
    const double mean = sum / kFits;
    CHECK(mean == Approx(-1).margin(0.005));
    CHECK(stated2 / kFits == Approx(squares / kFits - mean * mean).epsilon(0.08));
}

TEST_CASE("groups that differ in spp alone make a curve, in the order of their spp",
          "[convergence]") {
    Groups groups;
    groups.push_back(path_group(chance(), 64, {1, -1, 1}));
    groups.push_back(path_group(chance(), 4, {1, -1, 1}));
    groups.push_back(path_group(nee("sobol"), 16, {1, -1, 1}));  // alone
    groups.push_back(group_of("nearest", {{"spp", 4}}, {1e-3}));
    groups.push_back(path_group({{"light_sampling", "none"}, {"scene", "other.json"}}, 8,
                                {1, -1, 1}));  // another scene
    const auto curves = convergence(groups);
    REQUIRE(curves.size() == 1);
    CHECK(curves[0].scene == "box");
    REQUIRE(curves[0].points.size() == 2);
    CHECK(curves[0].points[0].spp == 4);
    CHECK(curves[0].points[1].group == groups[0].group);
    CHECK(curves[0].is_baseline);
}

TEST_CASE("without groups that differ in spp there is no convergence", "[convergence]") {
    const Groups groups{path_group(chance(), 4, {1, -1, 1}),
                        path_group(nee("sobol"), 16, {1, -1, 1})};
    CHECK(convergence(groups).empty());
    CHECK(convergence_table({}).empty());
}

TEST_CASE("a group without error, time or samples is no point", "[convergence]") {
    Groups groups;
    add_ladder(groups, chance(), {1, -1, 1});
    groups[0].relmse = {};
    groups[1].trace_s = 0;
    groups[2].relmse->mean = 0;
    REQUIRE(convergence(groups).size() == 1);
    CHECK(convergence(groups)[0].points.size() == 2);
}

TEST_CASE("variants are named by what varies among those that find light alike", "[convergence]") {
    Groups groups;
    add_ladder(groups, nee("sobol"), {1, -1, 1});
    add_ladder(groups, nee("sobol", "solid_angle"), {1, -1, 1});
    add_ladder(groups, chance(), {1, -1, 1});
    const auto curves = convergence(groups);
    REQUIRE(curves.size() == 3);
    CHECK(curves[0].variant == "none");  // baselines first
    CHECK(curves[1].variant == "nee, area");
    CHECK(curves[2].variant == "nee, solid_angle");
}

TEST_CASE("slopes are those of error and variance against samples, and of error against time",
          "[convergence]") {
    Groups groups;
    add_ladder(groups, chance(), {8, -1.25, 1e-3});
    for (GroupSummary& group : groups) group.trace_s = std::pow(group.trace_s, 0.5);
    const ConvergenceCurve curve = convergence(groups).at(0);
    CHECK(curve.error_by_spp->slope == Approx(-1.25));
    CHECK(curve.variance_by_spp->slope == Approx(-1.25));
    CHECK(curve.error_by_time->slope == Approx(-2.5));
    CHECK(curve.points[curve.judged].spp == 64);
}

TEST_CASE("the rate is that of the point that took longest", "[convergence]") {
    Groups groups;
    add_ladder(groups, chance(), {1, -1, 1});
    groups.back().trace_s = 512;  // 8x8 pixels, 256 spp
    CHECK(convergence(groups).at(0).samples_per_s == Approx(64 * 256 / 512.0));
}

TEST_CASE("between points, times to an error are straight in logarithms", "[convergence]") {
    Groups groups;
    add_ladder(groups, chance(), {8, -1, 1e-3});
    const ConvergenceCurve curve = convergence(groups).at(0);
    const auto found = time_to_error(curve, 0.4);  // 20 spp
    REQUIRE(found);
    CHECK(found->time_s == Approx(0.02));
    CHECK_FALSE(found->is_extrapolated);
    CHECK(time_to_error(curve, 8)->time_s == Approx(1e-3));
    CHECK_FALSE(time_to_error(curve, 8.1));  // more than at 1 spp
}

TEST_CASE("beyond the last point the time follows the slope and the last rate", "[convergence]") {
    Groups groups;
    add_ladder(groups, chance(), {8, -2, 1e-3});
    const ConvergenceCurve curve = convergence(groups).at(0);
    const auto found = time_to_error(curve, 8 / std::pow(2560, 2));
    REQUIRE(found);
    CHECK(found->time_s == Approx(2.56));
    CHECK(found->is_extrapolated);
}

TEST_CASE("an error that does not fall is never reached", "[convergence]") {
    Groups groups;
    add_ladder(groups, chance(), {1, 0.1, 1});
    CHECK_FALSE(time_to_error(convergence(groups).at(0), 0.5));
}

TEST_CASE("an error that came back is reached where it is left for good", "[convergence]") {
    Groups groups;
    add_ladder(groups, chance(), {1, -1, 1});  // 1, 1/4, 1/16, 1/64, 1/256
    groups[2].relmse->mean = 0.5;
    const auto found = time_to_error(convergence(groups).at(0), 0.3);
    REQUIRE(found);
    CHECK(found->time_s > 16);
    CHECK(found->time_s < 64);
}

TEST_CASE("speed-ups at equal error are ratios of times", "[convergence]") {
    Groups groups;
    add_ladder(groups, chance(), {10, -1, 1e-3});
    add_ladder(groups, nee("independent"), {1, -1, 2e-3});  // a tenth of the error, twice the time
    add_ladder(groups, nee("sobol"), {1e-3, -1, 2e-3});
    const auto curves = convergence(groups);
    const ConvergenceCurve& near = curve_named(curves, "nee, independent");
    REQUIRE(near.speed_up);
    CHECK(near.speed_up->factor == Approx(5));
    CHECK(near.speed_up->is_extrapolated);  // 1/64 is beyond the baseline's 10/256
    REQUIRE(near.common);
    CHECK(near.common->factor == Approx(5));
    CHECK(near.common->most_error == Approx(1));
    CHECK(near.common->least_error == Approx(10.0 / 256));
    const ConvergenceCurve& far = curve_named(curves, "nee, sobol");
    CHECK(far.speed_up->factor == Approx(5000));
    CHECK(far.speed_up->is_extrapolated);
    CHECK_FALSE(far.common);  // 1e-3 at 1 spp, which the baseline never had
}

TEST_CASE("a speed-up within both curves is not extrapolated", "[convergence]") {
    Groups groups;
    add_ladder(groups, chance(), {1, -1, 1e-3});
    add_ladder(groups, nee("sobol"), {2, -1, 1e-3});
    const auto curves = convergence(groups);
    const auto found = curve_named(curves, "nee").speed_up;
    REQUIRE(found);
    CHECK(found->factor == Approx(0.5));
    CHECK_FALSE(found->is_extrapolated);
}

TEST_CASE("the mean speed-up over a range is that of the logarithms", "[convergence]") {
    Groups groups;
    add_ladder(groups, chance(), {1, -1, 1});
    add_ladder(groups, nee("sobol"), {1, -2, 1});
    const auto curves = convergence(groups);
    const auto common = curve_named(curves, "nee").common;
    REQUIRE(common);
    // At the error e the times are 1/e and 1/sqrt(e); between 1/256 and 1 the mean of log 1/e is
    // half of log 256.
    CHECK(common->factor == Approx(std::pow(256.0, 0.25)));
}

TEST_CASE("only what makes the same image is a baseline", "[convergence]") {
    Groups groups;
    nlohmann::json deep = chance();
    deep["max_depth"] = 3;
    add_ladder(groups, deep, {1, -1, 1e-3});
    nlohmann::json shallow = nee("sobol");
    shallow["max_depth"] = 2;
    add_ladder(groups, shallow, {1, -1, 1e-3});
    for (const ConvergenceCurve& curve : convergence(groups)) CHECK_FALSE(curve.speed_up);
}

TEST_CASE("the table and the JSON of convergence hold every curve", "[convergence]") {
    Groups groups;
    add_ladder(groups, chance(), {10, -1, 1e-3});
    add_ladder(groups, nee("sobol"), {1, -1.5, 2e-3});
    const auto curves = convergence(groups);
    const std::string table = convergence_table(curves);
    CHECK(has(table, "box: none"));
    CHECK(has(table, "-1.50 +-0.00"));
    CHECK(has(table, " e "));
    const nlohmann::json json = convergence_json(curves);
    REQUIRE(json.size() == 2);
    CHECK(json[0]["baseline"] == true);
    CHECK(json[0]["speed_up"].is_null());
    CHECK(json[1]["error_by_spp"]["slope"].get<double>() == Approx(-1.5));
    CHECK(json[1]["points"].size() == 5);
    CHECK(json[1]["points"][0]["variance"].get<double>() == Approx(0.5));
    CHECK(json[1]["speed_up"]["extrapolated"] == true);
}
