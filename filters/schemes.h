// SPDX-License-Identifier: Apache-2.0
//
// The neighbour schemes: they turn a low-resolution frame into a large image. A scheme is one row
// of the table in schemes.cpp; the command line, matrices, help, tests and README follow from that
// table.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "core/frame.h"
#include "core/json_read.h"
#include "core/planes.h"

namespace vecino {

enum class Weighting {
    proportional,  ///< w = d: Eq. 4 of the thesis as printed; farther counts more, the centre 0
    inverse,       ///< w = 1 / (d + 0.01 s): what its prose describes
    gaussian,      ///< w = exp(-d^2 / (2 s^2))
};                 // s: mean d over the ungated non-centre neighbours of the window

enum class Metric { euclidean, manhattan };

struct SchemeParameters {
    int window = 3;  ///< pixels, odd; the thesis's neighLayers k is (window - 1) / 2
    Weighting weighting = Weighting::proportional;
    Metric metric = Metric::euclidean;  ///< of uv distances
    float min_normal_cosine = 0.95f;    ///< the thesis's normalFactor: dot(n_i, n_c) must exceed it
    bool use_centre = true;
};

/// An option of schemes: one name for matrices (`name`) and the command line (`flag`).
struct SchemeOption {
    std::string_view name;     ///< key in a matrix, e.g. "min_normal_cosine"
    std::string_view flag;     ///< e.g. "--min-normal-cosine"
    std::string_view allowed;  ///< for help and errors
    std::string_view summary;
    /// Reads a JSON value into the parameters; throws Error(usage) through JsonValue::fail.
    void (*set)(SchemeParameters&, const JsonValue&);
    /// The value of this option as it stands in a cell's name ("w7", "inverse", ...).
    std::string (*slug)(const SchemeParameters&);
};

/// All options of all schemes.
std::span<const SchemeOption> scheme_options();

/// Throws Error(usage) naming the allowed ones.
const SchemeOption& find_scheme_option(std::string_view name);

struct Reconstruction {
    Image image;
    // All in low-res pixels.
    std::size_t fallback_pixels = 0;    ///< the weights summed to 0 or were not finite, or a miss
    std::size_t dropped_samples = 0;    ///< the colour was not finite
    std::size_t non_finite_pixels = 0;  ///< nothing finite was left: the value is 0
};

struct Scheme {
    std::string_view name;  ///< the one spelling: JSON, command line, CSV, chart legend
    Planes needs;           ///< planes beside radiance that must be there
    std::span<const std::string_view> options;  ///< names of the SchemeOptions it reads
    std::string_view summary;
    /// The value of every low-res pixel; reconstruct() replicates it.
    Reconstruction (*run)(const Frame& low, const SchemeParameters&, int threads);

    [[nodiscard]] bool reads(std::string_view option) const;
};

std::span<const Scheme> all_schemes();

/// Throws Error(usage) naming the allowed ones.
const Scheme& find_scheme(std::string_view name);

/// Throws Error(mismatch) if the low-res frame lacks a plane that the scheme needs, naming both, or
/// if one is not of the frame's size.
void require_planes(const Scheme& scheme, const Frame& low, const std::string& file);

/// The low-res pixel that a full-resolution pixel belongs to, per axis:
/// ((2 full + 1) low_count) div (2 full_count).
constexpr int corresponding(int full, int full_count, int low_count) {
    return static_cast<int>((2LL * full + 1) * low_count / (2LL * full_count));
}

struct ReconstructionRequest {
    Extent size;
    SchemeParameters parameters;
    int threads = 0;  ///< 0: all
};

/// Rebuilds an image of the given size. Every full-res pixel takes the value of its corresponding
/// low-res pixel (Algorithms 3, 4, 5, 7, 8), so values are computed once per low-res pixel and
/// replicated. Throws Error(mismatch) if size is smaller than the low-res frame or a plane is
/// missing, Error(usage) if the window is even or below 1. The result is finite.
Reconstruction reconstruct(const Frame& low, const Scheme& scheme,
                           const ReconstructionRequest& request);

}  // namespace vecino
