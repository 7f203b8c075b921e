// SPDX-License-Identifier: Apache-2.0
//
// An evaluation matrix: axes in a JSON file, expanded into named cells before anything runs. Keys
// of axes, fixed, exclude and include are "scene", "scheme", "budget" and every row of the option
// tables of renders and schemes.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/render.h"
#include "filters/schemes.h"

namespace vecino {

/// How many samples a low-resolution frame gets, against path tracing at full resolution.
enum class Budget {
    same_spp,       ///< as many per pixel (thesis 5.3)
    equal_samples,  ///< as many in all: spp * W*H / (w*h), rounded (thesis 5.4.1)
};

/// One thing to measure: a scheme with its parameters on a scene, or plain path tracing.
struct Cell {
    std::string name;                ///< e.g. cornell_sphere.distance3d_normal.f2.w7.s1
    std::string group;               ///< the name without its seed: cells of a group are averaged
    std::string scene;               ///< path of the scene file
    const Scheme* scheme = nullptr;  ///< null: path tracing of every pixel
    Budget budget = Budget::same_spp;
    SchemeParameters parameters;
    RenderSettings settings;  ///< of the frame that the cell reads

    [[nodiscard]] std::string method() const;  ///< the scheme's name, or "path"
    /// Everything that decides the result, for results.jsonl and for telling a finished cell from a
    /// stale one.
    [[nodiscard]] nlohmann::json parameters_json() const;
    /// Samples traced, against path tracing at full resolution with the matrix's spp.
    double samples_ratio = 1.0;
};

struct Matrix {
    std::string name;
    std::string file;
    nlohmann::json document;  ///< checked
    RenderSettings reference;
    int repeat = 1;  ///< timings of a stage that takes under 0.5 s; the median counts
};

/// Reads and checks a matrix; scene paths are relative to its file. Throws as load_scene does.
Matrix load_matrix(const std::string& path);

/// All cells, path tracing included, in a fixed order with unique names.
std::vector<Cell> expand(const Matrix& matrix);

/// Settings of the reference that a cell is held against.
RenderSettings reference_settings(const Matrix& matrix, const Cell& cell);

/// File name without directory and extension.
std::string stem(const std::string& path);

}  // namespace vecino
