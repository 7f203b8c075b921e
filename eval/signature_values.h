// SPDX-License-Identifier: Apache-2.0
//
// What the rows of the table of signatures compute; their formulas stand in the table.
#pragma once

#include "eval/signatures.h"

namespace vecino {

// Errors within some pixels.
SignatureValues rms_error(const SignatureInput& input);
SignatureValues mean_error(const SignatureInput& input);
SignatureValues lost_contrast(const SignatureInput& input);
SignatureValues deviation(const SignatureInput& input);
SignatureValues differs_from_path(const SignatureInput& input);

// One surface's colour on another.
SignatureValues far_share(const SignatureInput& input);
SignatureValues swap_width(const SignatureInput& input);
SignatureValues halo_width(const SignatureInput& input);
SignatureValues leaked_energy(const SignatureInput& input);

// Shapes.
SignatureValues edge_widening(const SignatureInput& input);
SignatureValues centroid_shift(const SignatureInput& input);
SignatureValues seam_step(const SignatureInput& input);
SignatureValues facet_step(const SignatureInput& input);
SignatureValues outlier_area(const SignatureInput& input);

// Seeds and counts.
SignatureValues seed_flips(const SignatureInput& input);
SignatureValues seed_noise(const SignatureInput& input);
SignatureValues damaged_blocks(const SignatureInput& input);
SignatureValues fallbacks(const SignatureInput& input);

}  // namespace vecino
