// SPDX-License-Identifier: Apache-2.0
//
// VECINO_WIDTH numbers side by side, through the compiler's vector types: portable, no intrinsics.
// Included only by trace_kernel.cpp, which is compiled once per width; everything is in an
// anonymous namespace so that no two translation units share code that was compiled for different
// machines.
#pragma once

#include <cstdint>

namespace vecino {
namespace {

constexpr int W = VECINO_WIDTH;
constexpr float kPi = 3.14159265358979f;

using Float = float __attribute__((vector_size(4 * W)));
using Int = std::int32_t __attribute__((vector_size(4 * W)));
using Uint = std::uint32_t __attribute__((vector_size(4 * W)));
using Mask = Int;  ///< -1 or 0 per lane

struct Float3 {
    Float x, y, z;
};

inline Float splat(float value) {
    return Float{} + value;
}
inline Uint splat(std::uint32_t value) {
    return Uint{} + value;
}
inline Float3 splat3(const float (&v)[3]) {
    return {splat(v[0]), splat(v[1]), splat(v[2])};
}

template <class V>
inline V load(const void* from) {
    V v;
    __builtin_memcpy(&v, from, sizeof v);
    return v;
}
template <class V>
inline void store(void* to, V v) {
    __builtin_memcpy(to, &v, sizeof v);
}

inline Float gather(const float* table, Int index) {
    alignas(4 * W) float lanes[W];
#pragma omp simd
    for (int i = 0; i < W; ++i) lanes[i] = table[index[i]];
    return load<Float>(lanes);
}

/// table[index] per lane. Of a table of `count` entries, padded to 32 or more; small ones are
/// looked up in registers, which is many times faster than from memory.
inline Float lookup(const float* table, std::uint32_t count, Int index) {
#if !defined(__clang__)  // which has no shuffle by a variable
    if constexpr (W >= 8) {
        if (count <= W) return __builtin_shuffle(load<Float>(table), index);
        if (count <= 2 * W)
            return __builtin_shuffle(load<Float>(table), load<Float>(table + W), index);
    }
#endif
    return gather(table, index);
}

inline Float select(Mask mask, Float a, Float b) {
    return mask ? a : b;
}
inline Int select(Mask mask, Int a, Int b) {
    return mask ? a : b;
}
inline Float3 select(Mask m, Float3 a, Float3 b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

inline bool any(Mask mask) {
    std::int32_t bits = 0;
    for (int i = 0; i < W; ++i) bits |= mask[i];
    return bits != 0;
}
inline int count(Mask mask) {
    int n = 0;
    for (int i = 0; i < W; ++i) n -= mask[i];
    return n;
}

inline Float sqrt(Float v) {
    alignas(4 * W) float lanes[W];
    store(lanes, v);
#pragma omp simd
    for (int i = 0; i < W; ++i) lanes[i] = __builtin_sqrtf(lanes[i]);
    return load<Float>(lanes);
}
inline Float max(Float a, Float b) {
    return a > b ? a : b;
}
inline Int max(Int a, Int b) {
    return a > b ? a : b;
}
inline Float min(Float a, Float b) {
    return a < b ? a : b;
}
inline Float abs(Float v) {
    return (Float)((Int)v & 0x7FFFFFFF);
}
/// Of a magnitude that is not negative.
inline Float copysign(Float magnitude, Float sign) {
    return (Float)(((Int)sign & (Int)splat(0x80000000u)) | (Int)magnitude);
}
inline Float copysign(float magnitude, Float sign) {
    return copysign(splat(magnitude), sign);
}

inline Float3 operator+(Float3 a, Float3 b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Float3 operator-(Float3 a, Float3 b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Float3 operator-(Float3 a) {
    return {-a.x, -a.y, -a.z};
}
inline Float3 operator*(Float3 a, Float3 b) {
    return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline Float3 operator*(Float3 a, Float b) {
    return {a.x * b, a.y * b, a.z * b};
}
inline Float dot(Float3 a, Float3 b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
inline Float3 cross(Float3 a, Float3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Float3 normalise(Float3 v) {
    return v * (1.0f / sqrt(dot(v, v)));
}

/// The angle of (x, y) for y >= 0, in [0, pi]; error below 3e-7. Chebyshev interpolation of atan(t)
/// / t in t^2.
inline Float angle_of(Float y, Float x) {
    const Float run = abs(x);
    const Mask steep = y > run;
    const Float t = select(steep, run, y) / max(select(steep, y, run), splat(1e-30f));
    const Float z = t * t;
    constexpr float kTerms[] = {9.9999988200e-01f,  -3.3331812656e-01f, 1.9966961830e-01f,
                                -1.4003290185e-01f, 9.8688654579e-02f,  -5.8829753141e-02f,
                                2.3780518597e-02f,  -4.5597919861e-03f};
    Float sum = splat(kTerms[7]);
    for (int i = 6; i >= 0; --i) sum = sum * z + kTerms[i];
    const Float flat = sum * t;
    const Float angle = select(steep, 0.5f * kPi - flat, flat);
    return select(x < 0.0f, kPi - angle, angle);
}

/// sin and cos of 2 pi u for u in [0, 1): minimax polynomials on [-pi/4, pi/4], error below 1e-7.
/// Our own, so that a render does not depend on the math library.
inline void sincos_turns(Float u, Float& sine, Float& cosine) {
    // u = quarter / 4 + r with r in [-1/8, 1/8]
    const Int quarter = __builtin_convertvector(u * 4.0f + 0.5f, Int);
    const Float r = (u - __builtin_convertvector(quarter, Float) * 0.25f) * 6.283185307f;
    const Float r2 = r * r;
    const Float s =
        r + r * r2 * (-1.6666654611e-1f + r2 * (8.3321608736e-3f + r2 * -1.9515295891e-4f));
    const Float c =
        1.0f - 0.5f * r2 +
        r2 * r2 *
            (4.166664568298827e-2f + r2 * (-1.388731625493765e-3f + r2 * 2.443315711809948e-5f));
    const Mask swap = (quarter & 1) != 0;
    const Float sine_magnitude = select(swap, c, s);
    const Float cosine_magnitude = select(swap, s, c);
    sine = select((quarter & 2) != 0, -sine_magnitude, sine_magnitude);
    cosine = select(((quarter + 1) & 2) != 0, -cosine_magnitude, cosine_magnitude);
}

}  // namespace
}  // namespace vecino
