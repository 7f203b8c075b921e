// SPDX-License-Identifier: Apache-2.0
#include "core/part_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>
#include <vector>

#include "core/channel_file.h"
#include "core/error.h"
#include "core/files.h"
#include "core/frame_planes.h"
#include "core/image_format.h"
#include "core/memory.h"

namespace vecino {
namespace {

constexpr float kLeastDigit = -0x1p23f;
constexpr float kMostDigit = 0x1p23f;

std::string channel_name(const std::string& sum, std::size_t digit) {
    return "Sum." + sum + "." + std::to_string(digit);
}

std::string names_of(Planes planes) {
    std::string names;
    for (const PlaneInfo& info : all_planes()) {
        if (planes.has(info.plane)) names += (names.empty() ? "" : ",") + std::string(info.name);
    }
    return names;
}

// ---------------------------------------------------------------- first hits as channels

void set_component(glm::vec3& to, std::size_t c, float value) {
    to[static_cast<int>(c)] = value;
}
void set_component(float& to, std::size_t, float value) {
    to = value;
}
void set_component(std::int32_t& to, std::size_t, float value) {
    to = static_cast<std::int32_t>(value);
}

void add_first_hits(const Frame& frame, std::vector<ChannelSource>& channels) {
    for (const PlaneInfo& info : all_planes()) {
        if (!planes_of(frame).has(info.plane)) continue;
        for (std::size_t c = 0; c < info.channel_count(); ++c) {
            const auto add = [&](auto member) {
                const auto& values = (frame.*member).values();
                channels.push_back({std::string(info.channels[c]), [&values, c](std::size_t pixel) {
                                        return component(values[pixel], c);
                                    }});
            };
            std::visit(add, info.member);
        }
    }
}

/// Ids of first hits; other planes take any float.
void require_ids(const Channel& channel, const std::string& path) {
    const auto is_id = [](float x) { return x >= -0x1p31f && x < 0x1p31f && std::trunc(x) == x; };
    if (!std::ranges::all_of(channel.values, is_id))
        cannot_read(path, "channel " + channel.name + " does not hold 32-bit integers");
}

/// False if the channel is none of a first hit.
bool take_first_hit(const Channel& channel, const std::string& path, Frame& frame) {
    for (const PlaneInfo& info : all_planes()) {
        const auto* const found = std::ranges::find(info.channels, channel.name);
        if (found == info.channels.end() || !planes_of(frame).has(info.plane)) continue;
        const auto c = static_cast<std::size_t>(found - info.channels.begin());
        if (info.plane == Plane::id) require_ids(channel, path);
        const auto fill = [&](auto member) {
            auto& values = (frame.*member).values();
            for (std::size_t i = 0; i < values.size(); ++i) {
                set_component(values[i], c, channel.values[i]);
            }
        };
        std::visit(fill, info.member);
        return true;
    }
    return false;
}

// ---------------------------------------------------------------- attributes

/// In quotes; a broken file may hold a megabyte of it.
std::string shown(const std::string& text) {
    constexpr std::size_t kMost = 200;
    return '"' + (text.size() <= kMost ? text : text.substr(0, kMost) + "...") + '"';
}

template <class T>
T attribute(const PartHeader& header, const std::string& name) {
    const auto found = header.metadata.find(name);
    const T* const value =
        found == header.metadata.end() ? nullptr : std::get_if<T>(&found->second);
    if (value == nullptr) cannot_read(header.path, "attribute " + name + " is missing or damaged");
    return *value;
}

SampleInterval interval_of(const PartHeader& header) {
    const auto text = attribute<std::string>(header, "samples");
    const char* const end = text.data() + text.size();
    SampleInterval samples;
    const auto first = std::from_chars(text.data(), end, samples.begin);
    const bool colon = first.ec == std::errc() && first.ptr != end && *first.ptr == ':';
    if (colon) std::from_chars(first.ptr + 1, end, samples.end);
    if (!interval_fault(samples, header.spp).empty() || interval_text(samples) != text) {
        cannot_read(header.path, "attribute samples is " + shown(text));
    }
    return samples;
}

Planes planes_of(const PartHeader& header) {
    const auto text = attribute<std::string>(header, "planes");
    Planes planes;
    for (const PlaneInfo& info : all_planes()) {
        if (("," + text + ",").find("," + std::string(info.name) + ",") != std::string::npos) {
            planes.add(info.plane);
        }
    }
    if (names_of(planes) != text || !planes.has(Plane::radiance)) {
        cannot_read(header.path, "attribute planes is " + shown(text));
    }
    return planes;
}

void require_part(const PartHeader& header) {
    const auto found = header.metadata.find(kPartFormat);
    if (found == header.metadata.end()) {
        throw Error(ExitCode::mismatch,
                    header.path +
                        ": found no part of a render, allowed: what vecino render "
                        "--samples A:B writes");
    }
    const int version = attribute<int>(header, kPartFormat);
    if (version == kPartFormatVersion) return;
    throw Error(ExitCode::mismatch, header.path + ": found part_format " + std::to_string(version) +
                                        ", allowed: " + std::to_string(kPartFormatVersion));
}

// ---------------------------------------------------------------- sums as channels

std::vector<float> checked(Channel&& channel, const std::string& path) {
    const auto is_digit = [](float x) {
        return x >= kLeastDigit && x < kMostDigit && std::trunc(x) == x;
    };
    if (!std::ranges::all_of(channel.values, is_digit)) {
        cannot_read(path, "channel " + channel.name + " does not hold integers of 24 bits");
    }
    return std::move(channel.values);
}

/// False if the channel is no digit of a sum.
bool take_digit(Channel& channel, const std::vector<std::string>& names, const std::string& path,
                SampleSums& sums) {
    const std::size_t dot = channel.name.rfind('.');
    const std::string prefix = "Sum.";
    if (!channel.name.starts_with(prefix) || dot < prefix.size()) return false;
    const auto sum =
        std::ranges::find(names, channel.name.substr(prefix.size(), dot - prefix.size()));
    for (std::size_t digit = 0; sum != names.end() && digit < ExactSum::kDigits; ++digit) {
        if (channel.name != channel_name(*sum, digit)) continue;
        const auto index = static_cast<std::size_t>(sum - names.begin());
        sums.set_plane(index, digit, checked(std::move(channel), path));
        return true;
    }
    return false;
}

}  // namespace

void save_part(const Part& part, const std::string& path, Metadata metadata) {
    std::vector<ChannelSource> channels;
    add_first_hits(part.first_hits, channels);
    const std::vector<std::string> names = sum_names(part.variance_of);
    for (std::size_t sum = 0; sum < names.size(); ++sum) {
        for (std::size_t digit = 0; digit < ExactSum::kDigits; ++digit) {
            const std::vector<float>& values = part.sums.plane(sum, digit);
            if (std::ranges::all_of(values, [](float x) { return x == 0.0f; })) continue;
            channels.push_back({channel_name(names[sum], digit),
                                [&values](std::size_t pixel) { return values[pixel]; }});
        }
    }
    metadata[kPartFormat] = kPartFormatVersion;
    metadata["samples"] = interval_text(part.samples);
    metadata["planes"] = names_of(part.planes);
    save_channels(path, part.sums.size(), channels, metadata);
}

PartHeader load_part_header(const std::string& path) {
    ChannelFile file = load_header(path);
    PartHeader header{path, file.size, 0, {}, {}, VarianceOf::nothing, std::move(file.metadata)};
    require_part(header);
    header.spp = attribute<int>(header, "spp");
    header.samples = interval_of(header);
    header.planes = planes_of(header);
    if (header.planes.has(Plane::variance)) {
        const bool sobol = attribute<std::string>(header, "sampler") == "sobol";
        header.variance_of = sobol ? VarianceOf::streams : VarianceOf::samples;
    }
    return header;
}

Part load_part(const PartHeader& header) {
    ChannelFile file = load_channels(header.path);
    const std::vector<std::string> names = sum_names(header.variance_of);
    Part part{
        header.samples, header.planes, header.variance_of, SampleSums(file.size, names.size()), {}};
    Planes missing;
    if (part.samples.begin == 0) {
        missing = common(part.planes, kFirstHitPlanes);
        part.first_hits = make_frame(file.size, missing);
    }
    std::size_t hit_channels = 0;
    for (Channel& channel : file.channels) {
        if (take_digit(channel, names, header.path, part.sums)) continue;
        if (!take_first_hit(channel, header.path, part.first_hits)) {
            cannot_read(header.path, "channel " + channel.name + " is none of a part");
        }
        ++hit_channels;
        channel.values = {};
    }
    if (bytes_of(missing, {1, 1}) != hit_channels * sizeof(float)) {
        cannot_read(header.path, "channels of the first hit are missing");
    }
    return part;
}

}  // namespace vecino
