// SPDX-License-Identifier: Apache-2.0
//
// exp(x) for x <= 0: the C library's does not give the same bits on every machine, and takes three
// times as long.
#pragma once

#include <bit>
#include <cstdint>

namespace vecino {

/// To 1e-7; 0 below -80 and for NaN.
inline float exp_of_negative(float x) {
    constexpr float kLog2E = 1.44269504f;
    constexpr float kLn2High = 0.693145752f;  // its product with k is exact
    constexpr float kLn2Low = 1.42860677e-6f;
    constexpr float kRounder = 0x1.8p23f;  // leaves the rounded integer k in the low bits
    if (x > -1e-3f) return 1.0f + x * (1.0f + 0.5f * x);  // most: points on a plane
    if (!(x >= -80.0f)) return 0.0f;
    const float shifted = x * kLog2E + kRounder;
    const float k = shifted - kRounder;
    const float r = (x - k * kLn2High) - k * kLn2Low;  // |r| <= ln(2) / 2
    const float high = (1.0f / 24) + r * ((1.0f / 120) + r * (1.0f / 720));
    const float power = 1.0f + r * (1.0f + r * (0.5f + r * ((1.0f / 6) + r * high)));
    const auto exponent = std::bit_cast<std::int32_t>(shifted) << 23;
    return std::bit_cast<float>(std::bit_cast<std::int32_t>(power) + exponent);
}

}  // namespace vecino
