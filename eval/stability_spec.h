// SPDX-License-Identifier: Apache-2.0
//
// What a matrix asks for under "stability": how its methods are disturbed, beside the change of
// seed that every matrix may have.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "core/json_read.h"

namespace vecino {

struct StabilitySpec {
    /// Of the camera, in pixels of the full resolution, right and down alike; each above 0.
    std::vector<float> shifts{0.25f, 0.5f};
    bool elasticity = true;  ///< whether numeric parameters are varied
};

/// Throws Error(usage).
StabilitySpec read_stability(const JsonValue& json);

nlohmann::json stability_schema();

}  // namespace vecino
