// SPDX-License-Identifier: Apache-2.0
#include "eval/gate_metrics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

constexpr double kMostDecibels = 100;
constexpr std::string_view kOfWholeImages = "worst_tile_psnr_db";
constexpr double kDecibelsPerUnit = 10 / std::numbers::ln10;  // of a small relative change

}  // namespace

std::vector<GateMetric> all_gate_metrics() {
    std::vector<GateMetric> all;
    for (const MetricInfo& info : all_metrics())
        all.push_back({std::string(info.name), &info, std::nullopt});
    for (const RegionInfo& region : kRegions) {
        for (const MetricInfo& info : all_metrics()) {
            if (info.name == kOfWholeImages) continue;
            all.push_back(
                {std::string(region.name) + "." + std::string(info.name), &info, region.region});
        }
    }
    return all;
}

std::optional<GateMetric> find_gate_metric(const std::string& name) {
    for (GateMetric& metric : all_gate_metrics()) {
        if (metric.name == name) return std::move(metric);
    }
    return std::nullopt;
}

double decibels_per_decade(const MetricInfo& metric) {
    return metric.scale == ErrorScale::amplitude ? 20 : 10;
}

double error_of_value(const MetricInfo& metric, double value) {
    double error = value;
    if (metric.scale == ErrorScale::decibel) error = std::pow(10.0, -0.1 * value);
    if (metric.scale == ErrorScale::similarity) error = 1 - value;
    return std::max(error, std::pow(10.0, -kMostDecibels / decibels_per_decade(metric)));
}

double value_of_error(const MetricInfo& metric, double error) {
    if (metric.scale == ErrorScale::decibel) return -10 * std::log10(error);
    return metric.scale == ErrorScale::similarity ? 1 - error : error;
}

std::optional<double> error_in(const GateMetric& metric, const Json& metrics) {
    const Json* part = &metrics;
    if (metric.region) {
        const std::string region(kRegions[region_index(*metric.region)].name);
        if (!metrics.contains("regions") || !metrics["regions"].contains(region))
            return std::nullopt;
        part = &metrics["regions"][region];
        if (part->value("pixels", Json()) == 0) return std::nullopt;
    }
    const auto found = part->find(metric.info->name);
    if (found == part->end()) return std::nullopt;
    if (found->is_number()) return error_of_value(*metric.info, found->get<double>());
    const bool is_identical = found->is_null() && metric.info->scale == ErrorScale::decibel;
    if (!is_identical) return std::nullopt;
    return error_of_value(*metric.info, kMostDecibels);
}

MetricSpread spread_over_seeds(const MetricInfo& metric, const std::vector<double>& errors) {
    const auto n = static_cast<double>(errors.size());
    double mean = 0;
    for (const double error : errors) mean += error / n;
    double squares = 0;
    for (const double error : errors) squares += (error - mean) * (error - mean);
    const double deviation = errors.size() < 2 ? 0 : std::sqrt(squares / (n - 1));
    const double unit = metric.scale == ErrorScale::decibel ? kDecibelsPerUnit / mean : 1;
    return {value_of_error(metric, mean), deviation * unit};
}

double relative_deviation(const MetricInfo& metric, const MetricSpread& spread) {
    if (metric.scale == ErrorScale::decibel) return spread.deviation / kDecibelsPerUnit;
    return spread.deviation / error_of_value(metric, spread.mean);
}

}  // namespace vecino
