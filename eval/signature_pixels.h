// SPDX-License-Identifier: Apache-2.0
//
// The pixels that signatures look at, by what the reference shows there.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/vec2.hpp>
#include <utility>
#include <vector>

#include "eval/signatures.h"

namespace vecino {

/// In rows from the top. Throws Error(usage) if there are none, Error(mismatch) without ids.
std::vector<glm::ivec2> pixels_of(const Where& where, const Frame& reference);

/// Pairs of pixels side by side, all of them in the list, whose objects or normals differ as asked.
using PixelPair = std::pair<glm::ivec2, glm::ivec2>;
std::vector<PixelPair> neighbours(const std::vector<glm::ivec2>& pixels, Extent size);

/// Pixels of the objects that have one of another object beside them: the length of their outline.
std::size_t outline_px(const std::vector<int>& objects, const Frame& reference);

/// The mean radiance of an object's pixels that lie at least 2 px from any other object; of all of
/// them where none does.
glm::dvec3 mean_radiance(int object, const Frame& reference);

}  // namespace vecino
