// SPDX-License-Identifier: Apache-2.0

/// @file
/// The render methods: they decide which rays to trace for a large image. A method is one row of
/// the table in methods.cpp; the command line, matrices, help, tests and README follow from that
/// table.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string_view>

#include "core/option_row.h"
#include "core/render.h"
#include "filters/auto_options.h"
#include "filters/surface_records_options.h"

namespace vecino {

/// What methods can be told beside RenderSettings. Each reads those that Method::options names.
struct MethodParameters {
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

/// A frame, what it took, and what the method made of the request.
struct MethodRender {
    Render render;             ///< its frame holds the planes that were asked for
    double reconstruct_s = 0;  ///< seconds beside tracing and building the scene
    /// What the method decided or counted, by name, for results and people: an object.
    nlohmann::json facts = nlohmann::json::object();
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
/// Throws as render() does.
MethodRender render(const Method& method, const MethodRequest& request,
                    const Progress& progress = {});

}  // namespace vecino
