// SPDX-License-Identifier: Apache-2.0
#include "eval/matrix.h"
#include "eval/render_options.h"

namespace vecino {
namespace {

/// What decides the ceiling: all that decides the reference, and the blocks.
bool decides_ceiling(std::string_view option) {
    return option == "size" || option == "reduction" || option == "max_depth" ||
           option == "camera_shift";
}

bool decides(const Cell& cell, std::string_view option) {
    switch (cell.kind) {
        case CellKind::blocky_ceiling:
            return decides_ceiling(option);
        case CellKind::image:
            return reads(cell, option);
        case CellKind::path:
        case CellKind::method:
            return option != "reduction";
        case CellKind::scheme:
            break;
    }
    return true;
}

}  // namespace

bool reads(const Cell& cell, std::string_view option) {
    const ImageSource& image = *cell.image;
    const bool is_of_reference =
        option == "size" || option == "max_depth" || option == "camera_shift";
    if (cell.is_against_render && is_of_reference) return true;
    if (option == "size")
        return image.reads_frame() || image.reads("width") || image.reads("height");
    return image.reads_frame() || image.reads(option);
}

std::string Cell::method() const {
    if (kind == CellKind::blocky_ceiling) return "blocky_ceiling";
    if (kind == CellKind::image) return image->name;
    if (kind == CellKind::method) return std::string(render_method->name);
    return kind == CellKind::path ? "path" : std::string(scheme->name);
}

nlohmann::json Cell::parameters_json() const {
    nlohmann::json json{{"scene", scene}, {"method", method()}};
    for (const RenderOption& row : render_options()) {
        if (decides(*this, row.name) && is_told(row, settings))
            json[std::string(row.name)] = row.get(settings);
    }
    if (kind == CellKind::image) {
        json["image"] = image->json;
        if (json.contains("spp")) json["spp_asked"] = spp_asked;
        return json;
    }
    if (kind == CellKind::blocky_ceiling) return json;
    json["spp_asked"] = spp_asked;
    json["budget"] = budget_name(budget);
    for (const MethodOption& row : method_options()) {
        if (render_method != nullptr && render_method->reads(row.name))
            json[std::string(row.name)] = row.get(method_parameters);
    }
    if (scheme == nullptr) return json;
    for (const SchemeOption& row : scheme_options()) {
        if (scheme->reads(row.name)) json[std::string(row.name)] = row.slug(parameters);
    }
    if (scheme->reads("window")) json["window"] = parameters.window;
    for (const Injection& each : inject) json["inject"].push_back(injection_json(each));
    return json;
}

double Cell::samples_ratio() const {
    if (kind == CellKind::blocky_ceiling || kind == CellKind::image) return 0;
    const auto full = static_cast<double>(settings.size.area());
    const auto low = static_cast<double>(reduced(settings.size, settings.reduction).area());
    return static_cast<double>(settings.spp) * low / (static_cast<double>(spp_asked) * full);
}

}  // namespace vecino
