// SPDX-License-Identifier: Apache-2.0
#include "core/planes.h"

#include <algorithm>
#include <sstream>

#include "core/error.h"

namespace vecino {
namespace {

// clang-format off
const PlaneInfo kPlanes[] = {
    {Plane::radiance, "radiance", {"R", "G", "B"},                            &Frame::radiance},
    {Plane::direct,   "direct",   {"Direct.R", "Direct.G", "Direct.B"},       &Frame::direct},
    {Plane::indirect, "indirect", {"Indirect.R", "Indirect.G", "Indirect.B"}, &Frame::indirect},
    {Plane::emission, "emission", {"Emission.R", "Emission.G", "Emission.B"}, &Frame::emission},
    {Plane::albedo,   "albedo",   {"Albedo.R", "Albedo.G", "Albedo.B"},       &Frame::albedo},
    {Plane::position, "position", {"P.X", "P.Y", "P.Z"},                      &Frame::position_world},
    {Plane::normal,   "normal",   {"N.X", "N.Y", "N.Z"},                      &Frame::normal_world},
    {Plane::distance, "distance", {"Z", "", ""},                              &Frame::distance_world},
    {Plane::id,       "id",       {"Id", "", ""},                             &Frame::object_id},
    {Plane::count,    "count",    {"SampleCount", "", ""},                    &Frame::sample_count},
    {Plane::variance, "variance", {"Variance.R", "Variance.G", "Variance.B"}, &Frame::variance},
    {Plane::albedo_mean, "albedo_mean", {"AlbedoMean.R", "AlbedoMean.G", "AlbedoMean.B"}, &Frame::albedo_mean},
    {Plane::normal_mean, "normal_mean", {"NormalMean.X", "NormalMean.Y", "NormalMean.Z"}, &Frame::normal_world_mean},
};
// clang-format on

[[noreturn]] void unknown_plane(const std::string& name) {
    std::string allowed = "all";
    for (const PlaneInfo& info : kPlanes) allowed += ", " + std::string(info.name);
    throw Error(ExitCode::usage, "--planes: found \"" + name + "\", allowed: " + allowed);
}

}  // namespace

std::span<const PlaneInfo> all_planes() {
    return kPlanes;
}

Planes parse_planes(const std::string& list) {
    if (list == "all") return Planes::all();
    Planes planes;
    std::stringstream stream(list);
    std::string name;
    do {
        name.clear();
        std::getline(stream, name, ',');
        const auto* row = std::ranges::find(kPlanes, name, &PlaneInfo::name);
        if (row == std::end(kPlanes)) unknown_plane(name);
        planes.add(row->plane);
    } while (!stream.eof());
    return planes;
}

Planes planes_of(const Frame& frame) {
    Planes planes;
    for (const PlaneInfo& info : kPlanes) {
        const bool made =
            std::visit([&](auto member) { return !(frame.*member).empty(); }, info.member);
        if (made) planes.add(info.plane);
    }
    return planes;
}

}  // namespace vecino
