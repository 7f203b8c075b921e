// SPDX-License-Identifier: Apache-2.0
//
// Textures of materials: their files, and how their images lie on flat surfaces.
#pragma once

#include <array>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <memory>
#include <string>

#include "core/json_read.h"
#include "core/scene.h"
#include "core/trace_task.h"

namespace vecino {

/// The path of a texture that a scene names, relative to the scene's directory. Throws Error(usage)
/// for an empty one.
std::string texture_file(const JsonValue& json);

/// Reads a file; json is where the scene names it, for errors. Throws as load_image() does, and
/// Error(usage) for sides of more than 16,384 texels, or values that are no share of light.
std::shared_ptr<const Texture> load_texture(const std::string& file, const JsonValue& json);

/// The image on the plane of three corners that span a triangle, with these uvs. The texture must
/// outlive it.
PlacedTexture place_texture(const Texture& texture, const std::array<glm::vec3, 3>& corners_world,
                            const std::array<glm::vec2, 3>& uvs);

}  // namespace vecino
