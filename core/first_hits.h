// SPDX-License-Identifier: Apache-2.0

/// @file
/// First hits alone: what lies behind the centres of pixels, one ray each, no light. The guide of
/// the schemes that take one.
#pragma once

#include "core/render.h"

namespace vecino {

/// Planes of the first hits through the pixel centres of settings.size, whatever its reduction and
/// first_hit say; its planes name which of albedo, position, normal, distance, id and emission are
/// made, others are left out, radiance too. Emission is that of the hit, or the background's at a
/// miss. Throws as render() does.
Render trace_first_hits(const Scene& scene, const RenderSettings& settings);

}  // namespace vecino
