// SPDX-License-Identifier: Apache-2.0
#include "core/texture.h"

#include <filesystem>
#include <glm/geometric.hpp>

#include "core/channel_file.h"
#include "core/error.h"
#include "core/image_format.h"
#include "core/image_io.h"

namespace vecino {
namespace {

constexpr int kMostTexels = 16384;  ///< of a side: 3 GiB as floats

Image load_texels(const std::string& file) {
    const Extent size = load_header(file).size;  // before memory is taken for it
    if (size.width > kMostTexels || size.height > kMostTexels) {
        throw Error(ExitCode::usage, file + ": found an image of " + size_text(size) +
                                         ", allowed: sides of at most " +
                                         std::to_string(kMostTexels));
    }
    Image texels = load_image(file);
    require_finite(texels, file);
    return texels;
}

void require_shares(const Image& texels, const JsonValue& json, const std::string& file) {
    for (int y = 0; y < texels.size().height; ++y) {
        for (int x = 0; x < texels.size().width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const float value = texels(x, y)[c];
                if (value >= 0.0f && value <= 1.0f) continue;
                json.fail(file + " with " + std::to_string(value) + " at texel (" +
                              std::to_string(x) + ", " + std::to_string(y) + ")",
                          "an image of values from 0 to 1");
            }
        }
    }
}

}  // namespace

std::string texture_file(const JsonValue& json) {
    const std::string path = json.string();
    if (path.empty()) json.fail("an image's path, relative to the scene file");
    const auto directory = std::filesystem::path(json.file()).parent_path();
    return (directory / path).lexically_normal().string();
}

std::shared_ptr<const Texture> load_texture(const std::string& file, const JsonValue& json) {
    const auto texture = std::make_shared<Texture>();
    texture->file = file;
    try {
        texture->texels = load_texels(file);
    } catch (const Error& error) {
        throw Error(error.code(), json.file() + ": " + json.pointer() + ": " + error.what());
    }
    require_shares(texture->texels, json, file);
    return texture;
}

PlacedTexture place_texture(const Texture& texture, const std::array<glm::vec3, 3>& corners_world,
                            const std::array<glm::vec2, 3>& uvs) {
    const glm::dvec3 edge1 = glm::dvec3(corners_world[1]) - glm::dvec3(corners_world[0]);
    const glm::dvec3 edge2 = glm::dvec3(corners_world[2]) - glm::dvec3(corners_world[0]);
    const glm::dvec3 normal = glm::cross(edge1, edge2);
    // How far a point is along each edge grows by so much per unit of length.
    const glm::dvec3 along1 = glm::cross(edge2, normal) / glm::dot(normal, normal);
    const glm::dvec3 along2 = glm::cross(normal, edge1) / glm::dot(normal, normal);
    PlacedTexture placed{};
    placed.texels = &texture.texels.values().front().x;
    placed.width = texture.texels.size().width;
    placed.height = texture.texels.size().height;
    for (int k = 0; k < 2; ++k) {
        const double by_edge1 = static_cast<double>(uvs[1][k]) - static_cast<double>(uvs[0][k]);
        const double by_edge2 = static_cast<double>(uvs[2][k]) - static_cast<double>(uvs[0][k]);
        const glm::dvec3 gradient = along1 * by_edge1 + along2 * by_edge2;
        for (int c = 0; c < 3; ++c) {
            placed.origin[c] = corners_world[0][c];
            placed.gradient[k][c] = static_cast<float>(gradient[c]);
        }
        placed.at_origin[k] = uvs[0][k];
    }
    return placed;
}

}  // namespace vecino
