// SPDX-License-Identifier: Apache-2.0
//
// Random numbers as pure functions of (seed, pixel, sample, dimension): no state, so the bits of a
// render do not depend on which thread traces which sample. Included only by trace_kernel.cpp, like
// lanes.h.
#pragma once

#include "core/lanes.h"
#include "core/trace_task.h"

namespace vecino {
namespace {

struct Uint4 {
    Uint x, y, z, w;
};

/// pcg4d (Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 2020).
inline Uint4 pcg4d(Uint4 v) {
    v = {v.x * 1664525u + 1013904223u, v.y * 1664525u + 1013904223u, v.z * 1664525u + 1013904223u,
         v.w * 1664525u + 1013904223u};
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    v = {v.x ^ (v.x >> 16), v.y ^ (v.y >> 16), v.z ^ (v.z >> 16), v.w ^ (v.w >> 16)};
    v.x += v.y * v.w;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v.w += v.y * v.z;
    return v;
}

inline Uint reverse_bits(Uint v) {
    v = ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
    v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
    v = ((v >> 4) & 0x0F0F0F0Fu) | ((v & 0x0F0F0F0Fu) << 4);
    v = ((v >> 8) & 0x00FF00FFu) | ((v & 0x00FF00FFu) << 8);
    return (v >> 16) | (v << 16);
}

/// Nested uniform (Owen) scrambling of a bit-reversed number: each bit is flipped by a hash of the
/// bits below it. Laine and Karras 2011 with the constants of Vegdahl (2021).
inline Uint owen_scramble_reversed(Uint v, Uint seed) {
    v ^= v * 0x3d20adeau;
    v += seed;
    v *= (seed >> 16) | 1u;
    v ^= v * 0x05526c56u;
    v ^= v * 0x53a22864u;
    return v;
}

/// The second Sobol dimension of an index, bit-reversed: its matrix is Pascal's triangle mod 2,
/// which factors into five steps (one per bit of the bit position).
inline Uint sobol1_reversed(Uint index) {
    index ^= (index >> 1) & 0x55555555u;
    index ^= (index >> 2) & 0x33333333u;
    index ^= (index >> 4) & 0x0F0F0F0Fu;
    index ^= (index >> 8) & 0x00FF00FFu;
    index ^= index >> 16;
    return index;
}

/// Uniform in [0, 1), 24 bits.
inline Float to_unit(Uint bits) {
    return __builtin_convertvector((Int)(bits >> 8), Float) * 0x1p-24f;
}

struct Pair {
    Float u, v;
};

/// The random numbers of W samples, of one pixel or of one each. A path's dimensions come in pairs:
/// 0 the position in the pixel, 1 + 2k the light sample and 2 + 2k the direction at vertex k.
class PathRandom {
  public:
    PathRandom(const TraceTask& task, std::uint32_t pixel, Uint sample)
        : PathRandom(task, splat(pixel), sample) {}

    PathRandom(const TraceTask& task, Uint pixel, Uint sample)
        : seed_(splat(task.seed)),
          pixel_(pixel),
          sample_(sample),
          streams_(task.streams),
          sobol_(task.sobol) {}

    Pair pair(std::uint32_t dimension) const {
        return sobol_ ? sobol_pair(dimension) : independent_pair(dimension);
    }

  private:
    Pair independent_pair(std::uint32_t dimension) const {
        const Uint4 hash = pcg4d({sample_, pixel_, splat(dimension), seed_});
        return {to_unit(hash.x), to_unit(hash.y)};
    }

    // Sample i is point i / streams of stream i % streams. Every (stream, dimension pair) has its
    // own scrambling and its own shuffle of the sequence (Burley, "Practical Hash-based Owen
    // Scrambling", JCGT 2020).
    Pair sobol_pair(std::uint32_t dimension) const {
        const Uint stream = streams_ == 1 ? Uint{} : sample_ % static_cast<std::uint32_t>(kStreams);
        const Uint point = streams_ == 1 ? sample_ : sample_ / static_cast<std::uint32_t>(kStreams);
        const Uint4 keys = pcg4d({stream, pixel_, splat(dimension + 0x80000000u), seed_});
        const Uint index = reverse_bits(owen_scramble_reversed(reverse_bits(point), keys.z));
        return {to_unit(reverse_bits(owen_scramble_reversed(index, keys.x))),
                to_unit(reverse_bits(owen_scramble_reversed(sobol1_reversed(index), keys.y)))};
    }

    Uint seed_, pixel_, sample_;
    std::uint32_t streams_;
    bool sobol_;
};

}  // namespace
}  // namespace vecino
