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

const StoredReference& ReferenceStore::get(const std::string& key, const std::string& scene,
                                           const std::function<Image()>& make) {
    const auto known = references_.find(key);
    if (known != references_.end()) return known->second;
    const std::string name = scene + "-" + text_hash(key).substr(0, 8);
    const std::string path = directory_.file_in("references", name + ".exr");
    if (!std::filesystem::exists(path)) {
        const Image image = make();
        save_image(image, directory_.file_in("references", name + ".png"));
        save_image(image, path);
    }
    return references_.emplace(key, StoredReference{load_image(path), "references/" + name})
        .first->second;
}

}  // namespace vecino
