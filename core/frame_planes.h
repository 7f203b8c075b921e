// SPDX-License-Identifier: Apache-2.0
//
// Filling a frame, pixel by pixel: the planes that it has get their values, others are left out.
#pragma once

#include "core/accumulate.h"
#include "core/frame.h"
#include "core/planes.h"
#include "core/trace_task.h"

namespace vecino {

constexpr Planes kFirstHitPlanes{Plane::albedo, Plane::position, Plane::normal, Plane::distance,
                                 Plane::id};

/// Of all samples, where other planes of the first hit are of one.
constexpr Planes kMeanPlanes{Plane::albedo_mean, Plane::normal_mean};

/// The planes that are in both sets.
Planes common(Planes a, Planes b);

/// Allocates planes. Throws Error(file) if the machine lacks the memory.
Frame make_frame(Extent size, Planes planes);

struct Pixel {
    int x, y;
};

/// Of a pixel's number, counted row by row.
inline Pixel pixel_at(std::size_t index, Extent size) {
    const auto width = static_cast<std::size_t>(size.width);
    return {static_cast<int>(index % width), static_cast<int>(index / width)};
}

void store_values(const PixelValues& values, Pixel at, Frame& frame);
void store_means(const GuideSums& sums, int samples, Pixel at, Frame& frame);
void store_first_hit(const FirstHitRecord& hit, Pixel at, Frame& frame);

/// Eq. 1 of the thesis. Constant over a pixel's samples: its box-filtered value is the one at the
/// centre.
void fill_pattern(Frame& frame, Extent size);

}  // namespace vecino
