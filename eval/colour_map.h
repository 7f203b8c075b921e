// SPDX-License-Identifier: Apache-2.0
//
// The two colour maps of error pictures, and the colour that stands for "no number". Lightness
// tells the size of the error in both maps, so they can be read without colour vision and in print.
#pragma once

#include <glm/vec3.hpp>

namespace vecino {

/// Magenta is in neither map, and stays apart from both of them when protan, deutan and tritan
/// vision are simulated: no colour of theirs comes closer than a CIELAB distance of 15.
constexpr glm::u8vec3 kNonFiniteColour{255, 0, 255};

/// Magma, from black (0) to pale yellow (1): perceptually uniform, lightness never falls. Clipped
/// to [0,1].
glm::u8vec3 sequential_colour(float value);

/// Cool to warm, from blue (-1) over light grey (0) to red (1), linear in CIELAB. Clipped to
/// [-1,1]; colours of v and -v stand equally far from the grey.
glm::u8vec3 diverging_colour(float value);

}  // namespace vecino
