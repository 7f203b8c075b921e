// SPDX-License-Identifier: Apache-2.0
//
// What a render method did where, as a file to look at.
#pragma once

#include <string>

#include "core/grid.h"
#include "filters/methods.h"

namespace vecino {

/// Throws Error(usage) unless save_method_maps() can write such a file: .exr, .png or .bmp.
void require_map_extension(const std::string& path);

/// Writes the samples of every pixel, and the maps that the method made beside: to .exr as channels
/// of their names, the samples as SampleCount; else as pictures side by side, in this order, each
/// from black at 0 to pale yellow at its largest value. Throws Error(file).
void save_method_maps(const Grid<float>& sample_count, const MethodRender& render,
                      const std::string& path);

}  // namespace vecino
