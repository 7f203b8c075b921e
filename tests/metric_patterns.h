// SPDX-License-Identifier: Apache-2.0
//
// Images in integer arithmetic, so that a script of another program can make the same.
#pragma once

#include <cstdint>

#include "core/color.h"
#include "core/grid.h"

namespace vecino {

/// 0..255 from pixel, channel and seed; integer arithmetic, the same in the scripts that pinned
/// numbers come from.
inline std::uint32_t hash8(int x, int y, int c, std::uint32_t seed) {
    std::uint32_t h = static_cast<std::uint32_t>(x) * 73856093u ^
                      static_cast<std::uint32_t>(y) * 19349663u ^
                      static_cast<std::uint32_t>(c) * 83492791u ^ seed * 2654435761u;
    h = (h ^ h >> 13) * 0x5bd1e995u;
    return (h ^ h >> 15) & 255u;
}

inline std::uint32_t noise(int x, int y, int c, std::uint32_t seed) {
    return hash8(x, y, c, seed);
}

inline std::uint32_t ramp(int x, int y, int c, std::uint32_t seed) {
    return static_cast<std::uint32_t>((5 * x + 3 * y + 40 * c) % 200) + hash8(x, y, c, seed) % 16;
}

/// Coloured patches with steps and points; a seed moves their borders and adds noise.
inline std::uint32_t patches(int x, int y, int c, std::uint32_t seed) {
    const int patch = ((x + static_cast<int>(seed)) / 11 + y / 7) % 3;
    const bool is_point = x % 13 == 5 && y % 9 == 4 * static_cast<int>(seed % 2);
    return static_cast<std::uint32_t>(20 + 60 * ((patch + c) % 3) + (is_point ? 70 : 0)) +
           hash8(x, y, c, seed) % 24;
}

using Pattern = std::uint32_t (*)(int x, int y, int c, std::uint32_t seed);

/// The linear image whose 8-bit form holds the pattern; offset (in 8-bit steps) stays below the
/// quantisation.
inline Image linear_image(Pattern pattern, Extent size, std::uint32_t seed, float offset = 0) {
    Image image(size);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            for (int c = 0; c < 3; ++c)
                image(x, y)[c] =
                    srgb_decode((static_cast<float>(pattern(x, y, c, seed)) + offset) / 255.0f);
    return image;
}

}  // namespace vecino
