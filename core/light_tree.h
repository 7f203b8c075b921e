// SPDX-License-Identifier: Apache-2.0
//
// A tree over the emitters of a scene, by which a shading point finds those that matter to it: a
// bounding volume hierarchy with a cone of normals per node (Conty Estevez and Kulla, "Importance
// Sampling of Many Lights with Adaptive Tree Splitting", 2018).
#pragma once

#include <cstdint>
#include <vector>

#include "core/trace_task.h"

namespace vecino {

/// What LightTree points to: a row per LightNodeField.
struct LightTreeTable {
    std::vector<float> fields;
    std::uint32_t stride = 0;
    std::uint32_t count = 0;
};

/// Empty without emitters. Sets their trails.
LightTreeTable build_light_tree(std::vector<LightRecord>& lights);

}  // namespace vecino
