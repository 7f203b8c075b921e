// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics.h"

#include <array>
#include <cmath>

namespace vecino {
namespace {

constexpr std::array<double, 30> kStudent95 = {
    12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228,
    2.201,  2.179, 2.160, 2.145, 2.131, 2.120, 2.110, 2.101, 2.093, 2.086,
    2.080,  2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042};

/// Abramowitz and Stegun 26.7.5: t from the normal quantile x. Off by less than 2e-6 where the
/// table ends, and by ever less beyond.
double student95_expansion(double degrees) {
    constexpr double x = 1.959963984540054;
    constexpr double x2 = x * x;
    constexpr double g1 = x * (x2 + 1) / 4;
    constexpr double g2 = x * ((5 * x2 + 16) * x2 + 3) / 96;
    constexpr double g3 = x * (((3 * x2 + 19) * x2 + 17) * x2 - 15) / 384;
    return x + (g1 + (g2 + g3 / degrees) / degrees) / degrees;
}

}  // namespace

double student95(std::size_t degrees) {
    if (degrees <= kStudent95.size()) return kStudent95[degrees - 1];
    return student95_expansion(static_cast<double>(degrees));
}

Estimate estimate(const std::vector<double>& values) {
    const auto n = static_cast<double>(values.size());
    Estimate result;
    for (const double value : values) result.mean += value / n;
    if (values.size() < 2) return result;
    double squares = 0;
    for (const double value : values) squares += (value - result.mean) * (value - result.mean);
    const double half = student95(values.size() - 1) * std::sqrt(squares / (n - 1) / n);
    result.low = result.mean - half;
    result.high = result.mean + half;
    return result;
}

Estimate estimate_db(const std::vector<double>& values_db) {
    std::vector<double> mse;
    for (const double db : values_db) mse.push_back(std::pow(10.0, -0.1 * db));
    const Estimate linear = estimate(mse);
    const auto to_db = [](double value) { return -10.0 * std::log10(value); };
    Estimate result{to_db(linear.mean), {}, {}};
    if (!linear.low) return result;
    // A wide interval may reach below an error of 0: its upper end in dB is then open.
    if (*linear.low > 0) result.high = to_db(*linear.low);
    result.low = to_db(*linear.high);
    return result;
}

}  // namespace vecino
