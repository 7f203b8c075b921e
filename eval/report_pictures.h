// SPDX-License-Identifier: Apache-2.0
//
// The pictures of a report: error maps of all cells in one range, written beside the cells' images;
// and what the page shows of each group, as data: URLs; and the float values behind them.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/grid.h"
#include "eval/figure_pictures.h"
#include "eval/report_data.h"
#include "eval/report_planes.h"

namespace vecino {

/// Of one cell of a group. A picture that could not be made is an empty URL.
struct GroupPictures {
    std::string cell;
    std::string image, magnitude, sign;
    std::string plane;           ///< the id of its float values
    std::string embedded_plane;  ///< their element in the page; empty: they lie beside it
};

struct ReportPictures {
    float magnitude_range = 0;  ///< shared by all cells; 0 if there is no map
    float sign_range = 0;
    bool has_non_finite = false;                    ///< in any map
    bool has_linked = false;                        ///< some lie beside the page, for its size
    std::map<std::string, GroupPictures> by_group;  ///< groups of which a cell has an image
    std::map<std::string, std::string> references;  ///< URL by the rows' "reference_file"
    std::map<std::string, std::vector<LabelledPicture>> figures;  ///< that are no mosaic, by id
    std::map<std::string, Extent> sizes;                     ///< of the images of each reference
    std::map<std::string, std::string> embedded_references;  ///< elements of the page, by file
    std::string planes_folder;  ///< of the scripts with float values, as the page names it
    std::optional<PlanePrecision> embedded;  ///< none: they lie there
};

/// Writes cells/NAME/error.png and error_signed.png of every cell that has an image; and, unless
/// they are embedded, planes/cells/NAME.js and planes/references/NAME.js with the float values of
/// what the page shows. Throws Error(usage) where more would be embedded than a browser opens.
ReportPictures make_report_pictures(const ReportData& data, const PlaneOptions& options = {});

}  // namespace vecino
