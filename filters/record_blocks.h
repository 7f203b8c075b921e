// SPDX-License-Identifier: Apache-2.0
//
// Light between records for many pixels at a time: what record_light() does for one.
#pragma once

#include "filters/records.h"

namespace vecino {

/// Points of kPilotPixels pixels (x .. , y) side by side.
struct PointBlock {
    int x, y;
    int count;  ///< pixels, at most kPilotPixels
    alignas(64) float position_world[3][kPilotPixels];
    float normal_world[3][kPilotPixels];
    std::int32_t object[kPilotPixels];
    bool wanted[kPilotPixels];  ///< whether light is asked for
};

/// Light over pi at the points. found: where a record was near.
struct LightBlock {
    alignas(64) float light[kRecordChannels][kPilotPixels];
    bool found[kPilotPixels];
};

void record_light(const RecordMap& map, const PointBlock& points, LightBlock& out);

/// The finest level that has a cell for a pixel.
std::size_t finest_level(const RecordMap& map, int x, int y);

}  // namespace vecino
