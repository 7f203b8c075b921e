// SPDX-License-Identifier: Apache-2.0

/// @file
/// The render methods: they decide which rays to trace for a large image. A method is one row of
/// the table in methods.cpp; the command line, matrices, help, tests and README follow from that
/// table.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string_view>
#include <vector>

#include "core/option_row.h"
#include "core/render.h"
#include "filters/auto_options.h"
#include "filters/schemes.h"
#include "filters/surface_records_options.h"

namespace vecino {

/// What `interleaved` shares out among pixels (task 11 of the thesis has both meanings).
enum class Interleaving {
    lattice,      ///< pixels: those of a mask are traced, others interpolated
    subsequence,  ///< samples: every pixel has its part of one set, which a gated box puts together
};

/// Which pixels a lattice has, of those whose x and y are multiples of a step.
enum class LatticeMask {
    square,    ///< all
    quincunx,  ///< those for which (x + y) / step is even: with a step of 1, a checkerboard
};

/// What an interpolated pixel of a lattice is made of.
enum class LatticeKernel {
    distance3d_normal,  ///< radiance of traced pixels around it with a like normal: the thesis's
    surface,  ///< light of those on the same surface, times its own albedo; edges are traced
};

/// Which colour `reuse` takes of the traced hits nearby.
enum class Reused {
    nearest,  ///< that of the nearest one
    mean,     ///< the mean of all, weighted by distance
};

/// When `variation` stops to sample a pixel. The thesis's rule, that the mean difference of colour
/// between all samples is below a bound, has three readings; all take the mean over R, G and B.
enum class VariationRule {
    sample_difference,  ///< mean of |x_i - x_j| over pairs: does not fall with more samples
    mean_change,        ///< |mean of n - mean of n - 1|: falls as 1/n, faster than the error
    standard_error,     ///< s / sqrt(n)
    scramblings,        ///< a confidence interval from independent scramblings, relative to the
                        ///< root of the pixel's value
};

/// What methods can be told beside RenderSettings. Each reads those that Method::options names.
struct MethodParameters {
    float min_normal_cosine = 0.95f;           ///< -1 to 1; normals of one surface exceed it
    Weighting weighting = Weighting::inverse;  ///< of what a pixel is made of, by distance in space

    /// @name interleaved
    /// @{
    Interleaving interleaving = Interleaving::lattice;  ///< what is shared out
    LatticeMask mask = LatticeMask::square;             ///< of a lattice
    LatticeKernel kernel = LatticeKernel::surface;      ///< of a lattice
    int step = 2;  ///< 1 to 64: of a lattice, or side of the box; pixels
    /// @}

    /// @name adaptive
    /// @{
    int coarse_step = 4;     ///< 1 to 64, a power of 2: of the first traced pixels
    float tolerance = 0.1f;  ///< >= 0: relative difference of light that is interpolated across
    bool correction = true;  ///< whether pixels around a wrong interpolation are traced after all
    /// @}

    /// @name reuse
    /// @{
    float radius = 2.0f;           ///< 0 to 64 footprints: how near a hit to be reused is
    Reused reused = Reused::mean;  ///< which of those in reach
    /// @}

    /// @name variation
    /// @{
    VariationRule variation_rule = VariationRule::scramblings;  ///< when a pixel is done
    float variation_bound = 0.02f;  ///< >= 0: that the rule holds its variation against
    /// Samples before the first look, rounded up to a multiple of 4; others follow whenever they
    /// have doubled. 0: 16, or 512 where light is found by chance and few samples find none.
    int min_spp = 0;
    /// @}

    SurfaceRecordsOptions surface_records;  ///< of the method of that name
    AutoOptions planner;                    ///< of the method auto
};

/// An option of methods.
using MethodOption = OptionRow<MethodParameters>;

/// All options of all methods.
std::span<const MethodOption> method_options();

/// What to render, and how.
struct MethodRequest {
    const Scene& scene;           ///< what is rendered
    RenderSettings settings;      ///< spp is what path tracing would spend on a pixel
    MethodParameters parameters;  ///< Method::options names those that are read
};

/// A value per pixel beside the planes of a frame, for looking at what a method did.
struct MethodMap {
    std::string_view name;  ///< as a channel of an EXR file
    Grid<float> values;     ///< of the frame's size
};

/// A frame, what it took, and what the method made of the request.
struct MethodRender {
    Render render;             ///< its frame holds the planes that were asked for
    double reconstruct_s = 0;  ///< seconds beside tracing and building the scene
    /// What the method decided or counted, by name, for results and people: an object.
    nlohmann::json facts = nlohmann::json::object();
    /// Seconds by stage, for people: an object. Differs from run to run, as facts do not.
    nlohmann::json stage_s = nlohmann::json::object();
    /// What it did where. Of `adaptive`: Calculated, the pass in which a pixel got its value, and
    /// Explicit, 1 where it was traced (the thesis's filmMapsCalculated and
    /// filmMapWasExplicitCalculated).
    std::vector<MethodMap> maps = {};
};

/// A row of the table of methods.
struct Method {
    std::string_view name;                      ///< the one spelling: JSON, command line, legend
    std::span<const std::string_view> options;  ///< names of the MethodOptions it reads
    std::string_view summary;                   ///< how it renders, in one line
    /// Renders. Whatever it draws depends on the request alone, not on threads or time.
    MethodRender (*run)(const MethodRequest&, const Progress&);

    /// Whether it reads the MethodOption of that name.
    [[nodiscard]] bool reads(std::string_view option) const;
};

/// All methods. The first is `path`: path tracing of every pixel.
std::span<const Method> all_methods();

/// The method of that name. Throws Error(usage) naming the allowed ones.
const Method& find_method(std::string_view name);

/// Renders by a method. A scene that is a pattern has nothing to decide: it is filled in by all.
/// Throws as render() does. Methods other than `path` take more memory per pixel: 100 bytes beside
/// the planes, `adaptive` 260, `variation` by independent scramblings 500.
MethodRender render(const Method& method, const MethodRequest& request,
                    const Progress& progress = {});

}  // namespace vecino
