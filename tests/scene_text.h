// SPDX-License-Identifier: Apache-2.0
//
// Small scenes for tests, written as JSON in the test that needs them.
#pragma once

#include <glm/vec3.hpp>
#include <string>

#include "core/json_read.h"
#include "core/render.h"
#include "core/scene.h"

namespace vecino::test {

inline Scene scene_from(const std::string& text) {
    return parse_scene(parse_json_text(text, "test.json"), "test.json");
}

inline Scene repository_scene(const std::string& name) {
    return load_scene(std::string(VECINO_SOURCE_DIR) + "/scenes/" + name + ".json");
}

inline RenderSettings small_settings(Extent size, int spp) {
    RenderSettings settings;
    settings.size = size;
    settings.spp = spp;
    return settings;
}

inline glm::dvec3 mean_of(const Image& image) {
    glm::dvec3 sum(0.0);
    for (const glm::vec3& value : image.values()) sum += glm::dvec3(value);
    return sum / static_cast<double>(image.values().size());
}

/// A closed cube [-1, 1]^3 whose inside has the given material.
inline std::string closed_cube(const std::string& material) {
    return R"({"camera": {"position": [0.1, 0.2, 0.3], "look_at": [1, 0.4, -1], "up": [0, 1, 0], "vertical_fov_degrees": 70},
        "materials": {"m": )" +
           material + R"(},
        "objects": [
          {"quad": [[-1,-1,-1],[-1,-1,1],[1,-1,1],[1,-1,-1]], "material": "m"},
          {"quad": [[-1,1,-1],[1,1,-1],[1,1,1],[-1,1,1]], "material": "m"},
          {"quad": [[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1]], "material": "m"},
          {"quad": [[-1,-1,1],[-1,1,1],[1,1,1],[1,-1,1]], "material": "m"},
          {"quad": [[-1,-1,-1],[-1,1,-1],[-1,1,1],[-1,-1,1]], "material": "m"},
          {"quad": [[1,-1,-1],[1,-1,1],[1,1,1],[1,1,-1]], "material": "m"}]})";
}

}  // namespace vecino::test
