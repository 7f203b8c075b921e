// SPDX-License-Identifier: Apache-2.0
//
// Tails and quantiles of the distributions that gates decide by.
#pragma once

namespace vecino {

/// I_x(a, b), the regularised incomplete beta function, to a relative 1e-12. Precondition: a, b > 0
/// and x in [0, 1].
double incomplete_beta(double x, double a, double b);

/// P(Z > z) of a standard normal Z.
double normal_tail(double z);

/// P(T > t) of Student's t. Precondition: degrees > 0, not necessarily whole.
double student_tail(double t, double degrees);

/// The t that Student's T exceeds with that probability. Precondition: degrees > 0, tail in (0,
/// 0.5].
double student_quantile(double tail, double degrees);

}  // namespace vecino
