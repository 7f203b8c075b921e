// SPDX-License-Identifier: Apache-2.0
#include "eval/figure_pictures.h"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "core/files.h"
#include "core/image_io.h"
#include "eval/html_text.h"

namespace vecino {
namespace {

std::string picture_url(const Image& image, const ReportData& data) {
    const TemporaryFile file(data.directory + "/picture.png");
    save_image(image, file.path());
    return png_url(read_file(file.path()));
}

/// Files of the references of a scene's results, without extension.
std::optional<std::string> reference_of(const ReportData& data, const std::string& scene) {
    for (const nlohmann::json& row : data.rows) {
        const std::string file = row.value("reference_file", "");
        if (row["scene"] != scene || file.empty()) continue;
        const std::string path = data.directory + "/" + file;
        if (std::filesystem::exists(path + ".exr")) return path;
    }
    return std::nullopt;
}

std::vector<LabelledPicture> reference_pictures(const ReportData& data) {
    std::vector<LabelledPicture> pictures;
    for (const std::string& scene : data.scenes) {
        const auto path = reference_of(data, scene);
        if (!path || !std::filesystem::exists(*path + ".png")) continue;
        pictures.push_back({scene, png_url(read_file(*path + ".png"))});
    }
    return pictures;
}

std::vector<LabelledPicture> light_pictures(const ReportData& data, const Figure& figure) {
    std::vector<LabelledPicture> pictures;
    for (const Selection& selection : figure.of) {
        for (const nlohmann::json& scene : selection.at("scene")) {
            const auto path = reference_of(data, scene.get<std::string>());
            if (!path) continue;
            const Frame frame = load_frame(*path + ".exr");
            if (planes_of(frame).has(Plane::direct))
                pictures.push_back({"direct", picture_url(frame.direct, data)});
            if (planes_of(frame).has(Plane::indirect))
                pictures.push_back({"indirect", picture_url(frame.indirect, data)});
            pictures.push_back(
                {"global: emitted, direct and indirect", picture_url(frame.radiance, data)});
        }
    }
    return pictures;
}

/// Rows first to last of n equal bands.
Image band(const Image& image, std::size_t index, std::size_t n) {
    const auto row = [&](std::size_t i) {
        return static_cast<int>(i * static_cast<std::size_t>(image.size().height) / n);
    };
    const int top = row(index);
    Image part({image.size().width, std::max(1, row(index + 1) - top)});
    for (int y = 0; y < part.size().height; ++y) {
        for (int x = 0; x < part.size().width; ++x) part(x, y) = image(x, top + y);
    }
    return part;
}

/// Of the first finished seed: one that failed may hold what no picture can show.
std::string finished_image(const ReportData& data, const GroupSummary& group) {
    for (const std::string& cell : group.cells) {
        std::string file = data.directory + "/cells/" + cell + "/image.exr";
        if (data.row_of(cell)["status"] == "ok" && std::filesystem::exists(file)) return file;
    }
    return "";
}

std::vector<LabelledPicture> strip_pictures(const ReportData& data, const Figure& figure) {
    Variant variant = data.reproduction->specification.variants.front();
    variant.where = variant.where.without("spp");
    std::vector<const GroupSummary*> groups;
    for (const Selection& selection : figure.of) {
        for (const GroupSummary* group : select(data.groups, selection, variant))
            groups.push_back(group);
    }
    const auto spp = [](const GroupSummary* group) { return group->params.value("spp", 0); };
    std::ranges::sort(groups, {}, spp);
    std::vector<LabelledPicture> pictures;
    for (std::size_t i = 0; i < groups.size(); ++i) {
        const std::string file = finished_image(data, *groups[i]);
        if (file.empty()) continue;
        const Image strip = band(load_image(file), i, groups.size());
        pictures.push_back({std::to_string(spp(groups[i])) + " spp", picture_url(strip, data)});
    }
    return pictures;
}

}  // namespace

std::vector<LabelledPicture> figure_pictures(const ReportData& data, const Figure& figure) {
    switch (figure.kind) {
        case FigureKind::reference:
            return reference_pictures(data);
        case FigureKind::light:
            return light_pictures(data, figure);
        case FigureKind::strips:
            return strip_pictures(data, figure);
        case FigureKind::mosaic:
            break;
    }
    return {};
}

}  // namespace vecino
