// SPDX-License-Identifier: Apache-2.0
//
// The files behind a cell: what they hold now, told by hashes.
#pragma once

#include <string>

#include "core/scene.h"
#include "eval/matrix.h"

namespace vecino {

/// Of a scene file and of the textures that its scene is made with. Throws Error(file).
std::string scene_hash(const std::string& path, const Scene& scene);

/// Precondition: the matrix names a reference file.
std::string reference_path(const Matrix& matrix, const Cell& cell);

/// Of the file that holds the cell's image, or of all files that its command is given; empty for
/// cells of other kinds. Never throws: files that are not there have a hash too.
std::string image_hash(const Matrix& matrix, const Cell& cell);

/// Of the reference file; empty where the reference is rendered. Never throws.
std::string reference_hash(const Matrix& matrix, const Cell& cell);

}  // namespace vecino
