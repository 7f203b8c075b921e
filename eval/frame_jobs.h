// SPDX-License-Identifier: Apache-2.0
//
// The work of a run, by the frame that cells read: each is traced once and shared.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/matrix.h"
#include "eval/run_plan.h"

namespace vecino {

/// A frame and the cells that read it; or cells that need none: ceilings, which need their
/// reference alone, and images from elsewhere.
struct FrameJob {
    std::vector<const Cell*> cells;
    RenderSettings settings;
    bool traces = true;

    [[nodiscard]] double samples() const;  ///< to trace
};

/// What is to do, by frame, scene by scene in the order of the cells, seeds in turn. A frame has
/// the planes that some scheme reads, and no other.
std::vector<FrameJob> frame_jobs(const std::vector<PlannedCell>& plan);

/// A job's first cell with the job's settings, then, where the matrix asks for it, as each moved
/// camera sees it.
std::vector<Cell> views_of(const FrameJob& job, const Matrix& matrix);

struct PlannedRender {
    std::string scene;  ///< its file
    RenderSettings settings;
};

/// All that jobs trace: frames, and each reference once.
std::vector<PlannedRender> renders_of(const std::vector<FrameJob>& jobs, const Matrix& matrix);

/// The frame of a cell's settings, by its method.
MethodRender render_frame(const Cell& cell, const Scene& scene, const Progress& progress = {});

/// The planes of a frame that a cell needs.
Planes planes_read_by(const Cell& cell);

/// Everything that decides a frame but its planes: for results, and to tell frames apart.
nlohmann::json frame_json(const std::string& scene, const RenderSettings& settings);

/// What a cell is held against, wherever the matrix stands.
nlohmann::json reference_json(const Matrix& matrix, const Cell& cell);

}  // namespace vecino
