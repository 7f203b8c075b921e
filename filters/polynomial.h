// SPDX-License-Identifier: Apache-2.0
//
// Polynomials in two coordinates, of order 0 to 2, fitted to samples of three channels by weighted
// least squares.
#pragma once

#include <array>
#include <glm/vec3.hpp>

namespace vecino {

constexpr int kMostTerms = 6;  ///< 1, u, v, u^2, u v, v^2: the first 1, 3 or 6 of them

constexpr int terms_of(int order) {
    return (order + 1) * (order + 2) / 2;
}

/// The terms at a place.
constexpr std::array<double, kMostTerms> terms_at(double u, double v) {
    return {1.0, u, v, u * u, u * v, v * v};
}

/// The normal equations of a fit. Lower orders are the leading part of those of order 2.
class NormalEquations {
  public:
    void add(double weight, double u, double v, const glm::dvec3& value) {
        const auto terms = terms_at(u, v);
        for (int i = 0; i < kMostTerms; ++i) {
            const double weighted = weight * terms[static_cast<std::size_t>(i)];
            for (int j = 0; j <= i; ++j)
                matrix_[i][j] += weighted * terms[static_cast<std::size_t>(j)];
            right_[i] += weighted * value;
        }
    }

    /// The coefficients of the first so many terms; the rest are 0. False where the samples do not
    /// tell them apart.
    bool solve(int terms, std::array<glm::dvec3, kMostTerms>& coefficients) const;

  private:
    double matrix_[kMostTerms][kMostTerms] = {};  ///< the lower triangle
    glm::dvec3 right_[kMostTerms] = {};
};

}  // namespace vecino
