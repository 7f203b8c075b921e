// SPDX-License-Identifier: Apache-2.0
#include "eval/comparison_vti.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/channel_file.h"
#include "core/planes.h"
#include "eval/pixel_maps.h"
#include "eval/pixel_values.h"
#include "eval/vti.h"

namespace vecino {
namespace {

const std::vector<std::string_view> kRgb{"R", "G", "B"};
const std::vector<std::string_view> kXyz{"X", "Y", "Z"};

/// What the numbers of a plane measure.
struct PlaneText {
    Plane plane;
    std::string_view unit, definition;
};

// clang-format off
constexpr PlaneText kPlaneTexts[] = {
    {Plane::radiance, "linear radiance", "emission + direct + indirect"},
    {Plane::direct,   "linear radiance", "light after exactly one bounce"},
    {Plane::indirect, "linear radiance", "light after more than one bounce"},
    {Plane::emission, "linear radiance", "light seen without a bounce"},
    {Plane::albedo,   "",                "of the first hit"},
    {Plane::position, "scene units",     "of the first hit, in the scene"},
    {Plane::normal,   "",                "of the first hit: unit, geometric, facing the camera"},
    {Plane::distance, "scene units",     "of the first hit from the camera"},
    {Plane::id,       "",                "index of the first hit's object in the scene file, -1 for a miss"},
    {Plane::count,    "samples",         "samples in the pixel"},
    {Plane::variance, "linear radiance^2", "of the pixel mean"},
};
// clang-format on

VtiArray image_array(const std::string& name, const Image& image, const std::string& definition) {
    return {name, "linear radiance", definition, kRgb, [&image](std::size_t i, std::size_t c) {
                return image.values()[i][static_cast<int>(c)];
            }};
}

std::vector<std::string_view> component_names(const PlaneInfo& info) {
    if (info.channel_count() == 1) return {};
    return info.channels[0].ends_with('X') ? kXyz : kRgb;
}

void add_planes(const Frame& frame, const std::string& whose, std::vector<VtiArray>& arrays) {
    const Planes held = planes_of(frame);
    for (const PlaneText& text : kPlaneTexts) {
        if (text.plane == Plane::radiance || !held.has(text.plane)) continue;
        const PlaneInfo& info = *std::ranges::find(all_planes(), text.plane, &PlaneInfo::plane);
        VtiArray array{whose + "_" + std::string(info.name),
                       std::string(text.unit),
                       std::string(text.definition),
                       component_names(info),
                       {}};
        std::visit(
            [&]<class T>(Grid<T> Frame::*member) {
                array.value = [&plane = frame.*member](std::size_t i, std::size_t c) {
                    return component(plane.values()[i], c);
                };
            },
            info.member);
        arrays.push_back(std::move(array));
    }
}

/// Grids that are made for the file, kept alive until it is written.
using Maps = std::vector<Grid<float>>;

void add_maps(const ComparedFrames& compared, Maps& maps, std::vector<VtiArray>& arrays) {
    maps.reserve(all_pixel_maps().size());
    for (const PixelMap& map : all_pixel_maps()) {
        maps.push_back(map.values(compared.test.radiance, compared.reference.radiance));
        arrays.push_back(
            {std::string(map.name),
             "",
             std::string(map.definition),
             {},
             [&values = maps.back()](std::size_t i, std::size_t) { return values.values()[i]; }});
    }
}

void add_regions(const RegionMap& regions, std::vector<VtiArray>& arrays) {
    std::string definition;
    for (const RegionInfo& info : kRegions) {
        definition += (definition.empty() ? "" : "; ") + std::to_string(region_index(info.region)) +
                      " " + std::string(info.name) + ": " + std::string(info.definition);
    }
    arrays.push_back({"region", "", definition, {}, [&regions](std::size_t i, std::size_t) {
                          return static_cast<float>(region_index(regions.values()[i]));
                      }});
}

std::vector<VtiNumber> numbers_of(const nlohmann::json& metrics) {
    std::vector<VtiNumber> numbers;
    if (!metrics.is_object()) return numbers;
    for (const auto& [name, value] : metrics.items()) {
        if (value.is_number()) numbers.push_back({name, value.get<double>()});
    }
    return numbers;
}

}  // namespace

void save_comparison_vti(const ComparedFrames& compared, const std::string& path) {
    const Image& test = compared.test.radiance;
    const Image& reference = compared.reference.radiance;
    require_comparable(test, reference);
    if (compared.regions != nullptr) require_size(*compared.regions, test.size());
    VtiImage file{test.size(), {}, numbers_of(compared.metrics), ""};
    file.arrays.push_back(image_array("test", test, "the image"));
    file.arrays.push_back(image_array("reference", reference, "what it is held against"));
    file.arrays.push_back(
        {"error", "linear radiance", "test - reference", kRgb, [&](std::size_t i, std::size_t c) {
             const int channel = static_cast<int>(c);
             return test.values()[i][channel] - reference.values()[i][channel];
         }});
    Maps maps;
    add_maps(compared, maps, file.arrays);
    file.shown = all_pixel_maps().front().name;
    if (compared.regions != nullptr) add_regions(*compared.regions, file.arrays);
    add_planes(compared.test, "test", file.arrays);
    add_planes(compared.reference, "reference", file.arrays);
    save_vti(file, path);
}

}  // namespace vecino
