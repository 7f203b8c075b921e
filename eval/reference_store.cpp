// SPDX-License-Identifier: Apache-2.0
#include "eval/reference_store.h"

#include <cstdio>
#include <filesystem>

#include "core/files.h"
#include "core/image_io.h"
#include "eval/reference_error.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

void mix(Image& image, const Image& other, double weight) {
    const auto w = static_cast<float>(weight);
    for (std::size_t i = 0; i < image.values().size(); ++i)
        image.values()[i] = (1.0f - w) * image.values()[i] + w * other.values()[i];
}

/// Where there is no second half, what the first says of its variance.
Json own_error(const ReferenceHalves& halves, const RegionMap& regions) {
    const RegionMap* const known = regions.empty() ? nullptr : &regions;
    if (halves.second.empty()) return reference_error(halves.first, known);
    return reference_error({halves.first.radiance, halves.second, halves.second_weight}, known);
}

RegionMap regions_if_known(const Frame& frame) {
    return has_region_planes(frame) ? regions_of(frame) : RegionMap();
}

void save_reference(ReferenceHalves halves, const std::string& path) {
    const Json error = own_error(halves, regions_if_known(halves.first));
    Frame& frame = halves.first;
    if (!halves.second.values().empty()) {
        mix(frame.radiance, halves.second, halves.second_weight);
        mix(frame.direct, halves.direct, halves.second_weight);
        mix(frame.indirect, halves.indirect, halves.second_weight);
    }
    save_image(frame.radiance, path + ".png");
    write_text_file(path + ".json", Json{{"own_error", error}}.dump(1) + "\n");
    save_frame(frame, path + ".exr");
}

Json kept_error(const std::string& path) {
    if (!std::filesystem::exists(path)) return nullptr;
    const Json kept = Json::parse(read_file(path), nullptr, false);
    return kept.is_object() ? kept.value("own_error", Json()) : Json();
}

}  // namespace

ReferenceHalves reference_halves(const RenderSettings& settings,
                                 const std::function<Frame(const RenderSettings&)>& trace) {
    ReferenceHalves halves;
    RenderSettings half = settings;
    half.spp = settings.spp - settings.spp / 2;
    halves.first = trace(half);
    half.spp = settings.spp / 2;
    if (half.spp == 0) return halves;
    half.seed = settings.seed + 1;
    Frame second = trace(half);
    halves.second = std::move(second.radiance);
    halves.direct = std::move(second.direct);
    halves.indirect = std::move(second.indirect);
    halves.second_weight = static_cast<double>(half.spp) / settings.spp;
    return halves;
}

std::string text_hash(const std::string& text) {
    char digits[32];
    std::snprintf(digits, sizeof digits, "%016zx", std::hash<std::string>{}(text));
    return digits;
}

Planes reference_planes() {
    Planes planes = kRegionPlanes;
    for (const Plane plane : {Plane::radiance, Plane::direct, Plane::indirect}) planes.add(plane);
    return planes;
}

const StoredReference& ReferenceStore::get(const std::string& key, const std::string& scene,
                                           const std::function<ReferenceHalves()>& make) {
    const auto known = references_.find(key);
    if (known != references_.end()) return known->second;
    const std::string name = scene + "-" + text_hash(key).substr(0, 8);
    const std::string path = directory_.file_in("references", name);
    if (!std::filesystem::exists(path + ".exr")) save_reference(make(), path);
    Frame frame = load_frame(path + ".exr");
    StoredReference stored{
        std::move(frame.radiance), {}, "references/" + name, kept_error(path + ".json")};
    frame.radiance = Image();
    stored.regions = regions_if_known(frame);
    return references_.emplace(key, std::move(stored)).first->second;
}

}  // namespace vecino
