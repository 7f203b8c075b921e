// SPDX-License-Identifier: Apache-2.0
//
// Rows of the tables of methods that stand in files of their own.
#pragma once

#include <span>

#include "filters/methods.h"
#include "filters/surface_records_stages.h"

namespace vecino {

std::span<const MethodOption> auto_rows();
MethodRender run_auto(const MethodRequest& request, const Progress& progress);
std::span<const MethodOption> surface_records_rows();
/// What the table of methods says of a frame by surface records.
MethodRender method_render(StagedRender staged);
MethodRender run_surface_records(const MethodRequest& request, const Progress& progress);

}  // namespace vecino
