// SPDX-License-Identifier: Apache-2.0
//
// Whether two renders are of the same expected image: tests of the hypothesis that they are, for
// unbiased renders that know their own variance. Each level of detail has its own tests, one per
// channel:
//   pixel   sees what is wrong in a few pixels
//   block   the mean over 16x16 pixels: sees a small bias of a part
//   image   the mean over all pixels: sees a smaller one everywhere
// A test is Welch's t: t = (a - b) / sqrt(va + vb) with the variances of both means, and
// Satterthwaite's degrees of freedom. Sidak's correction over tests and levels makes `level` the
// chance that renders of the same expectation fail at all, so far as means of samples are normal.
#pragma once

#include <glm/vec2.hpp>
#include <string_view>
#include <vector>

#include "core/frame.h"

namespace vecino {

/// A render and what it knows about its noise. Refers to planes that must outlive it.
struct NoisyImage {
    const Image& mean;
    const Image& variance;  ///< of the mean
    const Grid<float>& sample_count;
    /// Independent estimates that the variance comes from; 0: as many as samples.
    int streams = 0;
};

/// What one level of detail says: its worst test.
struct UnbiasedRule {
    std::string_view name;  ///< "pixel", "block" or "image"
    std::size_t tests = 0;
    double least_p = 1;      ///< two-sided
    double limit_p = 0;      ///< fails below
    glm::ivec2 where{0, 0};  ///< its first pixel
    int channel = 0;
    double difference = 0;      ///< of the means
    double standard_error = 0;  ///< of that

    [[nodiscard]] bool holds() const { return least_p >= limit_p; }
};

/// Levels in the order above. Throws Error(mismatch) when sizes differ. Precondition: all values
/// are finite, 0 < level < 1.
std::vector<UnbiasedRule> test_unbiased(const NoisyImage& a, const NoisyImage& b,
                                        double level = 0.01);

}  // namespace vecino
