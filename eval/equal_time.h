// SPDX-License-Identifier: Apache-2.0
//
// The budget "equal_time": as many samples as take path tracing's time. Measured on this machine
// before the first frame and kept in the run directory (equal_time.json), so that all seeds and a
// resumed run use the same.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "core/scene.h"
#include "eval/matrix.h"

namespace vecino {

class EqualTimeBudgets {
  public:
    /// Reads the file if it is there.
    explicit EqualTimeBudgets(std::string path);

    /// Of the cell's group, if it was measured for the same question.
    [[nodiscard]] std::optional<int> spp(const Cell& cell) const;
    /// The same, measured in this state of program and scene file too.
    [[nodiscard]] std::optional<int> spp(const Cell& cell, const std::string& state) const;
    /// Of any group for which the same was measured in this state: of one that differs in its
    /// weights alone.
    [[nodiscard]] std::optional<int> spp_like(const Cell& cell, const std::string& state) const;
    /// Keeps it, in the file.
    void put(const Cell& cell, const std::string& state, int spp);

  private:
    std::string path_;
    nlohmann::json entries_ = nlohmann::json::object();
};

/// How many samples per pixel to time, where asked_spp are wanted in the end: as many as fill whole
/// packets and take about 0.3 s by seconds_of, or asked_spp where that is few.
int calibration_spp(int asked_spp, const std::function<double(int spp)>& seconds_of);

struct EqualTimes {
    double path_s;         ///< path tracing with all its samples
    double low_s_per_spp;  ///< the low-resolution frame, for one sample per pixel
    double reconstruct_s;  ///< its reconstruction
};

/// Samples per low-resolution pixel with which frame and reconstruction take path tracing's time.
/// At least 1, also where the reconstruction alone takes longer.
int equal_time_spp(const EqualTimes& times);

/// Measures path tracing and the cell's own frame in turn, in renders of a fraction of a second,
/// and its reconstruction; from their rates follows how many samples per low-resolution pixel take
/// as long as path tracing with cell.spp_asked. Precondition: the cell is a scheme's.
int measure_equal_time_spp(const Scene& scene, const Cell& cell);

}  // namespace vecino
