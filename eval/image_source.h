// SPDX-License-Identifier: Apache-2.0
//
// Images that vecino does not make: files of any renderer, or what a command makes. An entry of
// "images" in a matrix is a method beside path tracing and the schemes.
#pragma once

#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/json_read.h"
#include "core/render.h"

namespace vecino {

/// Planes of a frame that a command reads, where it does not say: all but the variance, which would
/// cost samples, and means of first hits.
Planes input_planes();

/// What {NAME} in a template stands for.
using Placeholders = std::map<std::string, std::string>;

struct ImageSource {
    std::string name;  ///< of the method
    std::string file;  ///< template of a path; empty where a command makes the image
    std::vector<std::string> command;  ///< templates: a program and its arguments
    std::string output = ".exr";       ///< extension of the file that the command writes
    std::optional<std::array<std::string, 3>> channels;  ///< of the file; none: R, G, B or Y
    Planes planes = input_planes();                      ///< of the frame that the command reads
    std::optional<double> time_s;                        ///< that the image took, where known
    std::string time_attribute;  ///< of the file, that tells it: seconds, or [HH:]MM:SS
    nlohmann::json json;         ///< as it stands in the matrix

    /// Whether its templates hold {placeholder}.
    [[nodiscard]] bool reads(std::string_view placeholder) const;
    /// Whether it rebuilds a frame that vecino traces.
    [[nodiscard]] bool reads_frame() const { return reads("input"); }
};

/// An entry of "images". Throws Error(usage).
ImageSource read_image_source(const std::string& name, const JsonValue& json);

/// An image that cells are held against: "file" and "channels". Throws Error(usage).
ImageSource read_reference_source(const JsonValue& json);

nlohmann::json image_source_schema();

/// What stands for this program, the scene's name and file, the sides of the image and the options
/// of a render.
Placeholders placeholders_of(const std::string& scene_file, const RenderSettings& settings);

/// A template with every {NAME} replaced. {{ and }} are braces. Precondition: read_image_source has
/// checked it.
std::string fill_template(const std::string& text, const Placeholders& values);

struct SourcedImage {
    Frame frame;        ///< of a file without "channels", every known plane
    double time_s = 0;  ///< 0: unknown
};

/// Reads a file as the source says. Throws as load_frame does, Error(mismatch) for a channel or an
/// attribute that is not there.
SourcedImage load_sourced_image(const ImageSource& source, const std::string& path);

/// Seconds from "12.5", "01:02.5" or "1:01:02.5"; none if it is not such a text.
std::optional<double> seconds_of(const std::string& text);

}  // namespace vecino
