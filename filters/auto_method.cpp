// SPDX-License-Identifier: Apache-2.0
//
// The method auto: a pilot, a schedule, and a run of another method by that schedule.
#include <cmath>
#include <string>

#include "core/timing.h"
#include "filters/auto_pilot.h"
#include "filters/auto_plan.h"
#include "filters/method_rows.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

/// Null for what is not known, and where there is no error at all.
Json decibels(const std::optional<double>& error) {
    if (!error || !(*error > 0) || !std::isfinite(*error)) return nullptr;
    return -10 * std::log10(*error);
}

void give_plan(const SurfaceRecordsPlan& plan, SurfaceRecordsOptions& options) {
    options.pilot_spp = plan.pilot_spp;
    options.edge_spp = plan.edge_spp;
    options.cell = plan.cell;
    options.levels = plan.levels;
    options.record_paths = plan.record_paths;
    options.refined_record_paths = plan.refined_record_paths;
    options.fit_sigma = plan.fit_sigma;
    options.refine_tau = plan.refine_tau;
}

/// What runs: the request itself, with a method and numbers of its own.
struct Chosen {
    const Method& method;
    MethodRequest request;
};

Chosen chosen_run(const MethodRequest& request, const Schedule& schedule) {
    Chosen run{find_method(schedule.is_path ? "path" : "surface_records"), request};
    if (schedule.is_path) {
        run.request.settings.spp = schedule.spp;
    } else {
        give_plan(schedule.plan, run.request.parameters.surface_records);
    }
    return run;
}

/// A part of a command line that gives the same bits.
std::string schedule_text(const Chosen& run) {
    std::string text = "--method " + std::string(run.method.name);
    if (run.method.options.empty()) text += " --spp " + std::to_string(run.request.settings.spp);
    for (const MethodOption& row : method_options()) {
        if (run.method.reads(row.name))
            text += " " + std::string(row.flag) + " " + row.get(run.request.parameters).dump();
    }
    return text;
}

Json facts_of(const Plans& plans, const Pilot& pilot, const Chosen& run) {
    const Schedule& chosen = plans.chosen();
    Json predicted{{"path", decibels(plans.path.predicted_error)}};
    if (plans.records) predicted["surface_records"] = decibels(plans.records->predicted_error);
    return {{"chosen", run.method.name},
            {"reason", plans.reason},
            {"schedule", schedule_text(run)},
            {"predicted_psnr_float_db", decibels(chosen.predicted_error)},
            {"predicted_by_method", predicted},
            {"pilot_reduction", pilot.reduction},
            {"pilot_compares", pilot.found.path.has_value()}};
}

}  // namespace

MethodRender run_auto(const MethodRequest& request, const Progress& progress) {
    const std::optional<double> budget_s = request.parameters.planner.time_budget_s;
    const Pilot pilot = run_pilot(request.scene, request.settings, budget_s, progress);
    const double left_s = budget_s ? *budget_s - pilot.spent_s
                                   : (1 - kPilotShare) * nominal_budget_s(pilot, request.settings);
    const Plans plans = choose_schedule(pilot.found, pilot.rates, left_s);
    const Chosen run = chosen_run(request, plans.chosen());
    MethodRender out = run.method.run(run.request, progress);
    RenderStatistics& statistics = out.render.statistics;
    const double run_s = statistics.trace_s + out.reconstruct_s;
    statistics.scene_s += pilot.scene_s;
    statistics.trace_s += pilot.spent_s;
    out.facts.update(facts_of(plans, pilot, run));
    out.stage_s["auto_pilot"] = pilot.spent_s;
    out.stage_s["auto_run"] = run_s;
    out.stage_s["auto_predicted"] = plans.chosen().predicted_s;
    return out;
}

}  // namespace vecino
