// SPDX-License-Identifier: Apache-2.0
//
// What the window kernel reads and writes: rows of a low-res frame as plain arrays. The kernel is
// compiled once per instruction set, so this header holds plain data only: an inline function
// shared between those translation units could be linked in its widest form and crash on a smaller
// machine.
#pragma once

#include <cstdint>

namespace vecino {

enum class WindowDistance { euclidean, manhattan, world, gated_world };
enum class WindowWeight { equal, proportional, inverse, gaussian };

/// Planes of doubles. Those of masks hold bit patterns: all ones for yes, all zeros for no.
enum WindowPlane : std::int32_t {
    kColorPlanes = 0,  ///< red, green, blue; 0 where not finite
    kPresentPlane =
        3,  ///< a neighbour: inside the image, and no miss if the distance is in the world
    kFinitePlane = 4,     ///< of finite colour; may enter an average
    kPositionPlanes = 5,  ///< x, y, z
    kNormalPlanes = 8,    ///< x, y, z
};

constexpr std::int32_t kMostLanes = 8;  ///< pixels that a kernel takes at once

/// One row of pixels and what its windows reach. Left of each plane row there are `reach` values
/// that are not present, right of it reach + kMostLanes, so that no load needs a test.
struct WindowRow {
    const double* pixels;      ///< the first pixel of the row, in plane 0
    std::int64_t row_pitch;    ///< from a pixel to the one below, in values
    std::int64_t plane_pitch;  ///< from a plane to the next, in values
    std::int32_t width;
    std::int32_t reach;  ///< columns of the window left of its centre, and right of it
    std::int32_t above;  ///< rows of the window above its centre, clipped to the image
    std::int32_t below;

    WindowDistance distance;
    WindowWeight weight;
    bool use_centre;
    double du, dv;             ///< uv distance of neighbours in x, in y
    double min_normal_cosine;  ///< gated_world only

    // Results, width + kMostLanes values each.
    double* weight_sum;
    double* color_sum[3];  ///< of weighted colours
    double* weights;       ///< scratch: kMostLanes values per offset of the window
};

using SumWindows = void (*)(const WindowRow&);
void sum_windows_baseline(const WindowRow& row);
void sum_windows_avx2(const WindowRow& row);    // on x86-64 only
void sum_windows_avx512(const WindowRow& row);  // likewise

}  // namespace vecino
