// SPDX-License-Identifier: Apache-2.0
//
// What a part says of the render that it belongs to, and whether parts belong to one.
#pragma once

#include <span>
#include <string>

#include "core/part_file.h"

namespace vecino {

/// Adds what only parts have: "scene_hash", "simd_width", "rays", "dropped_samples".
void describe_part(const std::string& scene_hash, const RenderStatistics& statistics,
                   Metadata& metadata);

/// Throws Error(mismatch), naming the files, unless all are parts of one render whose samples touch
/// without overlap. Precondition: sorted by samples.
void require_one_render(std::span<const PartHeader> parts);

/// Attributes of the image that all parts make, as if it had been rendered in one go; the seconds
/// add up.
Metadata image_metadata(std::span<const PartHeader> parts);

/// The same for a larger part.
Metadata part_metadata(std::span<const PartHeader> parts);

/// Counts of all parts together. Throws Error(file) if those of a part are damaged.
RenderStatistics total_statistics(std::span<const PartHeader> parts);

}  // namespace vecino
