// SPDX-License-Identifier: Apache-2.0
//
// Rectangular emitters as seen from VECINO_WIDTH shading points side by side: points uniform over
// the solid angle, and the exact irradiance of an emitter that nothing hides. Included only by
// trace_kernel.cpp, like lanes.h.
#pragma once

#include "core/lanes.h"
#include "core/random_lanes.h"

namespace vecino {
namespace {

constexpr float kPi = 3.14159265358979f;

/// arcsine for |x| <= 1 (Cephes), error below 2e-7. Our own, as sincos_turns is.
inline Float arcsine(Float x) {
    const Float magnitude = min(abs(x), splat(1.0f));
    const Mask steep = magnitude > 0.5f;
    const Float z = select(steep, 0.5f * (1.0f - magnitude), magnitude * magnitude);
    const Float root = select(steep, sqrt(z), magnitude);
    const Float tail = ((((4.2163199048e-2f * z + 2.4181311049e-2f) * z + 4.5470025998e-2f) * z +
                         7.4953002686e-2f) *
                            z +
                        1.6666752422e-1f) *
                       z;
    const Float small = root + root * tail;
    return copysign(select(steep, 0.5f * kPi - 2.0f * small, small), x);
}

/// A rectangle in a frame whose origin is the shading point: x0..x1 by y0..y1 at height z (below
/// 0), and what is needed to sample it (Urena, Fajardo, King 2013).
struct SphericalRectangle {
    Float3 x_axis, y_axis, z_axis;
    Float x0, x1, y0, y1, z;
    Float b0, b1, k;
    Float solid_angle;
};

inline Float inverse_length(Float a, Float b) {
    return 1.0f / sqrt(a * a + b * b);
}

/// From a shading point to the corner `to_corner`; edges are perpendicular.
inline SphericalRectangle spherical_rectangle(Float3 to_corner, Float3 edge1, Float3 edge2) {
    SphericalRectangle r;
    const Float length1 = sqrt(dot(edge1, edge1));
    const Float length2 = sqrt(dot(edge2, edge2));
    r.x_axis = edge1 * (1.0f / length1);
    r.y_axis = edge2 * (1.0f / length2);
    const Float3 normal = cross(r.x_axis, r.y_axis);
    const Float height = dot(to_corner, normal);
    const Float3 zero{};
    r.z_axis = select(height > 0.0f, zero - normal, normal);
    r.z = -abs(height);
    r.x0 = dot(to_corner, r.x_axis);
    r.y0 = dot(to_corner, r.y_axis);
    r.x1 = r.x0 + length1;
    r.y1 = r.y0 + length2;
    // Normals of the planes through the shading point and each side, of which two parts matter.
    const Float side_y0 = inverse_length(r.z, r.y0);
    const Float side_x1 = inverse_length(r.z, r.x1);
    const Float side_y1 = inverse_length(r.z, r.y1);
    const Float side_x0 = inverse_length(r.z, r.x0);
    const Float a2 = arcsine(-r.x0 * r.y1 * side_x0 * side_y1);
    const Float a3 = arcsine(r.x0 * r.y0 * side_x0 * side_y0);
    r.solid_angle = arcsine(-r.x1 * r.y0 * side_x1 * side_y0) +
                    arcsine(r.x1 * r.y1 * side_x1 * side_y1) + a2 + a3;
    r.b0 = -r.y0 * side_y0;
    r.b1 = r.y1 * side_y1;
    r.k = kPi - a2 - a3;
    return r;
}

/// A point of the rectangle, relative to the shading point.
inline Float3 sample_rectangle(const SphericalRectangle& r, Pair u) {
    Float sine, cosine;
    const Float angle = u.u * r.solid_angle + r.k;
    sincos_turns(max(angle, splat(0.0f)) * (0.5f / kPi), sine, cosine);
    sine = select(abs(sine) > 1e-12f, sine, splat(1e-12f));
    const Float fu = (cosine * r.b0 - r.b1) / sine;
    const Float cu = copysign(1.0f, fu) * inverse_length(fu, r.b0);
    const Float sin_u = sqrt(max(1.0f - cu * cu, splat(1e-12f)));
    const Float x = min(max(-(cu * r.z) / sin_u, r.x0), r.x1);
    const Float d2 = x * x + r.z * r.z;
    const Float h0 = r.y0 / sqrt(d2 + r.y0 * r.y0);
    const Float h1 = r.y1 / sqrt(d2 + r.y1 * r.y1);
    const Float h = h0 + u.v * (h1 - h0);
    const Float y = h * sqrt(d2 / max(1.0f - h * h, splat(1e-12f)));
    return r.x_axis * x + r.y_axis * min(max(y, r.y0), r.y1) + r.z_axis * r.z;
}

/// acos(c) / sqrt(1 - c^2) for c in [0, 1], error 2e-7: interpolated at Chebyshev's points.
inline Float angle_over_sine(Float c) {
    constexpr float kTerms[] = {1.5707963235e+00f,  -9.9999920579e-01f, 7.8536576713e-01f,
                                -6.6614234455e-01f, 5.8460294511e-01f,  -5.1069299354e-01f,
                                4.1580703975e-01f,  -2.8580595955e-01f, 1.4669184033e-01f,
                                -4.7913828375e-02f, 7.2904176269e-03f};
    Float sum = splat(kTerms[10]);
    for (int i = 9; i >= 0; --i) sum = sum * c + kTerms[i];
    return sum;
}

/// Irradiance over pi of a rectangle of radiance 1 that nothing hides (Lambert's formula), where it
/// is exact: all corners above the horizon of n, and less than a right angle apart.
struct Irradiance {
    Float value;
    Mask exact;
};

inline Irradiance rectangle_irradiance(const SphericalRectangle& r, Float3 n) {
    const auto corner = [&](Float x, Float y) {
        return normalise(r.x_axis * x + r.y_axis * y + r.z_axis * r.z);
    };
    const Float3 corners[] = {corner(r.x0, r.y0), corner(r.x1, r.y0), corner(r.x1, r.y1),
                              corner(r.x0, r.y1)};
    Irradiance e{Float{}, Mask{} - 1};
    for (int i = 0; i < 4; ++i) {
        const Float3 a = corners[i];
        const Float3 b = corners[(i + 1) % 4];
        const Float c = dot(a, b);
        e.exact &= (c > 0.0f) & (dot(n, a) > 0.0f);
        e.value += angle_over_sine(min(max(c, splat(0.0f)), splat(1.0f))) * dot(n, cross(a, b));
    }
    e.value = abs(e.value) * (0.5f / kPi);
    return e;
}

}  // namespace
}  // namespace vecino
