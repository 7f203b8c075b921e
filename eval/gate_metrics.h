// SPDX-License-Identifier: Apache-2.0
//
// The metrics that gates judge, whole or of a region ("edge.psnr_float_db"), all on one scale: the
// error that the metric stands for, in decibels. An error 0.1 dB larger is 0.1 dB worse, whichever
// metric it is of.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/json_read.h"
#include "eval/metrics.h"

namespace vecino {

struct GateMetric {
    std::string name;  ///< as a matrix has it
    const MetricInfo* info = nullptr;
    std::optional<Region> region;  ///< none: the whole image
};

/// Every metric of the whole image, then of every region.
std::vector<GateMetric> all_gate_metrics();

/// None if there is no such metric.
std::optional<GateMetric> find_gate_metric(const std::string& name);

/// The error behind a value, > 0: not below that of 100 dB, so that ratios stay finite.
double error_of_value(const MetricInfo& metric, double value);
double value_of_error(const MetricInfo& metric, double error);

/// Decibels per factor of ten of the error: 20 or 10.
double decibels_per_decade(const MetricInfo& metric);

/// Of "metrics" in a row of results.jsonl. A metric in dB that has no value because the images are
/// identical counts as 100 dB. None where nothing was measured: a region without pixels, SSIM of a
/// small image.
std::optional<double> error_in(const GateMetric& metric, const nlohmann::json& metrics);

/// A metric over seeds, in its own unit: errors are averaged, and the mean is turned back.
struct MetricSpread {
    double mean = 0;
    double deviation = 0;  ///< sample standard deviation over seeds; of metrics in dB, in dB
};

/// Precondition: not empty.
MetricSpread spread_over_seeds(const MetricInfo& metric, const std::vector<double>& errors);

/// Standard deviation of the error over its mean.
double relative_deviation(const MetricInfo& metric, const MetricSpread& spread);

}  // namespace vecino
