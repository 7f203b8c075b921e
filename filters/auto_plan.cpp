// SPDX-License-Identifier: Apache-2.0
#include "filters/auto_plan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace vecino {
namespace {

// Cells are halved where surfaces meet: so many records for each that is there.
constexpr double kRefinedShare = 0.75;

// Of a typical scene, where the pilot was too short to tell.
constexpr double kTypicalNoise = 1.6e-5;  ///< by first 2, edge 32, records 64: 48 dB
constexpr double kTypicalBias = 1e-6;     ///< by cells of 8 pixels: 60 dB
constexpr SurfaceRecordsPlan kTypicalPlan{2, 32, 8, 0, 64, 64, 1.0, 0.15};

// Errors fall by samples of each kind to this power: Sobol points.
constexpr double kNoiseSlope = 0.65;
constexpr double kBiasPerLevel = 1.6;  ///< bias falls so much with a level

constexpr int kMostPackets = 1 << 16;
constexpr int kMostEdgeSpp = 65536;
constexpr int kMostPaths = 1 << 20;
constexpr double kHalfDecibel = 1.122;

double records_of(const PilotFindings& found, int cell) {
    if (!(found.records_at_8 > 0)) return 0;  // no light goes by way of them
    const double halvings = std::log2(8.0 / cell);
    const double cells = found.pixels / (static_cast<double>(cell) * cell);
    return std::max(
        {found.records_at_8 * std::pow(found.record_growth, halvings), cells * 0.5, 1.0});
}

/// A number of samples that 16 lanes fill; Sobol points want more than that only at the start.
int scaled(int value, double factor, int most) {
    if (value == 0) return 0;
    const double wanted = std::max(value * factor, 1.0);
    const double step = wanted >= 64 ? 16 : 1;
    return static_cast<int>(std::min(std::round(wanted / step) * step, static_cast<double>(most)));
}

SurfaceRecordsPlan scaled(SurfaceRecordsPlan plan, double factor) {
    plan.edge_spp = scaled(plan.edge_spp, factor, kMostEdgeSpp);
    plan.record_paths = scaled(plan.record_paths, factor, kMostPaths);
    plan.refined_record_paths = scaled(plan.refined_record_paths, factor, kMostPaths);
    return plan;
}

// Plans are scaled so far: first samples are not, and others in plenty do not make up for them.
constexpr double kLeastFactor = 1.0 / 16, kMostFactor = 4;

/// The largest factor that fits, to 1 %; less than least where none does.
double factor_that_fits(const PilotFindings& found, const CostRates& rates,
                        const SurfaceRecordsPlan& plan, double seconds) {
    double low = kLeastFactor, high = 1024;
    if (surface_records_cost(found, rates, scaled(plan, low)) > seconds) return 0;
    while (high > 1.01 * low) {
        const double middle = std::sqrt(low * high);
        const bool fits = surface_records_cost(found, rates, scaled(plan, middle)) <= seconds;
        (fits ? low : high) = middle;
    }
    return low;
}

/// Plans of the method itself, by growing budgets: their numbers of samples are scaled.
constexpr int kSteps[] = {2, 4, 8, 16, 32, 64, 128};

constexpr double CostRates::*kRates[] = {&CostRates::path_sample_s, &CostRates::first_sample_s,
                                         &CostRates::pixel_s,       &CostRates::edge_sample_s,
                                         &CostRates::record_path_s, &CostRates::record_s};

}  // namespace

CostRates nominal_rates(double rays_per_path) {
    constexpr double kRay_s = 8.5e-9;
    const double path_s = rays_per_path * kRay_s;
    return {path_s, 12.6e-9, 95e-9, 11e-9, 0.55 * path_s, 0.7e-6};
}

CostRates without_outliers(const CostRates& rates, const CostRates& nominal) {
    constexpr double kMostAbove = 4;
    CostRates out = rates;
    std::array<double, std::size(kRates)> slowness{};
    std::ranges::transform(kRates, slowness.begin(),
                           [&](auto rate) { return rates.*rate / nominal.*rate; });
    std::array<double, std::size(kRates)> sorted = slowness;
    std::ranges::sort(sorted);
    // Of an even number the lower middle: outliers lie above.
    const double most = kMostAbove * sorted[(sorted.size() - 1) / 2];
    for (std::size_t i = 0; most > 0 && i < sorted.size(); ++i)
        out.*kRates[i] = std::min(slowness[i], most) * nominal.*kRates[i];
    return out;
}

