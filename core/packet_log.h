// SPDX-License-Identifier: Apache-2.0
//
// What a kernel tells a benchmark: the packets that it sends through Embree. The kernels see
// declarations alone, for the reason given in trace_task.h.
#pragma once

#include <cstdint>

#include "core/embree_scene.h"

namespace vecino {

class PacketLog;

/// What rays ask Embree for.
enum class RayQuery : std::int32_t { nearest_hit, any_hit };

/// Appends a packet that is about to be traced. Defined for W = 1, 4, 8, 16; a log holds packets of
/// one width.
template <int W>
void log_packet(PacketLog& log, RayQuery query, const std::int32_t (&active)[W],
                const RayPacket<W>& rays);

}  // namespace vecino
