// SPDX-License-Identifier: Apache-2.0
//
// The blocky ceiling: the best that any scheme can do whose image is constant per low-res pixel.
#pragma once

#include "core/grid.h"
#include "eval/regions.h"

namespace vecino {

/// Every pixel takes the mean over all pixels that correspond to the same low-res pixel (and, with
/// regions, lie in the same region). The mean is one of display values (clipped to [0,1],
/// sRGB-encoded), the space of psnr_float_db, and then decoded: there it is the least-squares
/// optimum, so no image that is constant per low-res pixel has a higher psnr_float_db - of the
/// whole image without regions, of each region with them. (A box filter in linear light can be
/// beaten.) Linear RGB in [0,1], of the reference's size; with low of that size too, the clipped
/// reference up to rounding.
///
/// Throws Error(mismatch) if low is empty or larger than the reference on an axis, or if the
/// regions are not of the reference's size; Error(non_finite) if the reference has a value that is
/// not finite.
Image blocky_ceiling(const Image& reference, Extent low, const RegionMap* regions = nullptr);

}  // namespace vecino
