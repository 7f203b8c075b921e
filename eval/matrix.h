// SPDX-License-Identifier: Apache-2.0
//
// An evaluation matrix: axes in a JSON file, expanded into named cells before anything runs. A
// matrix may extend another one and then says only what differs.
#pragma once

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/render.h"
#include "eval/budget.h"
#include "eval/failure.h"
#include "eval/image_source.h"
#include "eval/stability_spec.h"
#include "filters/methods.h"
#include "filters/schemes.h"

namespace vecino {

enum class CellKind {
    path,            ///< plain path tracing of every pixel
    method,          ///< another render method
    scheme,          ///< a low-resolution frame, rebuilt
    blocky_ceiling,  ///< the best that is constant per low-resolution pixel, from the reference
    image,           ///< one that vecino does not make: a file, or what a command makes
};

/// One thing to measure: a scheme or a render method with its parameters on a scene, plain path
/// tracing that it is held against, the limit of what such schemes can reach, or an image from
/// elsewhere.
struct Cell {
    std::string name;     ///< e.g. cornell_sphere.distance3d_normal.f2.w7.s1
    std::string group;    ///< the name without its seed: cells of a group are averaged
    std::string against;  ///< the group of path tracing that its time is a share of; may be empty
    std::string scene;    ///< path of the scene file; of images that need none, any name
    CellKind kind = CellKind::path;
    const Scheme* scheme = nullptr;            ///< null unless it is a scheme
    const Method* render_method = nullptr;     ///< null unless it is a method other than path
    std::shared_ptr<const ImageSource> image;  ///< null unless it is an image from elsewhere
    bool is_against_render = true;             ///< which has the cell's size and depth; else a file
    Budget budget = Budget::same_spp;
    int spp_asked =
        0;  ///< of path tracing at full resolution; settings.spp is what the budget gave
    SchemeParameters parameters;         ///< of a scheme
    MethodParameters method_parameters;  ///< of a render method
    RenderSettings settings;             ///< of the frame that the cell reads
    std::vector<Injection> inject;       ///< into that frame, before a scheme reads it

    /// The scheme's, render method's or image source's name, "path" or "blocky_ceiling".
    [[nodiscard]] std::string method() const;
    /// Everything that decides the result, for results.jsonl and for telling a finished cell from a
    /// stale one.
    [[nodiscard]] nlohmann::json parameters_json() const;
    /// Samples traced, against path tracing at full resolution with spp_asked.
    [[nodiscard]] double samples_ratio() const;
};

/// Of an image from elsewhere: whether the option of renders decides it. All that decides a frame
/// does, if it rebuilds one of ours.
bool reads(const Cell& image, std::string_view option);

struct Matrix {
    std::string name;
    std::string file;
    nlohmann::json document;  ///< checked, with what it extends
    RenderSettings reference;
    /// Held against instead, where the matrix names a file.
    std::shared_ptr<const ImageSource> reference_source;
    std::map<std::string, std::shared_ptr<const ImageSource>> images;  ///< by name
    std::vector<std::string> metrics;        ///< of those on request, which to measure
    std::vector<FailureCase> failures;       ///< whose scenes are judged
    std::optional<StabilitySpec> stability;  ///< none: not asked for
    int repeat = 1;  ///< timings of a stage that takes under 0.5 s; the median counts
};

/// Reads and checks a matrix; scene paths are relative to the file that holds them. Throws as
/// load_scene does.
Matrix load_matrix(const std::string& path);

/// Of a document with all that it extends, as run.json keeps it; the file is for errors and scene
/// paths. Throws Error(usage).
Matrix matrix_of(nlohmann::json document, const std::string& file);

/// All cells, path tracing and ceilings included, in a fixed order with unique names.
std::vector<Cell> expand(const Matrix& matrix);

/// Whether vecino traces the cell's scene: not for images from elsewhere that are held against a
/// file, whose scene is a name, or some other program's.
bool traces_scene(const Matrix& matrix, const Cell& cell);

/// The folder that paths in a matrix start from; empty for this one.
std::string folder_of(const Matrix& matrix);

/// A path from a template of the matrix.
std::string sourced_path(const Matrix& matrix, const std::string& file, const Placeholders& values);

/// Settings of the reference that a cell is held against.
RenderSettings reference_settings(const Matrix& matrix, const Cell& cell);

/// File name without directory and extension.
std::string stem(const std::string& path);

}  // namespace vecino
