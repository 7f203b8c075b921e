// SPDX-License-Identifier: Apache-2.0
//
// Timings that can be compared: all in turn, round after round.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/render.h"
#include "eval/bench.h"

namespace vecino {

/// Seconds of one run of work, which is repeated for at least 10 ms so that the clock's grain and
/// what a call costs do not matter.
double seconds_per_run(const std::function<void()>& work);

/// The same of the calling thread's own time, for work that starts no other: a busy machine hardly
/// changes it.
double thread_seconds_per_run(const std::function<void()>& work);

class RoundRobin {
  public:
    /// What to time; measure returns seconds. Returns its number.
    std::size_t add(std::function<double()> measure);

    /// One round to warm up, then those that count. Throws Error(interrupted) when progress says
    /// so.
    void run(int rounds, const Progress& progress);

    [[nodiscard]] Measured time(std::size_t unit) const;  ///< seconds
    /// Work per second.
    [[nodiscard]] Measured rate(std::size_t unit, double work) const;
    /// Of one unit's time over another's.
    [[nodiscard]] Measured ratio(std::size_t unit, std::size_t over) const;

  private:
    std::vector<std::function<double()>> measures_;
    std::vector<std::vector<double>> seconds_;  ///< by unit and round
};

}  // namespace vecino
