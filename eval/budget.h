// SPDX-License-Identifier: Apache-2.0
//
// How many samples a low-resolution frame gets, against path tracing of every pixel. A budget is
// one row of the table in budget.cpp.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/grid.h"
#include "core/json_read.h"

namespace vecino {

enum class Budget {
    same_spp,           ///< as many per pixel (thesis 5.3)
    equal_samples,      ///< as many in all: spp * W*H / (w*h), rounded (thesis 5.4.1)
    thesis_equal_time,  ///< 4.8 times as many per pixel: the thesis's 48,000 for 10,000 (5.4.2)
    equal_time,         ///< as many as take path tracing's time on this machine, measured
};

std::vector<std::string_view> budget_names();
std::string budget_name(Budget budget);

/// Throws Error(usage) naming the allowed ones.
Budget budget_of(const JsonValue& json);

struct FrameSizes {
    Extent full, low;
};

/// Samples per low-resolution pixel when path tracing at full resolution has spp. What equal_time
/// gets is only known once it was measured (equal_time.h); until then it is that of equal_samples.
int budgeted_spp(Budget budget, int spp, const FrameSizes& sizes);

}  // namespace vecino
