// SPDX-License-Identifier: Apache-2.0
//
// Packets of a real render, kept and sent through Embree again without any shading: how fast Embree
// alone traces rays of each kind.
#pragma once

#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "core/packet_log.h"

namespace vecino {

/// Which part of a path a ray is. Rays that leave the camera are primary; those that ask whether
/// anything lies before a point are shadow rays; all others are bounces.
enum class RayKind : std::int32_t { primary, shadow, bounce };

/// A packet before it was traced.
template <int W>
struct LoggedPacket {
    RayPacket<W> rays;
    alignas(64) std::int32_t active[W];
    RayQuery query;
    RayKind kind;
};

class PacketLog {
  public:
    /// For rays of a camera that stands there.
    explicit PacketLog(const float (&camera_origin)[3]);

    template <int W>
    void add(RayQuery query, const std::int32_t (&active)[W], const RayPacket<W>& rays);

    /// The packets of one kind, in the order in which they came.
    [[nodiscard]] PacketLog only(RayKind kind) const;

    [[nodiscard]] std::size_t packets() const;
    [[nodiscard]] std::uint64_t rays() const;  ///< of active lanes

    /// Traces every packet once, in order. Returns how many rays hit something, which a caller can
    /// hold against an earlier pass.
    std::uint64_t replay(const EmbreeScene& embree) const;

  private:
    template <int W>
    using List = std::vector<LoggedPacket<W>>;

    template <int W>
    [[nodiscard]] RayKind kind_of(const LoggedPacket<W>& packet) const;

    float camera_origin_[3];
    std::variant<std::monostate, List<1>, List<4>, List<8>, List<16>> packets_;
};

}  // namespace vecino
