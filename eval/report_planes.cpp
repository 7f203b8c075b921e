// SPDX-License-Identifier: Apache-2.0
#include "eval/report_planes.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <glm/gtc/packing.hpp>

#include "core/error.h"
#include "core/files.h"
#include "eval/html_text.h"
#include "eval/run_directory.h"

namespace vecino {
namespace {

constexpr float kLargestHalf = 65504.0f;

template <class Word>
void append(std::string& bytes, Word word) {
    for (std::size_t i = 0; i < sizeof word; ++i)
        bytes += static_cast<char>(static_cast<unsigned>(word >> (8 * i)) & 0xffu);
}

std::uint16_t half_bits(float value) {
    const bool is_finite = std::isfinite(value);
    return glm::packHalf1x16(is_finite ? std::clamp(value, -kLargestHalf, kLargestHalf) : value);
}

/// What is left of a value once the reference is known; of an infinite one nothing would be.
float difference(float value, float reference) {
    return std::isfinite(reference) ? value - reference : value;
}

bool holds(const std::string& path, const std::string& text) {
    std::error_code none;
    const auto size = std::filesystem::file_size(path, none);
    return !none && size == text.size() && read_file(path) == text;
}

}  // namespace

std::string precision_name(PlanePrecision precision) {
    return precision == PlanePrecision::float16 ? "float16" : "float32";
}

PlanePrecision parse_precision(const std::string& name) {
    for (const auto precision : {PlanePrecision::float32, PlanePrecision::float16})
        if (name == precision_name(precision)) return precision;
    throw Error(ExitCode::usage, "command line: --embed-precision: found \"" + name +
                                     "\", allowed: float32, float16");
}

std::string plane_base64(const Image& image) {
    std::string bytes;
    bytes.reserve(image.size().area() * 12);
    for (const glm::vec3& value : image.values())
        for (int c = 0; c < 3; ++c) append(bytes, std::bit_cast<std::uint32_t>(value[c]));
    return base64_text(bytes);
}

std::string difference_base64(const Image& image, const Image& reference) {
    std::string bytes;
    bytes.reserve(image.size().area() * 6);
    for (std::size_t i = 0; i < image.values().size(); ++i) {
        const glm::vec3& value = image.values()[i];
        const glm::vec3& against = reference.values()[i];
        for (int c = 0; c < 3; ++c) append(bytes, half_bits(difference(value[c], against[c])));
    }
    return base64_text(bytes);
}

double embedded_bytes(Extent size, PlanePrecision precision) {
    const double bytes_per_pixel = precision == PlanePrecision::float16 ? 6 : 12;
    return static_cast<double>(size.area()) * bytes_per_pixel * 4 / 3;
}

void write_plane_script(const Image& image, const std::string& id, const std::string& path) {
    const auto [width, height] = image.size();
    // JSON is JavaScript; the id may hold any character that a file's name can.
    const nlohmann::json head = {{"id", id}, {"width", width}, {"height", height}};
    const std::string text =
        "vecinoPlane(" + script_json(head) + ",\"" + plane_base64(image) + "\");\n";
    if (holds(path, text)) return;
    std::filesystem::create_directories(std::filesystem::path(path).parent_path());
    write_text_file(path, text);
}

std::string plane_element(const std::string& id, Extent size, const std::string& text) {
    return "<script type=\"text/plain\" class=\"plane\" data-id=\"" + escaped(id) +
           "\" data-width=\"" + std::to_string(size.width) + "\" data-height=\"" +
           std::to_string(size.height) + "\">" + text + "</script>\n";
}

}  // namespace vecino
