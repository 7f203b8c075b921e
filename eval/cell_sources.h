// SPDX-License-Identifier: Apache-2.0
//
// The files behind a cell that vecino does not make: what they hold now, told by hashes.
#pragma once

#include <string>

#include "eval/matrix.h"

namespace vecino {

/// Precondition: the matrix names a reference file.
std::string reference_path(const Matrix& matrix, const Cell& cell);

/// Of the file that holds the cell's image, or of all files that its command is given; empty for
/// cells of other kinds. Never throws: files that are not there have a hash too.
std::string image_hash(const Matrix& matrix, const Cell& cell);

/// Of the reference file; empty where the reference is rendered. Never throws.
std::string reference_hash(const Matrix& matrix, const Cell& cell);

}  // namespace vecino
