// SPDX-License-Identifier: Apache-2.0
//
// The pilot of the method auto: small frames of what is wanted, which say what things cost and how
// wrong they are without a reference.
#pragma once

#include <optional>

#include "core/render.h"
#include "filters/auto_plan.h"

namespace vecino {

struct Pilot {
    PilotFindings found;
    CostRates rates{};
    int reduction = 1;   ///< of its largest frames
    double spent_s = 0;  ///< but for building the scene
    double scene_s = 0;
};

/// What it may spend of a budget, as a share.
constexpr double kPilotShare = 0.06;

/// budget_s: of tracing and reconstruction; none: settings.spp by nominal rates, and no clock
/// decides.
Pilot run_pilot(const Scene& scene, const RenderSettings& settings, std::optional<double> budget_s,
                const Progress& progress);

struct PathTiming {
    double sample_s;
    double start_s;  ///< of a render, before its first
    double spent_s;
};

/// What a sample of path tracing takes, where it is expected to take guess_s: by about so many
/// seconds' work. A pilot's frames are too small to tell.
PathTiming time_path(const Scene& scene, const RenderSettings& settings, double guess_s,
                     double seconds);

/// Seconds that plain path tracing takes for settings.spp by nominal rates.
double nominal_budget_s(const Pilot& pilot, const RenderSettings& settings);

}  // namespace vecino
