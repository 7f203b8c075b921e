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

/// A rectangle in a frame around the shading point: the points (x, y, height) with x in x0..x1, y
/// in y0..y1.
struct RectangleView {
    Float3 x_axis, y_axis;  ///< unit, along the edges
    Float3 z_axis;          ///< unit, to the rectangle's plane: against its normal
    Float x0, x1, y0, y1;
    Float height;  ///< > 0 where its emitting side is in sight
    // One over the distance of the lines through its sides.
    Float per_x0, per_x1, per_y0, per_y1;
};

inline Float inverse_length(Float a, Float b) {
    return 1.0f / sqrt(a * a + b * b);
}

/// A rectangle by a corner, relative to the shading point, its edges and what is known of them.
struct RectangleShape {
    Float3 to_corner, edge1, edge2, normal;
    Float inverse_length1, inverse_length2;
};

inline RectangleView view_rectangle(const RectangleShape& shape) {
    RectangleView r;
    r.x_axis = shape.edge1 * shape.inverse_length1;
    r.y_axis = shape.edge2 * shape.inverse_length2;
    r.z_axis = -shape.normal;
    r.height = dot(shape.to_corner, r.z_axis);
    r.x0 = dot(shape.to_corner, r.x_axis);
    r.y0 = dot(shape.to_corner, r.y_axis);
    r.x1 = r.x0 + dot(shape.edge1, r.x_axis);
    r.y1 = r.y0 + dot(shape.edge2, r.y_axis);
    r.per_x0 = inverse_length(r.height, r.x0);
    r.per_x1 = inverse_length(r.height, r.x1);
    r.per_y0 = inverse_length(r.height, r.y0);
    r.per_y1 = inverse_length(r.height, r.y1);
    return r;
}

/// Points of a rectangle that are uniform over its solid angle.
struct SolidAngleSample {
    Float3 to_point;    ///< from the shading point
    Float solid_angle;  ///< steradians
};

/// arcsine(x y / (sqrt(x^2 + h^2) sqrt(y^2 + h^2))), which near 1 would lose half of its digits.
inline Float corner_angle(const RectangleView& r, Float x, Float y) {
    const Float product = x * y;
    const Float distance = sqrt(x * x + y * y + r.height * r.height);
    return copysign(angle_of(abs(product), abs(r.height) * distance), product);
}

/// Urena, Fajardo, King: An Area-Preserving Parametrization for Spherical Rectangles (EGSR 2013),
/// in a frame whose z is the other way.
inline SolidAngleSample sample_solid_angle(const RectangleView& r, Pair u) {
    const Float a2 = -corner_angle(r, r.x0, r.y1);
    const Float a3 = corner_angle(r, r.x0, r.y0);
    SolidAngleSample sample;
    sample.solid_angle = corner_angle(r, r.x1, r.y1) - corner_angle(r, r.x1, r.y0) + a2 + a3;
    const Float b0 = -r.y0 * r.per_y0;
    const Float b1 = r.y1 * r.per_y1;
    const Float angle = u.u * sample.solid_angle + (kPi - a2 - a3);
    Float sine, cosine;
    sincos_turns(max(angle, splat(0.0f)) * (0.5f / kPi), sine, cosine);
    sine = select(abs(sine) > 1e-12f, sine, splat(1e-12f));
    const Float fu = (cosine * b0 - b1) / sine;
    const Float cu = copysign(1.0f, fu) * inverse_length(fu, b0);
    const Float sin_u = sqrt(max(1.0f - cu * cu, splat(1e-12f)));
    const Float x = min(max(cu * r.height / sin_u, r.x0), r.x1);
    const Float d2 = x * x + r.height * r.height;
    const Float h0 = r.y0 / sqrt(d2 + r.y0 * r.y0);
    const Float h1 = r.y1 / sqrt(d2 + r.y1 * r.y1);
    const Float h = h0 + u.v * (h1 - h0);
    const Float y = min(max(h * sqrt(d2 / max(1.0f - h * h, splat(1e-12f))), r.y0), r.y1);
    sample.to_point = r.x_axis * x + r.y_axis * y + r.z_axis * r.height;
    return sample;
}

/// Irradiance over pi of a rectangle of radiance 1 that nothing hides, where it is exact: all of it
/// above the horizon.
struct Irradiance {
    Float value;
    Mask exact;
};

/// Lambert's formula: half the sum, over the sides, of the angle that a side fills times the cosine
/// between the surface's normal and that of the plane through the side.
inline Irradiance rectangle_irradiance(const RectangleView& r, Float3 normal) {
    const Float nx = dot(normal, r.x_axis);
    const Float ny = dot(normal, r.y_axis);
    const Float nz = dot(normal, r.z_axis);
    const Float h = nz * r.height;
    const Float lowest = h + min(nx * r.x0, nx * r.x1) + min(ny * r.y0, ny * r.y1);
    const auto side = [](Float from, Float to, Float per) {
        const Float a = from * per;
        const Float b = to * per;
        return angle_of(b - a, 1.0f + a * b) * per;
    };
    const Float flat = ny * r.height;
    const Float deep = nx * r.height;
    const Float sum = side(r.x0, r.x1, r.per_y0) * (flat - nz * r.y0) +
                      side(r.x0, r.x1, r.per_y1) * (nz * r.y1 - flat) +
                      side(r.y0, r.y1, r.per_x0) * (deep - nz * r.x0) +
                      side(r.y0, r.y1, r.per_x1) * (nz * r.x1 - deep);
    return {max(sum, splat(0.0f)) * (0.5f / kPi), lowest > 0.0f};
}

}  // namespace
}  // namespace vecino
