// SPDX-License-Identifier: Apache-2.0
//
// The options of the render methods: the one table that the command line, matrices, cell names and
// help follow from.
#include <vector>

#include "filters/method_rows.h"
#include "filters/methods.h"

namespace vecino {

std::span<const MethodOption> method_options() {
    static const std::vector<MethodOption> rows = [] {
        std::vector<MethodOption> all;
        for (const MethodOption& row : surface_records_rows()) all.push_back(row);
        for (const MethodOption& row : auto_rows()) all.push_back(row);
        return all;
    }();
    return rows;
}

}  // namespace vecino
