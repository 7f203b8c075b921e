// SPDX-License-Identifier: Apache-2.0
#include "eval/distributions.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace vecino {
namespace {

/// The continued fraction of I_x(a, b) by Lentz's method. Converges fast for x < (a+1)/(a+b+2).
double beta_fraction(double x, double a, double b) {
    constexpr double tiny = 1e-300;
    constexpr int most_terms = 10000;
    const auto not_zero = [](double value) { return std::abs(value) < tiny ? tiny : value; };
    double c = 1;
    double d = 1 / not_zero(1 - (a + b) * x / (a + 1));
    double result = d;
    for (int m = 1; m < most_terms; ++m) {
        const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
        d = 1 / not_zero(1 + even * d);
        c = not_zero(1 + even / c);
        result *= d * c;
        const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
        d = 1 / not_zero(1 + odd * d);
        c = not_zero(1 + odd / c);
        result *= d * c;
        if (std::abs(d * c - 1) < 1e-15) break;
    }
    return result;
}

/// The x at which I_x(a, b) reaches a probability, by bisection: it grows with x.
double inverse_incomplete_beta(double probability, double a, double b) {
    double low = 0;
    double high = 1;
    while (high - low > std::numeric_limits<double>::epsilon() * high) {
        const double middle = 0.5 * (low + high);
        if (middle == low || middle == high) break;
        (incomplete_beta(middle, a, b) < probability ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

}  // namespace

double incomplete_beta(double x, double a, double b) {
    if (x <= 0) return 0;
    if (x >= 1) return 1;
    if (x > (a + 1) / (a + b + 2)) return 1 - incomplete_beta(1 - x, b, a);
    const double log_front =
        std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log1p(-x);
    return std::exp(log_front) * beta_fraction(x, a, b) / a;
}

double normal_tail(double z) {
    return 0.5 * std::erfc(z / std::numbers::sqrt2);
}

double student_tail(double t, double degrees) {
    const double both = incomplete_beta(degrees / (degrees + t * t), 0.5 * degrees, 0.5);
    return t >= 0 ? 0.5 * both : 1 - 0.5 * both;
}

double student_quantile(double tail, double degrees) {
    const double x = inverse_incomplete_beta(2 * tail, 0.5 * degrees, 0.5);
    return std::sqrt(degrees * (1 - x) / x);
}

}  // namespace vecino
