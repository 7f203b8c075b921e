// SPDX-License-Identifier: Apache-2.0
//
// Single pictures of a run for other documents than its report: a figure's results side by side,
// and speed against accuracy.
#pragma once

#include <glm/vec3.hpp>
#include <string>

#include "core/grid.h"
#include "eval/report_data.h"

namespace vecino {

/// The reference of the first result's scene, then a mosaic figure's results, each with its name,
/// its psnr_float_db and its time. Throws Error(usage) for an id that is no mosaic figure of the
/// run's matrix, Error(file) when none of its results has an image.
Grid<glm::u8vec3> mosaic_raster(const ReportData& data, const std::string& figure);

/// Time against psnr_float_db of the whole image, one chart per scene: results of the first variant
/// at any spp. Throws Error(file) when no result has both.
Grid<glm::u8vec3> chart_raster(const ReportData& data);

}  // namespace vecino
