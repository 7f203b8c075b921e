// SPDX-License-Identifier: Apache-2.0
#include "filters/auto_plan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>

namespace vecino {
namespace {

// Bias falls so much with the first level of large cells, and with any other.
constexpr double kBiasOfFirstLevel = 3.5, kBiasPerLevel = 1.6;

constexpr int kMostPackets = 1 << 16;
constexpr int kMostEdgeSpp = 65536;
constexpr int kMostPaths = 1 << 20;
// What small frames tell of surface_records is too bad as a rule: there is less room in them for
// cells and fits. By so much, 2 dB, path tracing has to be better.
constexpr double kRoom = 1.6;

double records_of(const PilotFindings& found, int cell) {
    if (!(found.records_at_8 > 0)) return 0;  // no light goes by way of them
    const double halvings = std::log2(8.0 / cell);
    const double cells = found.pixels / (static_cast<double>(cell) * cell);
    return std::max(
        {found.records_at_8 * std::pow(found.record_growth, halvings), cells * 0.5, 1.0});
}

/// Samples in whole packets, where there are several.
int in_packets(double samples, int most) {
    const double step = samples >= 64 ? 16 : 1;
    return static_cast<int>(
        std::clamp(std::round(samples / step) * step, 1.0, static_cast<double>(most)));
}

/// What is chosen among: sides of cells, levels, and paths of a record for each edge sample.
struct Structure {
    int cell, levels;
    double fit_sigma, refine_tau;
};
constexpr Structure kStructures[] = {{16, 0, 1.0, 0.15}, {12, 0, 0.85, 0.15}, {8, 0, 0.85, 0.15},
                                     {8, 1, 0.85, 0.15}, {8, 2, 0.85, 0.15},  {4, 1, 1.0, 0.15},
                                     {4, 2, 1.0, 0.2}};
constexpr double kPathsPerSample[] = {1, 2, 4, 8, 16, 32};

// Records of fewer paths are not worth their place.
constexpr int kFewestPaths = 16, kFewestEdgeSpp = 2;

SurfaceRecordsPlan plan_by(const Structure& structure, double edge_spp, double paths) {
    // First samples find what the others are for: the more of these, the more of them.
    const double pilot = std::clamp(edge_spp / 16, 1.0, 32.0);
    const int record_paths = in_packets(std::max(paths, double{kFewestPaths}), kMostPaths);
    SurfaceRecordsPlan plan;
    plan.pilot_spp = static_cast<int>(std::bit_floor(static_cast<unsigned>(pilot)));
    plan.edge_spp = in_packets(edge_spp, kMostEdgeSpp);
    plan.cell = structure.cell;
    plan.levels = structure.levels;
    plan.record_paths = record_paths;
    // Fewer leave more noise than they save.
    constexpr double kOfRefined = 0.7;
    plan.refined_record_paths =
        in_packets(std::max(kOfRefined * record_paths, double{kFewestPaths}), kMostPaths);
    plan.fit_sigma = structure.fit_sigma;
    plan.refine_tau = structure.refine_tau;
    return plan;
}

/// The most samples that fit; the least there are where none do.
SurfaceRecordsPlan filled(const PilotFindings& found, const CostRates& rates,
                          const std::function<SurfaceRecordsPlan(double)>& plan_of,
                          double seconds) {
    double low = kFewestEdgeSpp, high = kMostEdgeSpp;
    while (high > 1.01 * low) {
        const double middle = std::sqrt(low * high);
        (surface_records_cost(found, rates, plan_of(middle)) <= seconds ? low : high) = middle;
    }
    return plan_of(low);
}

/// Of cells so large, those that are halved; measured on the scenes of this repository.
double halved_share(int cell) {
    constexpr double kPerPixel = 0.05, kMost = 0.6;
    return std::min(kPerPixel * cell, kMost);
}

/// Of a needy pixel, in samples.
double usual_edge_work(int edge_spp) {
    // With few samples they go to the neediest, so many at least to each.
    constexpr int kFewest = 4;
    const double sampled = std::min(1.0 * edge_spp / kFewest, 1.0);
    return sampled * further_work(static_cast<std::uint32_t>(std::max(edge_spp, kFewest)), 0) +
           kSmoothingWork;
}

/// Between two points of a curve, in powers; beyond the last as samples go.
EdgePoint point_at(const EdgeCurve& curve, double edge_spp) {
    const EdgePoint& last = curve.back();
    if (edge_spp >= last.edge_spp) {
        const double times = edge_spp / last.edge_spp;
        return {edge_spp, last.work * times, last.error * std::pow(times, -kEdgeSlope)};
    }
    if (edge_spp <= curve.front().edge_spp) return curve.front();
    const auto next = std::ranges::upper_bound(curve, edge_spp, {}, &EdgePoint::edge_spp);
    const EdgePoint &low = *(next - 1), &high = *next;
    const double part = std::log(edge_spp / low.edge_spp) / std::log(high.edge_spp / low.edge_spp);
    const auto between = [part](double a, double b) {
        return a > 0 && b > 0 ? a * std::pow(b / a, part) : a + part * (b - a);
    };
    return {edge_spp, between(low.work, high.work), between(low.error, high.error)};
}

/// What is left after many samples is noise of edges and half-shadow, where Sobol points gain less
/// than on plain surfaces. On scenes/failures the mean slope is 1.25 from 16 to 64 samples, and 1.1
/// from 256 to 1024.
double path_error(const PathErrors& found, double spp) {
    constexpr double kPlain_spp = 64;
    const double plain = std::min(spp, kPlain_spp);
    return found.at_16_spp * std::pow(16 / plain, found.slope) *
           std::pow(plain / spp, 1 + 0.5 * (found.slope - 1));
}

}  // namespace

CostRates nominal_rates(double rays_per_path) {
    constexpr double kRay_s = 8.5e-9;
    const double path_s = rays_per_path * kRay_s;
    return {path_s, 12.6e-9, 95e-9, 11e-9, 0.55 * path_s, 0.7e-6};
}

CostRates slower(const CostRates& rates, double times) {
    return {rates.path_sample_s * times, rates.first_sample_s * times, rates.pixel_s * times,
            rates.edge_sample_s * times, rates.record_path_s * times,  rates.record_s * times};
}

double bias_share(double cell) {
    constexpr double kPerHalving = 4.5, kPerDoubling = 8;
    return std::pow(cell > 8 ? kPerDoubling : kPerHalving, std::log2(cell / 8));
}

double refined_share(const SurfaceRecordsPlan& plan, double growth) {
    double share = 0, all = 1;
    for (int level = 0; level < plan.levels; ++level) {
        all *= growth;
        share += all * halved_share(std::max(plan.cell >> level, 1));
    }
    return share;
}

double surface_records_cost(const PilotFindings& found, const CostRates& rates,
                            const SurfaceRecordsPlan& plan) {
    const double base = records_of(found, plan.cell);
    const double refined = base * refined_share(plan, found.record_growth);
    const double paths = base * (plan.record_paths + kRecordStart) +
                         refined * (plan.refined_record_paths + kRecordStart);
    const double edges = found.edges.empty() ? usual_edge_work(plan.edge_spp)
                                             : point_at(found.edges, plan.edge_spp).work;
    return found.pixels * ((plan.pilot_spp + kPilotStart) * rates.first_sample_s + rates.pixel_s) +
           found.needy_pixels * edges * rates.edge_sample_s + paths * rates.record_path_s +
           (base + refined) * rates.record_s;
}

double edge_noise_share(const SurfaceRecordsPlan& plan) {
    const double samples = std::max(plan.edge_spp + plan.pilot_spp, 1);
    return std::pow(kComparedEdgeSpp / samples, kEdgeSlope);
}

double record_noise_share(const SurfaceRecordsPlan& plan) {
    const auto share = [](int paths) { return std::pow(512.0 / paths, kRecordSlope); };
    const double refined = plan.levels > 0 ? halved_share(plan.cell) : 0;
    return (1 - refined) * share(plan.record_paths) + refined * share(plan.refined_record_paths);
}

double surface_records_error(const PilotFindings& found, const SurfaceRecordsPlan& plan) {
    const RecordErrors from = found.records.value_or(kUsualErrors);
    const double first_level = plan.cell >= 8 ? kBiasOfFirstLevel : kBiasPerLevel;
    const double levels =
        plan.levels > 0 ? first_level * std::pow(kBiasPerLevel, plan.levels - 1) : 1;
    const double bias = from.bias_at_8 * bias_share(plan.cell) / levels;
    const double edges = found.edges.empty() ? from.edge_noise * edge_noise_share(plan)
                                             : point_at(found.edges, plan.edge_spp).error;
    return edges + from.record_noise * record_noise_share(plan) + bias + from.unexplained;
}

Schedule plan_path(const PilotFindings& found, const CostRates& rates, double seconds) {
    const double packet_s = found.lanes * found.pixels * rates.path_sample_s;
    const double packets = std::clamp(std::floor(seconds / packet_s), 1.0, double{kMostPackets});
    Schedule schedule;
    schedule.spp = found.lanes * static_cast<int>(packets);
    schedule.predicted_s = packets * packet_s;
    if (found.path) {
        schedule.predicted_error = path_error(*found.path, schedule.spp);
    }
    return schedule;
}

Schedule plan_surface_records(const PilotFindings& found, const CostRates& rates, double seconds) {
    Schedule best;
    best.is_path = false;
    const auto consider = [&](const SurfaceRecordsPlan& plan) {
        const double cost_s = surface_records_cost(found, rates, plan);
        const double error = surface_records_error(found, plan);
        const bool is_first = !best.predicted_error.has_value();
        if (!is_first && (cost_s > seconds || error >= *best.predicted_error)) return;
        best.plan = plan;
        best.predicted_s = cost_s;
        best.predicted_error = error;
    };
    for (const Structure& structure : kStructures) {
        for (const double ratio : kPathsPerSample) {
            const auto plan_of = [&](double edge_spp) {
                return plan_by(structure, edge_spp, ratio * edge_spp);
            };
            consider(filled(found, rates, plan_of, seconds));
        }
    }
    return best;
}

bool is_beyond_sight(const Schedule& path) {
    constexpr double kLeastError = 6.3e-8;
    return path.predicted_error && *path.predicted_error <= kLeastError;
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
    if (is_beyond_sight(path) && !path_is_late) {
        plans.reason = "path tracing alone leaves nothing that could be seen";
    } else if (records.predicted_s > std::max(allowed_s, at_most_s)) {
        plans.reason = "not even the least plan of surface_records fits";
    } else if (!path.predicted_error || path_is_late) {
        plans.takes_path = false;
        plans.reason = "no time to compare: the method that is best as a rule";
    } else if (kRoom * *path.predicted_error <= *records.predicted_error) {
        plans.reason = "it is expected to be 2 dB better than surface_records";
    } else {
        plans.takes_path = false;
        plans.reason = "the least predicted error";
    }
    return plans;
}

}  // namespace vecino
