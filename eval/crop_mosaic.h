// SPDX-License-Identifier: Apache-2.0
//
// A figure for a paper: per scene the reference with marked crops, and a column of these crops per
// result, with what was measured below. After figuregen's crop comparison.
#pragma once

#include <glm/vec3.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/grid.h"
#include "eval/report_data.h"

namespace vecino {

/// Part of an image, in its pixels, from the top left.
struct Crop {
    int x = 0, y = 0, width = 0, height = 0;
};

/// Reads "X,Y,WIDTH,HEIGHT". Throws Error(usage) unless these are integers, x and y at least 0,
/// width and height at least 1.
Crop parse_crop(const std::string& text);

struct MosaicOptions {
    std::vector<Crop> crops;           ///< a row each; none: whole images, in one row
    std::vector<std::string> metrics;  ///< a label each, in this order
};

/// Metrics that a label may show: all_metrics() and "time_s".
std::vector<std::string> mosaic_metrics();

/// One column per group of the rows that has a finished cell with an image: the first such cell's,
/// with that cell's own numbers; the best of a line is bold. Throws Error(usage) for a metric that
/// there is not, a crop that leaves an image or more than 12 results of a scene, Error(file) where
/// there is no image.
Grid<glm::u8vec3> crop_mosaic(const ReportData& data,
                              const std::vector<const nlohmann::json*>& rows,
                              const MosaicOptions& options);

}  // namespace vecino
