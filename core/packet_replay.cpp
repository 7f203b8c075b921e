// SPDX-License-Identifier: Apache-2.0
#include "core/packet_replay.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <type_traits>

namespace vecino {
namespace {

template <int W>
std::uint64_t active_lanes(const LoggedPacket<W>& packet) {
    return static_cast<std::uint64_t>(W - std::ranges::count(packet.active, 0));
}

/// Returns how many rays hit something.
template <int W>
std::uint64_t trace(const EmbreeScene& embree, const LoggedPacket<W>& packet) {
    std::uint64_t hits = 0;
    if (packet.query == RayQuery::nearest_hit) {
        HitPacket<W> hit;
        hit.ray = packet.rays;
        std::ranges::fill(hit.geometry, kNoGeometry);
        std::ranges::fill(hit.instance[0], kNoGeometry);
        embree.intersect(packet.active, hit, Rays::scattered);
        for (int i = 0; i < W; ++i) {
            const bool is_hit = packet.active[i] != 0 && hit.geometry[i] != kNoGeometry;
            hits += is_hit ? 1u : 0u;
        }
    } else {
        RayPacket<W> rays = packet.rays;
        embree.occluded(packet.active, rays);
        for (int i = 0; i < W; ++i) hits += packet.active[i] != 0 && rays.t_far[i] < 0.0f ? 1u : 0u;
    }
    return hits;
}

/// Calls visit with the list of packets, which is there.
template <class Packets, class Visit>
void visit_list(Packets& packets, Visit visit) {
    std::visit(
        [&](auto& list) {
            if constexpr (!std::is_same_v<std::decay_t<decltype(list)>, std::monostate>)
                visit(list);
        },
        packets);
}

}  // namespace

PacketLog::PacketLog(const float (&camera_origin)[3]) {
    std::ranges::copy(camera_origin, camera_origin_);
}

template <int W>
RayKind PacketLog::kind_of(const LoggedPacket<W>& packet) const {
    const auto lane = std::distance(std::begin(packet.active),
                                    std::ranges::find_if(packet.active, [](int a) { return a; }));
    const bool any_hit = packet.query == RayQuery::any_hit;
    if (lane == W) return any_hit ? RayKind::shadow : RayKind::bounce;
    // A ray that only asks for the background goes on forever.
    if (any_hit && std::isfinite(packet.rays.t_far[lane])) return RayKind::shadow;
    const bool from_camera = packet.rays.origin[0][lane] == camera_origin_[0] &&
                             packet.rays.origin[1][lane] == camera_origin_[1] &&
                             packet.rays.origin[2][lane] == camera_origin_[2];
    return from_camera ? RayKind::primary : RayKind::bounce;
}

template <int W>
void PacketLog::add(RayQuery query, const std::int32_t (&active)[W], const RayPacket<W>& rays) {
    if (std::holds_alternative<std::monostate>(packets_)) packets_.emplace<List<W>>();
    LoggedPacket<W> packet{rays, {}, query, {}};
    std::ranges::copy(active, packet.active);
    packet.kind = kind_of(packet);
    std::get<List<W>>(packets_).push_back(packet);
}

PacketLog PacketLog::only(RayKind kind) const {
    PacketLog log(camera_origin_);
    visit_list(packets_, [&]<int W>(const List<W>& list) {
        std::ranges::copy_if(list, std::back_inserter(log.packets_.emplace<List<W>>()),
                             [kind](const LoggedPacket<W>& packet) { return packet.kind == kind; });
    });
    return log;
}

std::size_t PacketLog::packets() const {
    std::size_t count = 0;
    visit_list(packets_, [&](const auto& list) { count = list.size(); });
    return count;
}

std::uint64_t PacketLog::rays() const {
    std::uint64_t count = 0;
    visit_list(packets_, [&](const auto& list) {
        for (const auto& packet : list) count += active_lanes(packet);
    });
    return count;
}

std::uint64_t PacketLog::replay(const EmbreeScene& embree) const {
    std::uint64_t hits = 0;
    visit_list(packets_, [&](const auto& list) {
        for (const auto& packet : list) hits += trace(embree, packet);
    });
    return hits;
}

template <int W>
void log_packet(PacketLog& log, RayQuery query, const std::int32_t (&active)[W],
                const RayPacket<W>& rays) {
    log.add(query, active, rays);
}

#define VECINO_INSTANTIATE(W)                                                   \
    template void log_packet<W>(PacketLog&, RayQuery, const std::int32_t(&)[W], \
                                const RayPacket<W>&);
VECINO_INSTANTIATE(1)
VECINO_INSTANTIATE(4)
VECINO_INSTANTIATE(8)
VECINO_INSTANTIATE(16)

}  // namespace vecino
