// SPDX-License-Identifier: Apache-2.0
//
// The table of schemes, and what surrounds every one of them: checks before, replication after. A
// new scheme is one row here plus its distance and weight (window_kernel.cpp) or a routine of its
// own.
#include "filters/schemes.h"

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "core/error.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "filters/guide.h"
#include "filters/guided.h"
#include "filters/window.h"

namespace vecino {
namespace {

/// Algorithm 3.
Reconstruction run_nearest(const Frame& low, const SchemeParameters&, int) {
    Reconstruction result;
    result.image = low.radiance;
    for (glm::vec3& color : result.image.values()) {
        if (is_finite(color)) continue;
        color = glm::vec3(0.0f);
        ++result.non_finite_pixels;
    }
    result.dropped_samples = result.non_finite_pixels;
    return result;
}

/// Algorithm 4.
Reconstruction run_mean(const Frame& low, const SchemeParameters& parameters, int threads) {
    const WindowKind kind{WindowDistance::euclidean, WindowWeight::equal};
    return average_windows(low, kind, parameters, threads);
}

WindowWeight weight_of(Weighting weighting) {
    switch (weighting) {
        case Weighting::proportional:
            return WindowWeight::proportional;
        case Weighting::inverse:
            return WindowWeight::inverse;
        case Weighting::gaussian:
            return WindowWeight::gaussian;
    }
    return WindowWeight::proportional;
}

/// Algorithm 5.
Reconstruction run_distance2d(const Frame& low, const SchemeParameters& parameters, int threads) {
    const bool manhattan = parameters.metric == Metric::manhattan;
    const WindowKind kind{manhattan ? WindowDistance::manhattan : WindowDistance::euclidean,
                          weight_of(parameters.weighting)};
    return average_windows(low, kind, parameters, threads);
}

/// Algorithms 7 and 8.
template <WindowDistance kDistance>
Reconstruction run_distance3d(const Frame& low, const SchemeParameters& parameters, int threads) {
    const WindowKind kind{kDistance, weight_of(parameters.weighting)};
    return average_windows(low, kind, parameters, threads);
}

constexpr std::string_view kMeanOptions[] = {"window", "use_centre"};
constexpr std::string_view kDistance2dOptions[] = {"window", "weighting", "metric", "use_centre"};
constexpr std::string_view kDistance3dOptions[] = {"window", "weighting", "use_centre"};
constexpr std::string_view kNormalOptions[] = {"window", "weighting", "min_normal_cosine",
                                               "use_centre"};

constexpr std::string_view kBilateralOptions[] = {"window", "guide_scale"};
constexpr std::string_view kFitOptions[] = {"window", "order", "guide_scale"};

// clang-format off
const Scheme kSchemes[] = {
    {"nearest", {}, {},
     "the colour of the corresponding low-resolution pixel", run_nearest},
    {"mean", {}, kMeanOptions,
     "the plain average of a window", run_mean},
    {"distance2d", {}, kDistance2dOptions,
     "an average weighted by distance in the image", run_distance2d},
    {"distance3d", {Plane::position}, kDistance3dOptions,
     "an average weighted by distance between first hits", run_distance3d<WindowDistance::world>},
    {"distance3d_normal", {Plane::position, Plane::normal}, kNormalOptions,
     "the same, among neighbours of similar normal", run_distance3d<WindowDistance::gated_world>},
    {"joint_bilateral", {}, kBilateralOptions,
     "an average of neighbours on the surface that a guide shows there", nullptr,
     joint_bilateral, kGuidePlanes, {Plane::emission}, {.window = 5}},
    {"guided_fit", {}, kFitOptions,
     "a polynomial fitted to the irradiance of that surface, times the guide's albedo", nullptr,
     guided_fit, kGuidePlanes, {Plane::emission}, {.window = 7}},
};
// clang-format on

std::string to_string(Extent size) {
    return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::string quoted(std::string_view name) {
    return '"' + std::string(name) + '"';
}

Extent size_of(const Frame& frame, const PlaneInfo& plane) {
    return std::visit([&](auto member) { return (frame.*member).size(); }, plane.member);
}

void require_sound(const Frame& low, const ReconstructionRequest& request) {
    const Extent least = low.size();
    if (least.area() == 0) {
        throw Error(ExitCode::mismatch,
                    "low-resolution frame: found " + to_string(least) + ", allowed: at least 1x1");
    }
    if (request.size.width < least.width || request.size.height < least.height) {
        throw Error(ExitCode::mismatch, "size: found " + to_string(request.size) +
                                            ", allowed: at least the low-resolution " +
                                            to_string(least));
    }
    const int window = request.parameters.window;
    if (window < 1 || window % 2 == 0) {
        throw Error(ExitCode::usage, "window: found " + std::to_string(window) +
                                         ", allowed: an odd integer of at least 1");
    }
}

Image replicate(const Image& low, Extent size, int threads) {
    constexpr std::size_t kRowsPerBlock = 16;
    std::vector<int> columns(static_cast<std::size_t>(size.width));
    for (int x = 0; x < size.width; ++x) {
        columns[static_cast<std::size_t>(x)] = corresponding(x, size.width, low.size().width);
    }
    Image full(size);
    for_each_block(
        static_cast<std::size_t>(size.height), kRowsPerBlock, threads, [&](BlockRange rows) {
            for (auto y = static_cast<int>(rows.begin); y < static_cast<int>(rows.end); ++y) {
                const int low_y = corresponding(y, size.height, low.size().height);
                glm::vec3* out = &full(0, y);
                for (const int low_x : columns) *out++ = low(low_x, low_y);
            }
        });
    return full;
}

}  // namespace

bool Scheme::reads(std::string_view option) const {
    return std::ranges::find(options, option) != options.end();
}

std::span<const Scheme> all_schemes() {
    return kSchemes;
}

const Scheme& find_scheme(std::string_view name) {
    const auto* row = std::ranges::find(kSchemes, name, &Scheme::name);
    if (row != std::end(kSchemes)) return *row;
    std::vector<std::string_view> allowed;
    for (const Scheme& scheme : kSchemes) allowed.push_back(scheme.name);
    throw Error(ExitCode::usage, "scheme: found " + quoted(name) + ", allowed: " + join(allowed));
}

void require_planes(const Scheme& scheme, const Frame& low, const std::string& file) {
    std::vector<std::string_view> missing;
    for (const PlaneInfo& plane : all_planes()) {
        const Extent size = size_of(low, plane);
        // Ids need not be there, but where they are, the 3D schemes look for misses in them.
        const bool is_read = plane.plane == Plane::id || scheme.may_read.has(plane.plane);
        const bool optional = is_read && size.area() > 0;
        if (!scheme.needs.has(plane.plane) && !optional) continue;
        if (size.area() == 0) {
            missing.push_back(plane.name);
        } else if (size != low.size()) {
            throw Error(ExitCode::mismatch,
                        file + ": found plane " + quoted(plane.name) + " of " + to_string(size) +
                            ", allowed: " + to_string(low.size()) + ", as the radiance");
        }
    }
    if (missing.empty()) return;
    throw Error(ExitCode::mismatch, file + ": scheme " + quoted(scheme.name) +
                                        " needs planes that are not there: " + join(missing));
}

Reconstruction reconstruct(const Frame& low, const Scheme& scheme,
                           const ReconstructionRequest& request) {
    require_sound(low, request);
    require_planes(scheme, low, "low-resolution frame");
    require_memory(bytes_of({Plane::radiance}, request.size),
                   "image of " + to_string(request.size));
    if (scheme.uses_guide()) {
        if (request.guide == nullptr)
            throw Error(ExitCode::usage, "scheme " + quoted(scheme.name) +
                                             ": found no guide, allowed: with one (--guide)");
        require_guide(*request.guide, request.size, "guide");
        return scheme.run_guided({low, *request.guide, request});
    }
    Reconstruction result = scheme.run(low, request.parameters, request.threads);
    result.image = replicate(result.image, request.size, request.threads);
    return result;
}

}  // namespace vecino
