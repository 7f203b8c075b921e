// SPDX-License-Identifier: Apache-2.0
//
// Goes over every scheme with every combination of the options that it reads.
#pragma once

#include "tests/catch.h"
#include "tests/scheme_frames.h"

namespace vecino {

/// Calls check(scheme, parameters), under the name of the cell.
template <class Check>
void for_each_cell(int window, Check&& check) {
    for (const Scheme& scheme : all_schemes()) {
        for (const SchemeParameters& parameters : parameters_of(scheme, window)) {
            INFO(cell_name(scheme, parameters));
            check(scheme, parameters);
        }
    }
}

}  // namespace vecino
