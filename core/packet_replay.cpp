// SPDX-License-Identifier: Apache-2.0
#include "core/packet_replay.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <type_traits>

namespace vecino {
namespace {

template <int W>
std::uint64_t active_lanes(const RayPacket<W>& rays) {
    return static_cast<std::uint64_t>(W - std::ranges::count(rays.active, 0));
}

/// Returns how many rays hit something.
template <int W>
std::uint64_t trace(const EmbreeScene& embree, const LoggedPacket<W>& packet) {
    std::uint64_t hits = 0;
    if (packet.query == RayQuery::nearest_hit) {
        HitPacket<W> hit;
        embree.intersect(packet.rays, hit);
        for (int i = 0; i < W; ++i) hits += hit.primitive[i] != kNoPrimitive ? 1u : 0u;
    } else {
        std::int32_t blocked[W];
        embree.occluded(packet.rays, blocked);
        for (int i = 0; i < W; ++i) hits += blocked[i] != 0 ? 1u : 0u;
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
RayKind PacketLog::kind_of(RayQuery query, const RayPacket<W>& rays) const {
    const auto lane = std::distance(std::begin(rays.active),
                                    std::ranges::find_if(rays.active, [](int a) { return a; }));
    if (lane == W) return query == RayQuery::any_hit ? RayKind::shadow : RayKind::bounce;
    // A ray that only asks for the background goes on forever.
    if (query == RayQuery::any_hit && std::isfinite(rays.t_far[lane])) return RayKind::shadow;
    const bool from_camera = rays.origin[0][lane] == camera_origin_[0] &&
                             rays.origin[1][lane] == camera_origin_[1] &&
                             rays.origin[2][lane] == camera_origin_[2];
    return from_camera ? RayKind::primary : RayKind::bounce;
}

template <int W>
void PacketLog::add(RayQuery query, const RayPacket<W>& rays) {
    if (std::holds_alternative<std::monostate>(packets_)) packets_.emplace<List<W>>();
    std::get<List<W>>(packets_).push_back({rays, query, kind_of(query, rays)});
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
        for (const auto& packet : list) count += active_lanes(packet.rays);
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
void log_packet(PacketLog& log, RayQuery query, const RayPacket<W>& rays) {
    log.add(query, rays);
}

template void log_packet<1>(PacketLog&, RayQuery, const RayPacket<1>&);
template void log_packet<4>(PacketLog&, RayQuery, const RayPacket<4>&);
template void log_packet<8>(PacketLog&, RayQuery, const RayPacket<8>&);
template void log_packet<16>(PacketLog&, RayQuery, const RayPacket<16>&);

}  // namespace vecino
