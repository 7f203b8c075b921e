// SPDX-License-Identifier: Apache-2.0
//
// How much a result changes when something changes that should matter little: the camera moves by a
// part of a pixel, or a parameter is another one. All squares are of display values (clipped to
// [0,1], sRGB-encoded), as behind psnr_float_db.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/frame.h"
#include "eval/matrix.h"
#include "eval/stability_spec.h"

namespace vecino {

/// What a moved camera sees: the frame that cells read, and their reference.
struct ShiftedView {
    float shift = 0;  ///< pixels of the full resolution, right and down alike
    Frame frame;
    const Image* reference = nullptr;
};

/// Whether stability is measured on a cell: it reads a frame of ours.
bool has_stability(const Cell& cell);

/// Whether a row holds all that the matrix asks for of its cell.
bool holds_stability(const nlohmann::json& row, const Cell& cell, const StabilitySpec& spec);

/// A cell's image and its reference, of the camera that is not moved.
struct StillView {
    const Image* image = nullptr;
    const Image* reference = nullptr;
};

/// For results.jsonl: [{"shift":, "change":, "reference_change":}, ...]. Changes are the mean
/// squared differences between what both cameras see; make returns what the cell makes of a view.
nlohmann::json shimmer_json(std::span<const ShiftedView> shifted, const StillView& still,
                            const std::function<Image(const ShiftedView&)>& make);

/// For results.jsonl: {PARAMETER: {"low": {"value":, "mse":}, "high": {"value":, "mse":}}, ...};
/// make returns the image of a cell with another parameter.
nlohmann::json elasticity_json(const Cell& cell, const Image& reference,
                               const std::function<Image(const Cell&)>& make);

/// The file that keeps a cell's image of a moved camera, in its folder: "shift_0.25.exr".
std::string shifted_image_file(double shift);

/// A ratio of changes, 1 at best: with D_i the difference between what both cameras see of seed i,
/// and R that of the references.
struct Shimmer {
    double shift = 0;
    double with_noise = 0;                ///< mean of D_i^2 / R^2: what an eye sees
    std::optional<double> without_noise;  ///< mean of D_i D_j / R^2 over i != j; none below 2 seeds
};

/// Of images by seed, of one camera and the moved one, in the same order. None where the reference
/// does not change. Throws Error(mismatch) when sizes differ.
std::optional<Shimmer> shimmer(std::span<const Image> images, std::span<const Image> shifted,
                               double shift, double reference_change);

/// Mean over pixels and channels of the squared difference of display values.
double display_mse(const Image& a, const Image& b);

}  // namespace vecino
