// SPDX-License-Identifier: Apache-2.0
//
// From samples to pixel values. Samples are summed in blocks of 64 in index order, so that the
// result does not depend on the packet width; sums of blocks are exact, so that 10^6 samples lose
// nothing and that it does not matter which blocks were summed first, or where.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <string>
#include <vector>

#include "core/exact_sum.h"
#include "core/trace_task.h"

namespace vecino {

/// How the variance of the pixel mean is estimated.
enum class VarianceOf {
    nothing,
    samples,  ///< from the spread of independent samples within each block
    streams,  ///< from the spread of the kStreams independently scrambled streams (Sobol)
};

/// The sums that a pixel's values follow from, by name; they differ with how variance is estimated.
/// Emission, direct, indirect times R, G, B come first, then counts, then what variance needs.
std::vector<std::string> sum_names(VarianceOf variance_of);

/// The same number without the names.
constexpr std::size_t sum_count(VarianceOf variance_of) {
    constexpr std::size_t kParts = 9;
    if (variance_of == VarianceOf::samples) return kParts + 1 + 3 + 1;
    if (variance_of == VarianceOf::streams) return kParts + kStreams + 3 * kStreams;
    return kParts + 1;
}

constexpr std::size_t kMostSums = sum_count(VarianceOf::streams);

/// What planes hold of a pixel's samples.
struct PixelValues {
    glm::vec3 emission{0.0f}, direct{0.0f}, indirect{0.0f};
    glm::vec3 variance{0.0f};   ///< of the pixel mean; 0 below 2 samples
    std::uint64_t samples = 0;  ///< kept

    [[nodiscard]] glm::vec3 radiance() const { return emission + direct + indirect; }
};

/// The one way from sums, in the order of sum_names(), to values. Sums beyond sum_count() may
/// follow.
PixelValues pixel_values(std::span<const ExactSum::Digits> sums, VarianceOf variance_of);

class PixelAccumulator {
  public:
    explicit PixelAccumulator(VarianceOf variance_of) : variance_of_(variance_of) {}

    /// Adds the first count samples of a block. A sample that is not finite is dropped and counted.
    void add(SampleBlock& block, int count);

    /// As if nothing had been added yet.
    void clear();

    /// Writes the sums, in the order of sum_names(). Precondition: out has sum_count() entries.
    void sums(std::span<ExactSum::Digits> out) const;

    [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

  private:
    static constexpr std::size_t kParts = 9;  ///< emission, direct, indirect times R, G, B

    [[nodiscard]] std::uint64_t samples() const;
    void add_carefully(SampleBlock& block, int count);
    void add_squares(const SampleBlock& block, int count, std::uint64_t kept);

    VarianceOf variance_of_;
    std::array<ExactSum, kParts> parts_;
    std::array<std::uint64_t, kStreams> counts_{};
    std::uint64_t dropped_ = 0;
    // Of samples: squared deviations from the mean of their block, and degrees of freedom.
    // Deviations from the mean of all samples would be known only after the last block.
    std::array<ExactSum, 3> squares_;
    std::uint64_t freedom_ = 0;
    std::array<std::array<ExactSum, 3>, kStreams> streams_;  ///< radiance of each
};

}  // namespace vecino
