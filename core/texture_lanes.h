// SPDX-License-Identifier: Apache-2.0
//
// A texture's value at a point of a surface, one lane at a time: texels lie anywhere in memory.
// Included only by trace_kernel.cpp, like lanes.h.
#pragma once

#include "core/trace_task.h"

namespace vecino {
namespace {

struct Texel {
    float rgb[3];
};

/// Two neighbouring texels of a row or column, and how far a point is from the first to the second.
struct TexelPair {
    std::int32_t first, second;
    float share;
};

/// at: in texels from the first one's centre. Beyond the centres at the borders, these go on.
inline TexelPair neighbours(float at, std::int32_t count) {
    const auto last = static_cast<float>(count - 1);
    const float inside = at > 0.0f ? (at < last ? at : last) : 0.0f;
    const auto first = static_cast<std::int32_t>(inside);
    return {first, first + 1 < count ? first + 1 : first, inside - static_cast<float>(first)};
}

/// Bilinear.
inline Texel look_up(const PlacedTexture& texture, const float (&position)[3]) {
    float uv[2];
    for (int k = 0; k < 2; ++k) {
        uv[k] = texture.at_origin[k];
        for (int c = 0; c < 3; ++c)
            uv[k] += texture.gradient[k][c] * (position[c] - texture.origin[c]);
    }
    const TexelPair x = neighbours(uv[0] * static_cast<float>(texture.width) - 0.5f, texture.width);
    const TexelPair y =
        neighbours((1.0f - uv[1]) * static_cast<float>(texture.height) - 0.5f, texture.height);
    const auto at = [&](std::int32_t column, std::int32_t row) {
        return texture.texels + 3 * (static_cast<std::int64_t>(row) * texture.width + column);
    };
    Texel texel;
    for (int c = 0; c < 3; ++c) {
        const float top =
            at(x.first, y.first)[c] * (1.0f - x.share) + at(x.second, y.first)[c] * x.share;
        const float bottom =
            at(x.first, y.second)[c] * (1.0f - x.share) + at(x.second, y.second)[c] * x.share;
        texel.rgb[c] = top * (1.0f - y.share) + bottom * y.share;
    }
    return texel;
}

}  // namespace
}  // namespace vecino
