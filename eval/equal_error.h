// SPDX-License-Identifier: Apache-2.0
//
// What a time budget buys: how long other methods take to reach the error that a group with a
// budget has. Errors are those of psnr_float_db with the reference's own taken off, as far as that
// is known; times those of tracing and reconstruction.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/summary.h"

namespace vecino {

/// Time of a rival over that of the group, at the group's error.
struct EqualErrorFactor {
    enum class Kind {
        measured,
        extrapolated,  ///< beyond the rival's last point, along its slope
        at_most,       ///< the rival's first point is better already
    };
    double factor = 0;
    Kind kind = Kind::measured;
};

/// A group with a budget.
struct EqualErrorRow {
    const GroupSummary* group;
    double error;  ///< mean square, sRGB
    std::vector<std::optional<EqualErrorFactor>>
        factors;  ///< by rival; none: its errors do not fall
};

struct EqualErrorTable {
    std::vector<std::string> rivals;  ///< methods, and what tells variants of them apart
    std::vector<EqualErrorRow> rows;  ///< in the order of the groups
};

/// Rivals are what a run has at two or more spp. Rows refer to groups. Empty without budgets.
EqualErrorTable equal_error(std::span<const GroupSummary> groups);

/// "× 81.2", "× 170 e" if it is extrapolated, "≤ × 6.31", "–" for none.
std::string equal_error_text(const std::optional<EqualErrorFactor>& factor);

}  // namespace vecino
