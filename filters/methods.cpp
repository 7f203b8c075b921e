// SPDX-License-Identifier: Apache-2.0
#include "filters/methods.h"

#include <algorithm>
#include <string>
#include <vector>

#include "core/error.h"
#include "filters/method_rows.h"
#include "filters/plans.h"

namespace vecino {
namespace {

MethodRender trace_paths(const MethodRequest& request, const Progress& progress) {
    return {.render = render(request.scene, request.settings, progress)};
}

constexpr std::string_view kInterleavedOptions[] = {
    "interleaving", "mask", "kernel", "step", "weighting", "min_normal_cosine"};
constexpr std::string_view kAdaptiveOptions[] = {"coarse_step", "tolerance", "correction",
                                                 "min_normal_cosine"};
constexpr std::string_view kReuseOptions[] = {"radius", "reused", "weighting", "min_normal_cosine"};
constexpr std::string_view kVariationOptions[] = {"variation_rule", "variation_bound", "min_spp"};
constexpr std::string_view kSurfaceRecordsOptions[] = {
    "pilot_spp", "edge_spp",   "cell",      "levels",    "record_paths", "refined_record_paths",
    "fit_sigma", "refine_tau", "fit_order", "edge_light"};
constexpr std::string_view kAutoOptions[] = {"time_budget"};

// clang-format off
const Method kMethods[] = {
    {"path", {}, "path tracing of every pixel", trace_paths},
    {"interleaved", kInterleavedOptions, "pixels of a lattice, others interpolated; or parts of one set of samples", render_interleaved},
    {"adaptive", kAdaptiveOptions, "pixels between traced ones of their surface are traced where these disagree", render_adaptive},
    {"reuse", kReuseOptions, "a pixel takes the colour of a traced one whose hit is near in space", render_reuse},
    {"variation", kVariationOptions, "a pixel is sampled until its samples vary little, spp at most", render_variation},
    {"surface_records", kSurfaceRecordsOptions,
     "exact coverage and direct light, indirect light interpolated on surfaces", run_surface_records},
    {"auto", kAutoOptions, "what a pilot says is best for the time", run_auto},
};
// clang-format on

}  // namespace

std::span<const Method> all_methods() {
    return kMethods;
}

const Method& find_method(std::string_view name) {
    const auto* row = std::ranges::find(kMethods, name, &Method::name);
    if (row != std::end(kMethods)) return *row;
    std::vector<std::string_view> allowed;
    for (const Method& method : kMethods) allowed.push_back(method.name);
    throw Error(ExitCode::usage,
                "method: found \"" + std::string(name) + "\", allowed: " + join(allowed));
}

bool Method::reads(std::string_view option) const {
    return std::ranges::find(options, option) != options.end();
}

MethodRender render(const Method& method, const MethodRequest& request, const Progress& progress) {
    if (request.scene.pattern != Pattern::none) return trace_paths(request, progress);
    return method.run(request, progress);
}

}  // namespace vecino
