// SPDX-License-Identifier: Apache-2.0
//
// From samples to pixel values. Samples are summed in blocks of 64, block by block in index order,
// so that the result does not depend on the packet width; sums of blocks are double, so that 10^6
// samples lose nothing.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "core/trace_task.h"

namespace vecino {

/// How the variance of the pixel mean is estimated.
enum class VarianceOf {
    nothing,
    samples,  ///< from the spread of independent samples
    streams,  ///< from the spread of the kStreams independently scrambled streams (Sobol)
};

class PixelAccumulator {
  public:
    explicit PixelAccumulator(VarianceOf variance_of) : variance_of_(variance_of) {}

    /// Adds the first count samples of a block. A sample that is not finite is dropped and counted.
    void add(SampleBlock& block, int count);

    [[nodiscard]] std::uint64_t samples() const;  ///< kept
    [[nodiscard]] std::uint64_t dropped() const { return dropped_; }
    [[nodiscard]] glm::vec3 emission() const { return mean(0); }
    [[nodiscard]] glm::vec3 direct() const { return mean(3); }
    [[nodiscard]] glm::vec3 indirect() const { return mean(6); }
    [[nodiscard]] glm::vec3 variance() const;  ///< of the pixel mean; 0 below 2 samples

  private:
    static constexpr int kParts = 9;  ///< emission, direct, indirect times R, G, B

    [[nodiscard]] glm::vec3 mean(std::size_t first_part) const;
    [[nodiscard]] double stream_variance(int channel) const;
    void add_carefully(SampleBlock& block, int count);
    void add_spread(const SampleBlock& block, int count);

    VarianceOf variance_of_;
    std::array<std::array<double, kStreams>, kParts> sums_{};
    std::array<std::uint64_t, kStreams> counts_{};
    std::uint64_t dropped_ = 0;
    // Welford's mean and sum of squared deviations, merged block-wise (Chan et al. 1983).
    std::array<double, 3> running_mean_{};
    std::array<double, 3> squared_deviations_{};
    std::uint64_t spread_count_ = 0;
};

}  // namespace vecino
