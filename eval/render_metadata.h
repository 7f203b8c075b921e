// SPDX-License-Identifier: Apache-2.0
//
// What an image file says of the render that it came from.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "core/error.h"
#include "core/image_io.h"
#include "filters/methods.h"

namespace vecino {

/// Of path tracing: scene, version, seconds, method, and every option of a render under its name
/// ("depth" for max_depth).
Metadata render_metadata(const std::string& scene, const RenderSettings& settings, double seconds);

/// Of another method: its name and those of its options that it reads.
void describe_method(const Method& method, const MethodParameters& parameters, Metadata& metadata);

/// The schedule of a method that chose one.
void describe_schedule(const MethodRender& result, Metadata& metadata);

/// Says on stderr what was chosen and why, if the method had a choice.
void report_schedule(const MethodRender& result);

/// An attribute as text, for errors.
std::string attribute_text(const Metadata& metadata, const std::string& name);

/// Times and counts of a render as `--json` prints them.
nlohmann::json render_json(const MethodRender& result, double write_s);

/// Says on stderr what was not finite: nothing, a warning, or an error with the code that it has.
ExitCode report_non_finite(const RenderStatistics& statistics, const std::string& output);

}  // namespace vecino
