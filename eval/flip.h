// SPDX-License-Identifier: Apache-2.0
//
// FLIP: how visible the difference of two images is to somebody who flips between them, per pixel
// from 0 (not at all) to 1. LDR-FLIP: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astrom,
// Fairchild, "FLIP: A Difference Evaluator for Alternating Images", HPG 2020. HDR-FLIP: Andersson,
// Nilsson, Shirley, Akenine-Moeller, "Visualizing Errors in Rendered High Dynamic Range Images",
// Eurographics 2021. Constants and separated filters follow the authors' code, FLIP 1.7
// (github.com/NVlabs/flip, BSD 3-clause), which tests pin this to.
#pragma once

#include "core/grid.h"

namespace vecino {

/// A screen 0.7 m wide with 3840 pixels, seen from 0.7 m: 67.02 pixels per degree.
constexpr double kFlipPixelsPerDegree = 0.7 * (3840 / 0.7) * 3.14159265358979323846 / 180;

/// HDR-FLIP looks at exposures from the first to the last, evenly spaced, in stops. They are fixed,
/// not chosen by the reference, so that values of different images compare.
struct FlipExposures {
    double first_stop = -4;
    double last_stop = 4;
    int count = 8;  ///< at least 2
};

/// LDR-FLIP of linear RGB, clipped to [0,1]. Precondition: equal sizes, all values finite.
Grid<float> flip_map(const Image& test, const Image& reference);

/// HDR-FLIP of linear RGB: the largest LDR-FLIP that a pixel has at any of the exposures, after
/// the ACES tone curve. Values below 0 count as 0. Precondition as above.
Grid<float> hdr_flip_map(const Image& test, const Image& reference,
                         const FlipExposures& exposures = {});

}  // namespace vecino
