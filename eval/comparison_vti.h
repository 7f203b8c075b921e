// SPDX-License-Identifier: Apache-2.0
//
// All that is known of a pair of images, in one .vti file for ParaView.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/frame.h"
#include "eval/regions.h"

namespace vecino {

/// Images of the same size.
struct ComparedFrames {
    const Frame& test;
    const Frame& reference;
    const RegionMap* regions = nullptr;  ///< none where it is null
    nlohmann::json metrics;              ///< numbers by name, as comparison_json() has them
};

/// Writes the point arrays
///   test, reference, error       3 components: linear radiance, and test - reference
///   every map of all_pixel_maps()
///   region                       0 emitter, 1 edge, 2 interior
///   test_PLANE, reference_PLANE  the planes that the frames hold beside radiance
/// and the metrics as field arrays. Throws as save_vti() does, and Error(mismatch) when sizes
/// differ.
void save_comparison_vti(const ComparedFrames& compared, const std::string& path);

}  // namespace vecino
