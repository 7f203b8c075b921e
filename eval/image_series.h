// SPDX-License-Identifier: Apache-2.0
//
// Image tests in VTK's way: several valid images of which the best match counts, and pictures of
// test, valid image and difference for a dashboard.
#pragma once

#include <string>
#include <vector>

#include "core/grid.h"

namespace vecino {

/// Of "name.exr": that file if it is there, then name_1.exr, name_2.exr, ... up to the first number
/// that is missing.
std::vector<std::string> valid_images(const std::string& path);

/// The one of valid_images() that the image is closest to by psnr_float_db; those of another size
/// do not count unless all are. Throws Error(quality) if there is none, saying how to make one.
std::string best_valid_image(const std::string& test, const std::string& path);

/// Writes test.png, valid.png and difference.png into a folder, which it makes, and returns CTest's
/// tags for them. Precondition: equal sizes.
std::string write_comparison(const Image& test, const Image& valid, const std::string& folder);

}  // namespace vecino
