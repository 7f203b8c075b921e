// SPDX-License-Identifier: Apache-2.0
//
// How path tracing converges: its error against samples and against time, a power law fitted to
// each, and how much sooner one way of sampling reaches an error than another.
//
// Errors are relMSE: linear in radiance, so that the error of a renderer without bias is its
// variance, and falls as 1 / spp with independent samples. Clipped and encoded display values do
// not. Times are those of tracing: nothing else of a render depends on how it samples.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/summary.h"

namespace vecino {

struct XY {
    double x = 0;
    double y = 0;
};

/// y = factor x^slope
struct PowerLaw {
    double slope = 0;
    double factor = 0;
    std::optional<double> slope_error;  ///< standard error, from the residuals; none below 3 points

    [[nodiscard]] double at(double x) const;
};

/// Least squares of log y on log x. Points that are not above 0 in both play no part. None below 2
/// different x.
std::optional<PowerLaw> fit_power_law(std::span<const XY> points);

struct ConvergencePoint {
    std::string group;
    int spp = 0;
    double trace_s = 0;              ///< median over seeds
    Estimate error;                  ///< relMSE over seeds; its mean is above 0
    std::optional<double> variance;  ///< over seeds, relative as relMSE is; none below 2 seeds
    std::optional<Estimate> psnr_float_db;
};

/// Time to reach an error.
struct TimeToError {
    double time_s = 0;
    bool is_extrapolated = false;  ///< beyond the last point, along the fitted law
};

struct SpeedUp {
    double factor = 0;
    bool is_extrapolated = false;  ///< of the baseline
};

/// The mean, over the logarithm of the error, of the logarithm of the speed-up, where both curves
/// are measured.
struct CommonSpeedUp {
    double factor = 0;
    double least_error = 0;
    double most_error = 0;
};

/// Path tracing of a scene that differs in spp alone.
struct ConvergenceCurve {
    std::string scene;
    std::string variant;                   ///< what tells it from the scene's others
    nlohmann::json params;                 ///< of its first point
    std::vector<ConvergencePoint> points;  ///< at least 2, by spp
    std::optional<PowerLaw> error_by_spp, variance_by_spp, error_by_time;
    double samples_per_s = 0;  ///< of the point that took longest
    std::size_t judged = 0;    ///< index of the point nearest to 64 spp
    bool is_baseline = false;  ///< the thesis's path tracing: light by chance, independent samples
    std::optional<SpeedUp> speed_up;  ///< over the baseline, at the judged point's error
    std::optional<CommonSpeedUp> common;
};

/// The time in which a curve reaches an error: between its points straight in logarithms; beyond
/// the last one along its law of error against spp, at the last one's rate. None before the first
/// point, and where errors do not fall.
std::optional<TimeToError> time_to_error(const ConvergenceCurve& curve, double error);

/// Of one curve over another at an error. None where either has no time, or where `of` would have
/// to be extrapolated.
std::optional<SpeedUp> speed_up(const ConvergenceCurve& of, const ConvergenceCurve& over,
                                double error);

/// None where the errors that both curves measured do not overlap.
std::optional<CommonSpeedUp> common_speed_up(const ConvergenceCurve& of,
                                             const ConvergenceCurve& over);

/// The curves of a run's path tracing, scene by scene, baselines first. Empty where no two groups
/// differ in spp alone.
std::vector<ConvergenceCurve> convergence(std::span<const GroupSummary> groups);

nlohmann::json convergence_json(std::span<const ConvergenceCurve> curves);

/// A table for a terminal; empty without curves.
std::string convergence_table(std::span<const ConvergenceCurve> curves);

/// relMSE in decibels: higher is better.
double error_in_db(double error);

/// "× 81.2": three digits, since more would be read as more than it is.
std::string factor_text(double factor);

/// "-1.02 +-0.03"; "-" without a fit.
std::string slope_text(const std::optional<PowerLaw>& law);

}  // namespace vecino