double surface_records_cost(const PilotFindings& found, const CostRates& rates,
                            const SurfaceRecordsPlan& plan) {
    const double base = records_of(found, plan.cell);
    const double refined = kRefinedShare * base * plan.levels;
    const double paths = base * (plan.record_paths + kRecordStart) +
                         refined * (plan.refined_record_paths + kRecordStart);
    const double edges = plan.edge_spp == 0 ? 0 : plan.edge_spp + kEdgeStart;
    return found.pixels * ((plan.pilot_spp + kPilotStart) * rates.first_sample_s + rates.pixel_s) +
           found.needy_pixels * edges * rates.edge_sample_s + paths * rates.record_path_s +
           (base + refined) * rates.record_s;
}

double surface_records_error(const PilotFindings& found, const SurfaceRecordsPlan& plan) {
    const RecordErrors from =
        found.records.value_or(RecordErrors{kTypicalPlan, kTypicalNoise, kTypicalBias, 0});
    const double edges = std::max(plan.edge_spp + plan.pilot_spp, 1);
    const double edges_then = std::max(from.plan.edge_spp + from.plan.pilot_spp, 1);
    const double samples = edges / edges_then * plan.record_paths / from.plan.record_paths;
    const double halvings = std::log2(8.0 / plan.cell);
    const double bias = from.bias_at_8 * std::pow(kBiasPerHalving, -halvings) *
                        std::pow(kBiasPerLevel, -plan.levels);
    return from.noise * std::pow(samples, -kNoiseSlope) + bias + from.unexplained;
}

Schedule plan_path(const PilotFindings& found, const CostRates& rates, double seconds) {
    const double packet_s = found.lanes * found.pixels * rates.path_sample_s;
    const double packets = std::clamp(std::floor(seconds / packet_s), 1.0, double{kMostPackets});
    Schedule schedule;
    schedule.spp = found.lanes * static_cast<int>(packets);
    schedule.predicted_s = packets * packet_s;
    if (found.path) {
        schedule.predicted_error =
            found.path->at_16_spp * std::pow(16.0 / schedule.spp, found.path->slope);
    }
    return schedule;
}

Schedule plan_surface_records(const PilotFindings& found, const CostRates& rates, double seconds) {
    Schedule best;
    best.is_path = false;
    best.plan = scaled(surface_records_plan(kSteps[0]), 0.25);
    best.predicted_error = std::numeric_limits<double>::infinity();
    for (const int step : kSteps) {
        const SurfaceRecordsPlan plan = surface_records_plan(step);
        const double factor = factor_that_fits(found, rates, plan, seconds);
        const bool is_last = step == std::end(kSteps)[-1];
        if (factor == 0 || (factor > kMostFactor && !is_last)) continue;
        const SurfaceRecordsPlan filled = scaled(plan, factor);
        const double error = surface_records_error(found, filled);
        if (error >= *best.predicted_error) continue;
        best.plan = filled;
        best.predicted_error = error;
    }
    if (std::isinf(*best.predicted_error))
        best.predicted_error = surface_records_error(found, best.plan);
    best.predicted_s = surface_records_cost(found, rates, best.plan);
    return best;
}

Plans choose_schedule(const PilotFindings& found, const CostRates& rates, double seconds) {
    Plans plans{plan_path(found, rates, seconds), std::nullopt, true, ""};
    if (!found.has_records_method) {
        plans.reason = "surface_records needs light sampling nee";
        return plans;
    }
    plans.records = plan_surface_records(found, rates, seconds);
    const Schedule& path = plans.path;
    const Schedule& records = *plans.records;
    const double at_most_s = std::max(1.1 * seconds, seconds + 0.02);
    const bool path_is_late = path.predicted_s > at_most_s;
    // Its least plan shows far more than one packet of paths.
    const double allowed_s = path_is_late ? 2 * path.predicted_s : at_most_s;
    if (records.predicted_s > std::max(allowed_s, at_most_s)) {
        plans.reason = "not even the least plan of surface_records fits";
    } else if (!path.predicted_error || path_is_late) {
        plans.takes_path = false;
        plans.reason = "no time to compare: the method that is best as a rule";
    } else if (*path.predicted_error <= kHalfDecibel * *records.predicted_error) {
        plans.reason = "no more than half a decibel is expected of surface_records";
    } else {
        plans.takes_path = false;
        plans.reason = "the least predicted error";
    }
    return plans;
}

}  // namespace vecino
