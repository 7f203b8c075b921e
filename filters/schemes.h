// SPDX-License-Identifier: Apache-2.0

/// @file
/// The neighbour schemes: they turn a low-resolution frame into a large image. A scheme is one row
/// of the table in schemes.cpp; the command line, matrices, help, tests and README follow from that
/// table.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "core/frame.h"
#include "core/json_read.h"
#include "core/planes.h"

namespace vecino {

/// How the weight w of a neighbour follows from its distance d to the window's centre. s is the
/// mean d over the ungated non-centre neighbours of the window.
enum class Weighting {
    proportional,  ///< w = d, the thesis's equation 4 as printed: farther counts more, the centre 0
    inverse,       ///< w = 1 / (d + 0.01 s): what its prose describes
    gaussian,      ///< w = exp(-d^2 / (2 s^2))
};

/// How uv distances are measured. Distances between first hits are always Euclidean (equation 5 of
/// the thesis).
enum class Metric {
    euclidean,  ///< equation 3 of the thesis
    manhattan,  ///< |du| + |dv|
};

/// What schemes can be told. Each reads those that Scheme::options names.
struct SchemeParameters {
    int window = 3;  ///< low-res pixels, odd, >= 1; the thesis's neighLayers k is (window - 1) / 2
    Weighting weighting = Weighting::proportional;  ///< from a distance to a weight
    Metric metric = Metric::euclidean;              ///< of uv distances
    float min_normal_cosine = 0.95f;  ///< -1 to 1; dot(n_i, n_c) must exceed it: equation 6 of the
                                      ///< thesis, its normalFactor
    bool use_centre = true;           ///< whether a pixel counts among its own neighbours
    int order = 2;                    ///< 0 to 2: the highest order that guided_fit may fit at
    int guide_scale = 1;  ///< 1 to 16: samples of the guide per pixel, along each axis, where a
                          ///< render makes it; a file says it by its size
};

/// An option of schemes: one name for matrices (`name`) and the command line (`flag`).
struct SchemeOption {
    std::string_view name;     ///< key in a matrix, as `min_normal_cosine`
    std::string_view flag;     ///< as `--min-normal-cosine`; empty: in matrices alone
    std::string_view allowed;  ///< for help and errors
    std::string_view summary;  ///< for help: one line
    /// Reads a JSON value into the parameters; throws Error(usage) through JsonValue::fail.
    void (*set)(SchemeParameters&, const JsonValue&);
    /// The value of this option as it stands in a cell's name ("w7", "inverse", ...).
    std::string (*slug)(const SchemeParameters&);
    nlohmann::json (*schema)();  ///< the JSON Schema of what `set` reads
};

/// All options of all schemes.
std::span<const SchemeOption> scheme_options();

/// The option of that name. Throws Error(usage) naming the allowed ones.
const SchemeOption& find_scheme_option(std::string_view name);

/// A rebuilt image, and what its scheme could not average.
struct Reconstruction {
    Image image;  ///< linear radiance, finite
    /// @name Low-resolution pixels
    /// How many of them took another way than the others.
    /// @{
    std::size_t fallback_pixels = 0;    ///< the weights summed to 0 or were not finite, or a miss
    std::size_t dropped_samples = 0;    ///< the colour was not finite
    std::size_t non_finite_pixels = 0;  ///< nothing finite was left: the value is 0
    /// @}
    /// Of schemes with a guide, fallback_pixels and non_finite_pixels count pixels of the result.
    /// Fits of order 0, 1 and 2: of guided_fit, one for each surface in each low-res pixel.
    std::array<std::size_t, 3> fits_of_order{};
};

struct ReconstructionRequest;

/// What a scheme with a guide works on; sizes and planes are checked.
struct GuidedTask {
    const Frame& low;                      ///< radiance, and emission where it is there
    const Frame& guide;                    ///< of the result's size, or a multiple of it
    const ReconstructionRequest& request;  ///< size, parameters and threads
};

/// A row of the table of schemes.
struct Scheme {
    std::string_view name;  ///< the one spelling: JSON, command line, CSV, chart legend
    Planes needs;  ///< planes beside radiance that must be there; where Frame::object_id is there
                   ///< too, schemes that need positions leave misses out
    std::span<const std::string_view> options;  ///< names of the SchemeOptions it reads
    std::string_view summary;                   ///< what a pixel becomes, in one line
    /// The value of every low-res pixel; reconstruct() replicates it. Null with a guide.
    Reconstruction (*run)(const Frame& low, const SchemeParameters&, int threads);
    /// The whole image, from a low-res frame and a full-resolution guide. Null without one.
    Reconstruction (*run_guided)(const GuidedTask&) = nullptr;
    Planes guide_reads{};  ///< planes of the guide that it reads, those that are there
    Planes may_read{};     ///< planes of the low-res frame that it reads where they are there
    SchemeParameters defaults{};  ///< where nothing is said

    /// Whether it reads the SchemeOption of that name.
    [[nodiscard]] bool reads(std::string_view option) const;
    /// Whether it takes full-resolution planes beside the low-res frame.
    [[nodiscard]] bool uses_guide() const { return run_guided != nullptr; }
};

/// All schemes, in this order, and what they are in the thesis:
/// - `nearest`: algorithm 3
/// - `mean`: algorithm 4, equation 2
/// - `distance2d`: algorithm 5, equations 3 and 4
/// - `distance3d`: algorithm 7, equations 4 and 5
/// - `distance3d_normal`: algorithm 8, equations 4 to 6
///
/// and two that take a guide, full-resolution planes of first hits:
/// - `joint_bilateral`: an average over neighbours on the same surface (Kopf et al. 2007)
/// - `guided_fit`: a local polynomial of the irradiance, times the guide's albedo
std::span<const Scheme> all_schemes();

/// The scheme of that name. Throws Error(usage) naming the allowed ones.
const Scheme& find_scheme(std::string_view name);

/// Throws Error(mismatch) if the low-res frame lacks a plane that the scheme needs, naming both, or
/// if one is not of the frame's size. file stands in errors.
void require_planes(const Scheme& scheme, const Frame& low, const std::string& file);

/// The low-res pixel that a full-resolution pixel belongs to, per axis:
/// ((2 full + 1) low_count) div (2 full_count).
constexpr int corresponding(int full, int full_count, int low_count) {
    return static_cast<int>((2LL * full + 1) * low_count / (2LL * full_count));
}

/// What to make of a low-resolution frame.
struct ReconstructionRequest {
    Extent size;                   ///< of the result; no side shorter than the frame's
    SchemeParameters parameters;   ///< Scheme::options names those that are read
    int threads = 0;               ///< 0: all; the result does not depend on it
    const Frame* guide = nullptr;  ///< for schemes that take one: planes of first hits, as
                                   ///< check_guide() leaves them
};

/// Rebuilds an image of the given size. Every full-res pixel takes the value of its corresponding
/// low-res pixel (Algorithms 3, 4, 5, 7, 8), so values are computed once per low-res pixel and
/// replicated. Schemes with a guide make a value of its own for every pixel; where the guide is n
/// times as wide and as high as the result, its n x n samples of a pixel are averaged, so that
/// edges are smooth. Throws Error(mismatch) if size is smaller than the low-res frame, a plane is
/// missing or the guide is no whole multiple of the size, Error(usage) if the window is even or
/// below 1, or without a guide that the scheme needs, Error(file) if the machine lacks the memory.
/// The result is finite.
Reconstruction reconstruct(const Frame& low, const Scheme& scheme,
                           const ReconstructionRequest& request);

}  // namespace vecino
