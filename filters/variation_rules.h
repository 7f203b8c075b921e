// SPDX-License-Identifier: Apache-2.0
//
// The statistics by which `variation` stops to sample.
#pragma once

#include <glm/vec3.hpp>
#include <span>

namespace vecino {

/// @name What the three readings of the thesis's rule measure of the samples of a pixel
/// The mean over R, G and B; 0 below 2 samples.
/// @{
double sample_difference(std::span<const glm::vec3> samples);  ///< mean |x_i - x_j| over pairs
double mean_change(std::span<const glm::vec3> samples);        ///< by the last sample
double standard_error(std::span<const glm::vec3> samples);     ///< of the mean
/// @}

/// Of Student's t, two-sided 95 %, for 3, 6, ... 27 degrees of freedom.
double student_quantile(int degrees_of_freedom);

/// What sampling in proportion to need could gain over the same number of samples everywhere: mean
/// of the variances over the squared mean of their roots; 1 where nothing varies.
double neyman_gain(std::span<const double> variances);

}  // namespace vecino
