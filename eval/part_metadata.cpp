// SPDX-License-Identifier: Apache-2.0
#include "eval/part_metadata.h"

#include <charconv>

#include "core/error.h"
#include "core/files.h"
#include "eval/render_metadata.h"

namespace vecino {
namespace {

constexpr const char* kSceneHash = "scene_hash";
constexpr const char* kSimdWidth = "simd_width";
constexpr const char* kRays = "rays";
constexpr const char* kDropped = "dropped_samples";
constexpr const char* kSeconds = "seconds";

/// All of two parts but these has to be equal.
bool may_differ(const std::string& name) {
    return name == kSeconds || name == "scene";  // a copy of the scene file may be elsewhere
}

void require_same(const PartHeader& first, const PartHeader& other) {
    const auto require = [&](const std::string& name, const std::string& found,
                             const std::string& allowed) {
        if (found == allowed) return;
        throw Error(ExitCode::mismatch, other.path + ": found " + name + " " + found +
                                            ", allowed: " + allowed + ", as in " + first.path);
    };
    std::vector<std::string> names = {kSceneHash, "planes", kSimdWidth};
    for (const auto& [name, value] : render_metadata("", {}, 0)) {
        if (!may_differ(name)) names.push_back(name);
    }
    for (const std::string& name : names) {
        require(name, attribute_text(other.metadata, name), attribute_text(first.metadata, name));
    }
    require("an image of", size_text(other.size), size_text(first.size));
}

void require_touching(const PartHeader& before, const PartHeader& after) {
    if (after.samples.begin < before.samples.end) {
        throw Error(ExitCode::mismatch, after.path + ": found samples " +
                                            interval_text(after.samples) + ", which overlap " +
                                            interval_text(before.samples) + " of " + before.path +
                                            ", allowed: parts without overlap");
    }
    if (after.samples.begin > before.samples.end) {
        throw Error(ExitCode::mismatch,
                    after.path + ": found samples " + interval_text(after.samples) + " after " +
                        interval_text(before.samples) + " of " + before.path +
                        ", allowed: parts without a gap (" +
                        interval_text({before.samples.end, after.samples.begin}) + " is missing)");
    }
}

std::uint64_t count_of(const PartHeader& part, const std::string& name) {
    const std::string text = attribute_text(part.metadata, name);
    std::uint64_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc() || end != text.data() + text.size()) {
        cannot_read(part.path, "attribute " + name + " is \"" + text + "\"");
    }
    return count;
}

double seconds_of(const PartHeader& part) {
    const auto found = part.metadata.find(kSeconds);
    const float* const seconds =
        found == part.metadata.end() ? nullptr : std::get_if<float>(&found->second);
    if (seconds == nullptr) cannot_read(part.path, "attribute seconds is missing or damaged");
    return static_cast<double>(*seconds);
}

}  // namespace

void describe_part(const std::string& scene_hash, const RenderStatistics& statistics,
                   Metadata& metadata) {
    metadata[kSceneHash] = scene_hash;
    metadata[kSimdWidth] = statistics.simd_width;
    metadata[kRays] = std::to_string(statistics.rays);
    metadata[kDropped] = std::to_string(statistics.dropped_samples);
}

void require_one_render(std::span<const PartHeader> parts) {
    for (const PartHeader& part : parts.subspan(1)) require_same(parts.front(), part);
    for (std::size_t i = 1; i < parts.size(); ++i) require_touching(parts[i - 1], parts[i]);
}

Metadata image_metadata(std::span<const PartHeader> parts) {
    Metadata metadata;
    const Metadata& first = parts.front().metadata;
    for (const auto& [name, value] : render_metadata("", {}, 0)) {
        if (const auto found = first.find(name); found != first.end()) metadata.insert(*found);
    }
    metadata[kSeconds] = static_cast<float>(total_statistics(parts).trace_s);
    return metadata;
}

Metadata part_metadata(std::span<const PartHeader> parts) {
    Metadata metadata = image_metadata(parts);
    describe_part(attribute_text(parts.front().metadata, kSceneHash), total_statistics(parts),
                  metadata);
    return metadata;
}

RenderStatistics total_statistics(std::span<const PartHeader> parts) {
    RenderStatistics total;
    total.simd_width = static_cast<int>(count_of(parts.front(), kSimdWidth));
    for (const PartHeader& part : parts) {
        total.rays += count_of(part, kRays);
        total.dropped_samples += count_of(part, kDropped);
        total.samples +=
            part.size.area() * static_cast<std::uint64_t>(part.samples.end - part.samples.begin);
        total.trace_s += seconds_of(part);
    }
    return total;
}

}  // namespace vecino
