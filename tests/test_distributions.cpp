// SPDX-License-Identifier: Apache-2.0
//
// Against published tables, and against closed forms where there are some.
#include <cmath>
#include <numbers>

#include "eval/distributions.h"
#include "tests/catch.h"

using namespace vecino;

TEST_CASE("the incomplete beta function has its closed forms", "[distributions]") {
    const double x = GENERATE(1e-9, 0.001, 0.1, 0.3, 0.5, 0.77, 0.999);
    CHECK(incomplete_beta(x, 1, 1) == Approx(x).epsilon(1e-12));
    CHECK(incomplete_beta(x, 3, 1) == Approx(x * x * x).epsilon(1e-12));
    CHECK(incomplete_beta(x, 1, 4) == Approx(-std::expm1(4 * std::log1p(-x))).epsilon(1e-12));
    const double arcsine = 2 / std::numbers::pi * std::asin(std::sqrt(x));
    CHECK(incomplete_beta(x, 0.5, 0.5) == Approx(arcsine).epsilon(1e-11));
}

TEST_CASE("the tail of Student's t is Cauchy's at one degree and normal at many",
          "[distributions]") {
    const double t = GENERATE(-3.0, -0.5, 0.0, 0.1, 1.0, 4.0, 30.0);
    CHECK(student_tail(t, 1) == Approx(0.5 - std::atan(t) / std::numbers::pi).epsilon(1e-10));
    const double normal = normal_tail(t);
    if (normal > 1e-6) CHECK(student_tail(t, 1e8) == Approx(normal).epsilon(1e-5));
}

TEST_CASE("quantiles of Student's t are those of tables", "[distributions]") {
    const auto [tail, degrees, t] =
        GENERATE(table<double, double, double>({{0.025, 1, 12.706205},
                                                {0.025, 4, 2.776445},
                                                {0.025, 30, 2.042272},
                                                {0.005, 6, 3.707428},
                                                {0.001, 3, 10.214532},
                                                {0.001, 14, 3.787390},
                                                {0.0005, 20, 3.849516}}));
    CAPTURE(tail, degrees);
    CHECK(student_quantile(tail, degrees) == Approx(t).epsilon(1e-6));
    CHECK(student_tail(t, degrees) == Approx(tail).epsilon(1e-5));
}

TEST_CASE("three sigma of a normal distribution are a tail of 0.00135", "[distributions]") {
    CHECK(normal_tail(3) == Approx(0.001349898).epsilon(1e-6));
    CHECK(normal_tail(0) == 0.5);
    CHECK(student_quantile(normal_tail(0), 5) == Approx(0).margin(1e-7));
}
