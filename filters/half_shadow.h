// SPDX-License-Identifier: Apache-2.0
//
// Half-shadow from few samples: what is in sight of a light changes little from pixel to pixel of a
// surface, so that those around tell more of it than a pixel's own samples.
#pragma once

#include "filters/pixel_needs.h"

namespace vecino {

/// What samples there are of needy pixels.
struct GivenSamples {
    RowRange rows;
    const NeedyRows& needy;  ///< of these
    int pilot_spp;           ///< what they have that get no others
};

/// Of needy pixels that get no further samples and lie on one surface alone: what is in sight of
/// the light becomes a mean over a window, where pixels differ by noise; at a hard edge they differ
/// in order, and keep their own. Reads first samples alone.
void smooth_half_shadow(const RecordTracer& tracer, const GivenSamples& given,
                        PixelClusters& clusters);

/// Of all needy pixels, once further samples are stored: what is in sight of the light becomes the
/// value of a polynomial of second order, fitted to the 7x7 pixels around (Savitzky and Golay
/// 1964, in two dimensions; a thirteenth of the variance is left), as far as what it leaves is
/// noise. Where neighbours differ from it alike, as along an edge, pixels keep their own.
void fit_half_shadow(const RecordTracer& tracer, const GivenSamples& given,
                     PixelClusters& clusters);

}  // namespace vecino
