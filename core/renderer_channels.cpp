// SPDX-License-Identifier: Apache-2.0
//
// The names come from the renderers' sources and files: Blender 5.0 and 4.x (a view layer, the
// pass, the channel), Mitsuba 3.9 (a name of the user's choice, then R G B, X Y Z, T or I; those of
// its manual and of its types are known), pbrt-v4 (today's names and those of its first releases).
#include "core/renderer_channels.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <sstream>

#include "core/channel_file.h"
#include "core/error.h"
#include "core/files.h"
#include "core/image_format.h"
#include "core/image_io.h"
#include "core/json_read.h"

namespace vecino {
namespace {

/// Layers that hold a plane, in small letters, the best first: "" is a channel without a layer.
struct KnownLayers {
    Plane plane;
    std::vector<std::string_view> layers;
};

// clang-format off
const KnownLayers kLayers[] = {
    {Plane::radiance, {"", "combined", "beauty", "image", "rgb", "rgba"}},
    {Plane::emission, {"emission", "emit"}},
    {Plane::albedo,   {"albedo", "diffuse color", "diffcol", "denoising albedo", "alb"}},
    {Plane::position, {"p", "position", "pos", "pp"}},
    {Plane::normal,   {"n", "normal", "geo_normal", "sh_normal", "nn", "ns", "denoising normal"}},
    {Plane::distance, {"z", "depth", "distance", "dd.y", "dd", "denoising depth"}},
    {Plane::id,       {"id", "object index", "indexob", "shape_index", "object_id", "shape"}},
    {Plane::direct,   {"direct"}},
    {Plane::indirect, {"indirect"}},
};
// clang-format on

std::string lower(std::string_view text) {
    std::string result(text);
    for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return result;
}

/// Whether a layer, as "ViewLayer.Normal", is the one of that name: whatever stands before it.
bool is_layer(std::string_view layer, std::string_view name) {
    if (layer == name) return true;
    return !name.empty() && layer.size() > name.size() && layer.ends_with(name) &&
           layer[layer.size() - name.size() - 1] == '.';
}

/// A name before and after its last dot, in small letters. "Px" of pbrt's first releases is "P.x".
std::pair<std::string, std::string> split(const std::string& channel) {
    const std::string name = lower(channel);
    for (const char* old : {"p", "n", "ns"}) {
        const std::string_view rest =
            std::string_view(name).substr(std::min(name.size(), std::string_view(old).size()));
        if (name.starts_with(old) && (rest == "x" || rest == "y" || rest == "z"))
            return {old, std::string(rest)};
    }
    const std::size_t dot = name.rfind('.');
    if (dot == std::string::npos) return {"", name};
    return {name.substr(0, dot), name.substr(dot + 1)};
}

std::size_t channel_count(Plane plane) {
    return std::ranges::find(all_planes(), plane, &PlaneInfo::plane)->channel_count();
}

std::string name_of(Plane plane) {
    return std::string(std::ranges::find(all_planes(), plane, &PlaneInfo::plane)->name);
}

/// The channels of each layer that goes by a name.
using Found = std::map<std::string, std::vector<std::string>>;

/// Three channels of one layer, red before green before blue.
Found colour_layers(std::string_view name, std::span<const std::string> channels) {
    Found found;
    for (const char* tails : {"rgb", "xyz"}) {
        for (std::size_t i = 0; i < 3; ++i) {
            for (const std::string& channel : channels) {
                const auto [layer, tail] = split(channel);
                if (!is_layer(layer, name) || tail != std::string(1, tails[i])) continue;
                auto& list = found[layer + "(" + tails + ")"];
                if (list.size() == i) list.push_back(channel);
            }
        }
    }
    std::erase_if(found, [](const auto& entry) { return entry.second.size() < 3; });
    return found;
}

/// One channel: of a layer by that name, whatever follows the dot, or the name itself.
Found scalar_layers(std::string_view name, std::span<const std::string> channels) {
    static const std::set<std::string> kTails{"z", "v", "x", "y", "t", "i", "r", "id"};
    Found found;
    std::map<std::string, int> members;
    for (const std::string& channel : channels) {
        const auto [layer, tail] = split(channel);
        ++members[layer];
        const bool is_it =
            layer.empty() ? tail == name : is_layer(layer, name) && kTails.contains(tail);
        if (is_it) found[layer] = {channel};
        const bool is_last = !layer.empty() && tail == name && tail.size() > 1;
        if (is_last) found[lower(channel)] = {channel};
    }
    // "Z" of a position, or of a layer of colours, is none.
    std::erase_if(
        found, [&](const auto& entry) { return !entry.first.empty() && members[entry.first] > 1; });
    return found;
}

/// Grey counts as colour.
std::vector<std::string> grey(std::span<const std::string> channels) {
    const auto found = std::ranges::find(channels, "Y");
    if (found == channels.end()) return {};
    return {*found, *found, *found};
}

bool assign(glm::vec3& value, std::span<const Channel> channels, std::size_t i) {
    value = {channels[0].values[i], channels[1].values[i], channels[2].values[i]};
    return true;
}
bool assign(float& value, std::span<const Channel> channels, std::size_t i) {
    value = channels[0].values[i];
    return true;
}
bool assign(std::int32_t& value, std::span<const Channel> channels, std::size_t i) {
    constexpr float limit = 2147483648.0f;
    const float found = channels[0].values[i];
    if (!(found >= -limit && found < limit)) return false;
    value = static_cast<std::int32_t>(std::lround(found));
    return true;
}

void assemble(Frame& frame, const PlaneInfo& plane, const ChannelFile& file,
              const std::string& path) {
    const auto fill = [&](auto member) {
        auto& grid = frame.*member;
        grid = std::remove_reference_t<decltype(grid)>(file.size);
        for (std::size_t i = 0; i < grid.values().size(); ++i) {
            if (assign(grid.values()[i], file.channels, i)) continue;
            fail({file.channels[0].values[i], i, file.size.width, file.channels[0].name}, path,
                 "32-bit integers");
        }
    };
    std::visit(fill, plane.member);
}

std::string joined(std::span<const std::string> names) {
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text;
}

}  // namespace

void add_channel_names(const std::string& text, ChannelNames& names) {
    const auto fault = [&](const std::string& allowed) {
        throw Error(ExitCode::usage,
                    "command line: --channel: found \"" + text + "\", allowed: " + allowed);
    };
    const std::size_t equals = text.find('=');
    std::vector<std::string_view> planes;
    for (const KnownLayers& known : kLayers)
        planes.push_back(std::ranges::find(all_planes(), known.plane, &PlaneInfo::plane)->name);
    const std::string plane = text.substr(0, equals);
    const auto row = std::ranges::find(all_planes(), plane, &PlaneInfo::name);
    const bool is_known = std::ranges::find(planes, plane) != planes.end();
    if (equals == std::string::npos || !is_known)
        fault("PLANE=CHANNEL or PLANE=X,Y,Z with PLANE one of " + join(planes));
    std::vector<std::string> channels;
    std::stringstream stream(text.substr(equals + 1));
    for (std::string channel; std::getline(stream, channel, ',');) channels.push_back(channel);
    if (channels.size() != row->channel_count() ||
        std::ranges::any_of(channels, &std::string::empty))
        fault("the names of " + std::to_string(row->channel_count()) + " channels of " + plane);
    names[row->plane] = channels;
}

std::optional<std::vector<std::string>> find_plane(Plane plane,
                                                   std::span<const std::string> channels,
                                                   const std::string& path) {
    const auto* row = std::ranges::find(kLayers, plane, &KnownLayers::plane);
    if (row == std::end(kLayers)) return std::nullopt;
    for (const std::string_view name : row->layers) {
        const Found found = channel_count(plane) == 3 ? colour_layers(name, channels)
                                                      : scalar_layers(name, channels);
        if (found.empty()) continue;
        if (found.size() == 1) return found.begin()->second;
        throw Error(ExitCode::mismatch,
                    one_line(path + ": found " + name_of(plane) + " in channels " +
                             joined(found.begin()->second) + " and in " +
                             joined(std::next(found.begin())->second) + ", allowed: --channel " +
                             name_of(plane) + "=... to say which"));
    }
    if (plane != Plane::radiance) return std::nullopt;
    const auto only = grey(channels);
    return only.empty() ? std::nullopt : std::optional(only);
}

namespace {

bool has_own_radiance(std::span<const std::string> channels) {
    const auto has = [&](const char* name) {
        return std::ranges::find(channels, name) != channels.end();
    };
    return has("Y") || (has("R") && has("G") && has("B"));
}

/// Light of the background that Blender keeps apart from that of emitters.
void add_environment(Frame& frame, std::span<const std::string> channels, const std::string& path) {
    for (const char* name : {"environment", "env"}) {
        for (const auto& [layer, names] : colour_layers(name, channels)) {
            const ChannelFile file = load_channels(path, names);
            if (file.size != frame.emission.size()) continue;
            for (std::size_t i = 0; i < file.size.area(); ++i) {
                glm::vec3 value;
                assign(value, file.channels, i);
                frame.emission.values()[i] += value;
            }
        }
    }
}

}  // namespace

RendererFrame load_renderer_frame(const std::string& path, Planes wanted,
                                  const ChannelNames& given) {
    if (!path.ends_with(".exr")) return {load_frame(path), {}};
    const std::vector<ChannelInfo> infos = list_channels(path);
    std::vector<std::string> channels;
    for (const ChannelInfo& info : infos) channels.push_back(info.name);
    RendererFrame result;
    const bool is_own = has_own_radiance(channels) && !given.contains(Plane::radiance);
    const auto names_of = [&](Plane plane) {
        const auto named = given.find(plane);
        return named != given.end() ? std::optional(named->second)
                                    : find_plane(plane, channels, path);
    };
    if (is_own || (wanted.has(Plane::radiance) && !names_of(Plane::radiance)))
        result.frame = load_frame(path);  // or throws, saying what is missing
    const Planes held = planes_of(result.frame);
    for (const PlaneInfo& plane : all_planes()) {
        if (!wanted.has(plane.plane)) continue;
        const auto names = held.has(plane.plane) && !given.contains(plane.plane)
                               ? std::nullopt
                               : names_of(plane.plane);
        if (!names) continue;
        const auto is_half = [&](const ChannelInfo& info) {
            return info.is_half && info.name == names->front();
        };
        if (std::ranges::any_of(infos, is_half)) result.half_planes.add(plane.plane);
        assemble(result.frame, plane, load_channels(path, *names), path);
        if (plane.plane == Plane::emission && !given.contains(Plane::emission))
            add_environment(result.frame, channels, path);
    }
    return result;
}

}  // namespace vecino
