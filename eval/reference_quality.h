// SPDX-License-Identifier: Apache-2.0
//
// Whether the references of a run are good enough for what they judge. A reference that is 15 dB
// better than an image puts at most 3 % into its error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/report_data.h"

namespace vecino {

constexpr double kReferenceMargin_db = 15.0;

/// A reference's own error and the best result that is held against it, in a region or the whole
/// image.
struct ReferencePart {
    RegionName region;                   ///< empty: the whole image
    std::optional<double> own_db;        ///< psnr_float_db of the reference; none: unknown
    std::optional<double> best_db;       ///< of the results
    std::string best;                    ///< the group that has it
    std::vector<std::string> too_close;  ///< groups within kReferenceMargin_db of own_db

    [[nodiscard]] std::optional<double> margin_db() const;
};

struct ReferenceQuality {
    std::string file;                  ///< as rows name it
    std::string scene;                 ///< of its first row
    std::string made;                  ///< how it was made
    std::vector<ReferencePart> parts;  ///< the whole image, then the regions that have results
};

/// One per reference, in the order of the rows.
std::vector<ReferenceQuality> reference_quality(const ReportData& data);

}  // namespace vecino
