// SPDX-License-Identifier: Apache-2.0
//
// What a pilot finds, for tests of what is made of it.
#pragma once

#include "filters/auto_plan.h"

namespace vecino::test {

/// Of a box with a sphere at 512x512.
inline PilotFindings usual_findings() {
    PilotFindings found;
    found.pixels = 512.0 * 512.0;
    found.needy_pixels = 14000;
    found.records_at_8 = 4300;
    found.record_growth = 3.8;
    found.path = PathErrors{1.6e-4, 1.4};
    found.records = RecordErrors{2.5e-7, 8e-7, 1e-6, 0};
    return found;
}

}  // namespace vecino::test
