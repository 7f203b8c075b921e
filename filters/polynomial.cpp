// SPDX-License-Identifier: Apache-2.0
#include "filters/polynomial.h"

#include <cmath>

namespace vecino {

bool NormalEquations::solve(int terms, std::array<glm::dvec3, kMostTerms>& coefficients) const {
    // What is left of a diagonal element once the terms before it are taken off. Measured against
    // the element itself, so that the scales of u and v do not matter.
    constexpr double kLeastPivot = 1e-4;
    double l[kMostTerms][kMostTerms];
    glm::dvec3 x[kMostTerms];
    for (int i = 0; i < terms; ++i) {
        for (int j = 0; j <= i; ++j) {
            double sum = matrix_[i][j];
            for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
            if (j < i) {
                l[i][j] = sum / l[j][j];
                continue;
            }
            if (!(sum > kLeastPivot * matrix_[i][i])) return false;
            l[i][i] = std::sqrt(sum);
        }
    }
    for (int i = 0; i < terms; ++i) {
        x[i] = right_[i];
        for (int k = 0; k < i; ++k) x[i] -= l[i][k] * x[k];
        x[i] /= l[i][i];
    }
    for (int i = terms - 1; i >= 0; --i) {
        for (int k = i + 1; k < terms; ++k) x[i] -= l[k][i] * x[k];
        x[i] /= l[i][i];
    }
    coefficients.fill(glm::dvec3(0.0));
    for (int i = 0; i < terms; ++i) coefficients[static_cast<std::size_t>(i)] = x[i];
    return true;
}

}  // namespace vecino
