// SPDX-License-Identifier: Apache-2.0
//
// Which pixels are unlike their neighbours: for whole rows at a time.
#pragma once

#include <cstdint>
#include <vector>

#include "filters/pixel_clusters.h"

namespace vecino {

/// Why a pixel wants more samples; a set of bits.
enum Need : std::uint8_t {
    kNeedsCoverage = 1,  ///< several surfaces, albedos or much different light may share it
    kNeedsShadow = 2,    ///< what is in sight of the light differs within it or around it
    kWideShadow = 4,     ///< and all around it, as far as fit_half_shadow() looks
};

/// What the pixels of a row are compared by.
struct LookRow {
    std::vector<std::int32_t> object;
    /// By emitter: bit 0.. that some sample sees it; bit 8.. that nothing but other surfaces could
    /// hide it.
    std::vector<std::int32_t> lights;
    std::vector<std::int32_t> own;  ///< needs that a pixel has whatever is around it
    /// Unshadowed light over pi, about as bright as it shows on white, from 0 to 1; over the root
    /// of samples, as the noise is that comes of its change within the pixel.
    std::vector<float> light;
    std::vector<float> albedo[3], normal[3];
};

/// The looks of row y; empty if the clusters have no such row.
void look_at_row(const TraceTask& task, const PixelClusters& clusters, int y, LookRow& row);

/// Adds to the needs of pixels of two rows, one below the other, those that come of differences
/// between neighbours across them; with the same row twice, between neighbours in it.
void compare_rows(const LookRow& above, const LookRow& below, std::vector<std::int32_t>& of_above,
                  std::vector<std::int32_t>& of_below);
void compare_in_row(const LookRow& row, std::vector<std::int32_t>& needs);

}  // namespace vecino
