// SPDX-License-Identifier: Apache-2.0
#include "filters/variation_rules.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace vecino {

double sample_difference(std::span<const glm::vec3> samples) {
    if (samples.size() < 2) return 0;
    const auto n = static_cast<double>(samples.size());
    double sum = 0;
    std::vector<float> values(samples.size());
    for (int c = 0; c < 3; ++c) {
        for (std::size_t i = 0; i < samples.size(); ++i) values[i] = samples[i][c];
        std::ranges::sort(values);
        // In order, a value is the larger one of i pairs and the smaller one of n - 1 - i.
        for (std::size_t i = 0; i < values.size(); ++i)
            sum += (2.0 * static_cast<double>(i) - n + 1.0) * static_cast<double>(values[i]);
    }
    return sum / 3 / (n * (n - 1) / 2);
}

double mean_change(std::span<const glm::vec3> samples) {
    if (samples.size() < 2) return 0;
    const auto n = static_cast<double>(samples.size());
    glm::dvec3 before(0.0);
    for (const glm::vec3& sample : samples.first(samples.size() - 1))
        before += glm::dvec3(sample) / (n - 1);
    const glm::dvec3 change = (glm::dvec3(samples.back()) - before) / n;
    return (std::abs(change.x) + std::abs(change.y) + std::abs(change.z)) / 3;
}

double standard_error(std::span<const glm::vec3> samples) {
    if (samples.size() < 2) return 0;
    const auto n = static_cast<double>(samples.size());
    glm::dvec3 mean(0.0), squares(0.0);
    for (const glm::vec3& sample : samples) mean += glm::dvec3(sample) / n;
    for (const glm::vec3& sample : samples) {
        const glm::dvec3 deviation = glm::dvec3(sample) - mean;
        squares += deviation * deviation;
    }
    double sum = 0;
    for (int c = 0; c < 3; ++c) sum += std::sqrt(squares[c] / (n - 1) / n);
    return sum / 3;
}

double student_quantile(int degrees_of_freedom) {
    constexpr std::array kQuantiles{3.182, 2.447, 2.262, 2.179, 2.131, 2.101, 2.080, 2.064, 2.052};
    const int index = std::clamp(degrees_of_freedom / 3, 1, static_cast<int>(kQuantiles.size()));
    return kQuantiles[static_cast<std::size_t>(index - 1)];
}

double neyman_gain(std::span<const double> variances) {
    double sum = 0, roots = 0;
    for (const double variance : variances) {
        sum += variance;
        roots += std::sqrt(variance);
    }
    return roots > 0 ? sum * static_cast<double>(variances.size()) / (roots * roots) : 1;
}

}  // namespace vecino
