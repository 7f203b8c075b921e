// SPDX-License-Identifier: Apache-2.0
//
// The method auto: a pilot, a schedule, and a run of another method by that schedule.
#include <cmath>
#include <string>
#include <utility>

#include "core/parallel.h"
#include "filters/auto_pilot.h"
#include "filters/auto_plan.h"
#include "filters/method_rows.h"
#include "filters/pace.h"

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
    options.fit_order = plan.fit_order;
    options.edge_light = plan.edge_light;
}

/// What ran: the request itself, with a method and numbers of its own.
struct Chosen {
    const Method& method;
    MethodRequest request;
};

/// A part of a command line that gives the same bits.
std::string schedule_text(const Chosen& run) {
    std::string text = "--method " + std::string(run.method.name);
    if (run.method.options.empty()) text += " --spp " + std::to_string(run.request.settings.spp);
    for (const MethodOption& row : method_options()) {
        if (!run.method.reads(row.name)) continue;
        const Json value = row.get(run.request.parameters);
        text += " " + std::string(row.flag) + " " +
                (value.is_string() ? value.get<std::string>() : value.dump());
    }
    return text;
}

/// What has to be known to say what was done.
struct Decision {
    const Pilot& pilot;
    Plans plans;
};

Json facts_of(const Decision& decision, const Chosen& run) {
    const Plans& plans = decision.plans;
    Json predicted{{"path", decibels(plans.path.predicted_error)}};
    if (plans.records) predicted["surface_records"] = decibels(plans.records->predicted_error);
    return {{"chosen", run.method.name},
            {"reason", plans.reason},
            {"schedule", schedule_text(run)},
            {"predicted_psnr_float_db", decibels(plans.chosen().predicted_error)},
            {"predicted_by_method", predicted},
            {"pilot_reduction", decision.pilot.reduction},
            {"pilot_compares", decision.pilot.found.path.has_value()}};
}

/// Spends a little of the time to find out how many samples the rest has room for. Returns it.
double time_path(const MethodRequest& request, double seconds, Decision& decision) {
    constexpr double kShare = 0.04;
    constexpr int kManyPackets = 8;  // fewer are known well enough
    const PilotFindings& found = decision.pilot.found;
    if (decision.plans.path.spp < kManyPackets * found.lanes) return 0;
    CostRates rates = decision.pilot.rates;
    const PathTiming timing =
        time_path(request.scene, request.settings, rates.path_sample_s, kShare * seconds);
    rates.path_sample_s = timing.sample_s;
    decision.plans.path = plan_path(found, rates, seconds - timing.spent_s - timing.start_s);
    return timing.spent_s;
}

/// seconds: that are left, if a clock decides.
MethodRender run_path(const MethodRequest& request, Decision& decision,
                      std::optional<double> seconds, const Progress& progress) {
    const double timed_s = seconds ? time_path(request, *seconds, decision) : 0.0;
    Chosen run{find_method("path"), request};
    run.request.settings.spp = decision.plans.path.spp;
    MethodRender out = run.method.run(run.request, progress);
    out.render.statistics.trace_s += timed_s;
    out.facts.update(facts_of(decision, run));
    return out;
}

/// With a pace the plan that was chosen is where it starts from, and what it ends with is what
/// facts say.
MethodRender run_records(const MethodRequest& request, Decision& decision, Pace* pace,
                         const Progress& progress) {
    Schedule& schedule = *decision.plans.records;
    const SurfaceRecordsPlan plan = pace != nullptr ? Pace::first_plan() : schedule.plan;
    StagedRender staged = render_in_stages(request.scene, request.settings, {plan, pace}, progress);
    schedule.plan = staged.plan;
    schedule.predicted_error =
        staged.expected_error.value_or(surface_records_error(decision.pilot.found, staged.plan));
    Chosen run{find_method("surface_records"), request};
    give_plan(staged.plan, run.request.parameters.surface_records);
    MethodRender out = method_render(std::move(staged));
    out.facts.update(facts_of(decision, run));
    return out;
}

}  // namespace

MethodRender run_auto(const MethodRequest& request, const Progress& progress) {
    const std::optional<double> budget_s = request.parameters.planner.time_budget_s;
    const Pilot pilot = run_pilot(request.scene, request.settings, budget_s, progress);
    const double left_s = budget_s ? *budget_s - pilot.spent_s
                                   : (1 - kPilotShare) * nominal_budget_s(pilot, request.settings);
    Decision decision{pilot, choose_schedule(pilot.found, pilot.rates, left_s)};
    const int threads = request.settings.threads;
    Pace pace(left_s, threads > 0 ? threads : default_thread_count(), pilot.found);
    const auto path_s = budget_s ? std::optional(left_s) : std::nullopt;
    MethodRender out = decision.plans.takes_path
                           ? run_path(request, decision, path_s, progress)
                           : run_records(request, decision, budget_s ? &pace : nullptr, progress);
    RenderStatistics& statistics = out.render.statistics;
    const double run_s = statistics.trace_s + out.reconstruct_s;
    statistics.scene_s += pilot.scene_s;
    statistics.trace_s += pilot.spent_s;
    out.stage_s["auto_pilot"] = pilot.spent_s;
    out.stage_s["auto_run"] = run_s;
    out.stage_s["auto_predicted"] =
        budget_s && !decision.plans.takes_path ? left_s : decision.plans.chosen().predicted_s;
    return out;
}

}  // namespace vecino
