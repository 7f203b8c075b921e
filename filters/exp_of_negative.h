// SPDX-License-Identifier: Apache-2.0
//
// exp(x) for x <= 0: the C library's does not give the same bits on every machine, and takes three
// times as long.
#pragma once

#include <bit>
#include <cstdint>

namespace vecino {

/// To 1e-11; 0 below -600 and for NaN.
inline double exp_of_negative(double x) {
    constexpr double kLog2E = 0x1.71547652b82fep+0;
    constexpr double kLn2High = 0x1.62e42fee00000p-1;  // its product with k is exact
    constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
    constexpr double kRounder = 0x1.8p52;  // leaves the rounded integer k in the low bits
    if (!(x >= -600.0)) return 0.0;
    const double shifted = x * kLog2E + kRounder;
    const double k = shifted - kRounder;
    const double r = (x - k * kLn2High) - k * kLn2Low;  // |r| <= ln(2) / 2
    const double r2 = r * r;
    const double r4 = r2 * r2;
    const double low = (1.0 + r) + r2 * (1.0 / 2 + r * (1.0 / 6));
    const double middle = (1.0 / 24 + r * (1.0 / 120)) + r2 * (1.0 / 720 + r * (1.0 / 5040));
    const double high = 1.0 / 40320 + r * (1.0 / 362880);
    const double power = low + r4 * (middle + r4 * high);
    const auto exponent = std::bit_cast<std::int64_t>(shifted) << 52;
    return std::bit_cast<double>(std::bit_cast<std::int64_t>(power) + exponent);
}

}  // namespace vecino
