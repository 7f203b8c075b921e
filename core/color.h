// SPDX-License-Identifier: Apache-2.0
//
// sRGB (IEC 61966-2-1): its transfer curve and its luminance, in the one place that knows them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace vecino {

/// Linear [0,1] to sRGB-encoded [0,1]; values outside are clipped first.
inline float srgb_encode(float linear) {
    const float x = std::clamp(linear, 0.0f, 1.0f);
    return x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
}

/// How fast the encoded value changes with a linear one in [0,1].
inline float srgb_slope(float linear) {
    return linear < 0.0031308f ? 12.92f : 0.4395833f * std::pow(linear, -0.5833333f);
}

/// sRGB-encoded [0,1] to linear [0,1].
inline float srgb_decode(float encoded) {
    return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

/// Encoded [0,1] to 8 bit, rounded to nearest.
inline std::uint8_t quantise_8bit(float encoded) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(encoded, 0.0f, 1.0f) * 255.0f));
}

/// Of red, green and blue in luminance.
constexpr float kLuminance[3] = {0.2126f, 0.7152f, 0.0722f};

/// Of linear radiance.
inline float luminance(float r, float g, float b) {
    return kLuminance[0] * r + kLuminance[1] * g + kLuminance[2] * b;
}
inline double luminance(const float (&rgb)[3]) {
    return 0.2126 * static_cast<double>(rgb[0]) + 0.7152 * static_cast<double>(rgb[1]) +
           0.0722 * static_cast<double>(rgb[2]);
}

}  // namespace vecino
