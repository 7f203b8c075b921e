// SPDX-License-Identifier: Apache-2.0
//
// Pictures of the report's figures that are no results of cells: references, their parts of light,
// and strips of growing spp.
#pragma once

#include <string>
#include <vector>

#include "eval/report_data.h"

namespace vecino {

/// A picture and what it shows.
struct LabelledPicture {
    std::string label, url;
};

/// Of a figure that is no mosaic; none where the run lacks what it shows.
std::vector<LabelledPicture> figure_pictures(const ReportData& data, const Figure& figure);

}  // namespace vecino
