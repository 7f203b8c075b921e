// SPDX-License-Identifier: Apache-2.0
//
// Means over seeds with their uncertainty.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace vecino {

/// A mean with its 95 % confidence interval (Student's t); without an interval below 2 values.
struct Estimate {
    double mean = 0;
    std::optional<double> low, high;
};

/// Precondition: not empty, all finite.
Estimate estimate(const std::vector<double>& values);

/// Of values in decibels, -10 log10 of the mean squared errors that they stand for: averaged as
/// those errors, then turned back. `high` is none where the errors' interval reaches 0 or below.
/// Precondition: not empty, all finite.
Estimate estimate_db(const std::vector<double>& values_db);

/// Two-sided 95 % quantile of Student's t (12.706, 4.303, ... 1.960), to 1e-3. Precondition: at
/// least 1 degree of freedom.
double student95(std::size_t degrees);

}  // namespace vecino
