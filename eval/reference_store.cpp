// SPDX-License-Identifier: Apache-2.0
#include "eval/reference_store.h"

#include <cstdio>
#include <filesystem>

#include "core/image_io.h"

namespace vecino {

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
                                           const std::function<Frame()>& make) {
    const auto known = references_.find(key);
    if (known != references_.end()) return known->second;
    const std::string name = scene + "-" + text_hash(key).substr(0, 8);
    const std::string path = directory_.file_in("references", name + ".exr");
    if (!std::filesystem::exists(path)) {
        const Frame frame = make();
        save_image(frame.radiance, directory_.file_in("references", name + ".png"));
        save_frame(frame, path);
    }
    Frame frame = load_frame(path);
    StoredReference stored{std::move(frame.radiance), {}, "references/" + name};
    frame.radiance = Image();
    stored.regions = regions_of(frame);
    return references_.emplace(key, std::move(stored)).first->second;
}

}  // namespace vecino
