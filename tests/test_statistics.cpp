// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <utility>
#include <vector>

#include "eval/statistics.h"
#include "tests/catch.h"

using namespace vecino;

// From the closed form of the distribution for whole degrees of freedom (Abramowitz and Stegun
// 26.7.3 and 26.7.4), inverted by bisection.
TEST_CASE("quantiles of Student's t are right for any number of seeds", "[statistics]") {
    const auto [degrees, t] = GENERATE(table<std::size_t, double>(
        {{1, 12.706205},   {2, 4.302653},       {3, 3.182446},  {4, 2.776445},  {5, 2.570582},
         {6, 2.446912},    {7, 2.364624},       {8, 2.306004},  {9, 2.262157},  {10, 2.228139},
         {11, 2.200985},   {12, 2.178813},      {13, 2.160369}, {14, 2.144787}, {15, 2.131450},
         {16, 2.119905},   {17, 2.109816},      {18, 2.100922}, {19, 2.093024}, {20, 2.085963},
         {21, 2.079614},   {22, 2.073873},      {23, 2.068658}, {24, 2.063899}, {25, 2.059539},
         {26, 2.055529},   {27, 2.051831},      {28, 2.048407}, {29, 2.045230}, {30, 2.042272},
         {31, 2.039513},   {32, 2.036933},      {40, 2.021075}, {60, 2.000298}, {120, 1.979930},
         {1000, 1.962339}, {1u << 30, 1.959964}}));
    CAPTURE(degrees);
    CHECK(student95(degrees) == Approx(t).epsilon(0).margin(degrees > 30 ? 1e-5 : 1e-3));
}

TEST_CASE("an interval is t standard errors to each side of the mean", "[statistics]") {
    std::vector<double> values;
    for (int i = 0; i < 41; ++i) values.push_back(i);  // variance of the mean: 41 * 42 / 12 / 41
    const Estimate e = estimate(values);
    CHECK(e.mean == Approx(20.0));
    const double half = 2.021075 * std::sqrt(3.5);
    CHECK(e.low.value() == Approx(20.0 - half));
    CHECK(e.high.value() == Approx(20.0 + half));
}

TEST_CASE("one value is a mean without an interval", "[statistics]") {
    const Estimate e = estimate({0.25});
    CHECK(e.mean == 0.25);
    CHECK_FALSE(e.low);
    CHECK_FALSE(e.high);
    CHECK(estimate_db({20.0}).mean == Approx(20.0));
    CHECK_FALSE(estimate_db({20.0}).low);
}

TEST_CASE("decibels have the mean and the ends of the errors that they stand for", "[statistics]") {
    const Estimate e = estimate_db({20.0, 20.1, 20.3});
    const Estimate errors =
        estimate({std::pow(10.0, -2.0), std::pow(10.0, -2.01), std::pow(10.0, -2.03)});
    CHECK(e.mean == Approx(-10 * std::log10(errors.mean)));
    CHECK(e.low.value() == Approx(-10 * std::log10(*errors.high)));
    CHECK(e.high.value() == Approx(-10 * std::log10(*errors.low)));
}

TEST_CASE("errors whose interval reaches 0 have an open end in decibels", "[statistics]") {
    const Estimate e = estimate_db({10.0, 40.0});
    CHECK(e.low.value() < e.mean);
    CHECK_FALSE(e.high);
}
