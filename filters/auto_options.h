// SPDX-License-Identifier: Apache-2.0

/// @file
/// What the method `auto` can be told on a command line or in a matrix.
#pragma once

#include <optional>

namespace vecino {

/// What is to be spent.
struct AutoOptions {
    /// Seconds for tracing and reconstruction, 0.001 to 86400. Without: what plain path tracing
    /// takes for RenderSettings::spp, by rates that are the same on all machines.
    std::optional<double> time_budget_s;
};

}  // namespace vecino
