// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <filesystem>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/image_io.h"
#include "eval/commands.h"
#include "eval/pixel_values.h"
#include "eval/report_raster.h"
#include "eval/report_sections.h"
#include "eval/text.h"

namespace vecino {
namespace {

constexpr int kPanel = 200;  // the longer side of a picture, in pixels
constexpr int kGap = 10;
constexpr int kCaption = 46;
constexpr int kColumns = 4;
constexpr glm::u8vec3 kInk{34, 34, 34};
constexpr glm::u8vec3 kSoftInk{96, 96, 96};
constexpr glm::u8vec3 kPaper{255, 255, 255};

struct Panel {
    Image image;
    std::string title, numbers;
};

cv::Mat view(Grid<glm::u8vec3>& raster) {
    return {raster.size().height, raster.size().width, CV_8UC3, raster.values().data()};
}

/// As a screen shows it, reduced to a panel's size.
Grid<glm::u8vec3> thumbnail(const Image& image) {
    Grid<glm::u8vec3> encoded(image.size());
    for (std::size_t i = 0; i < image.values().size(); ++i) {
        const glm::vec3 value = display_value(image.values()[i]);
        encoded.values()[i] = glm::u8vec3(255.0f * value + 0.5f);
    }
    const int longer = std::max(image.size().width, image.size().height);
    const auto side = [&](int length) { return std::max(1, length * kPanel / longer); };
    Grid<glm::u8vec3> small({side(image.size().width), side(image.size().height)});
    const int method = longer > kPanel ? cv::INTER_AREA : cv::INTER_NEAREST;
    cv::resize(view(encoded), view(small), {small.size().width, small.size().height}, 0, 0, method);
    return small;
}

std::string numbers_text(const ReportData& data, const GroupSummary& group) {
    std::string text = psnr_float_text(data, group) + " dB";
    if (group.time_s > 0)
        text += ", " + number_text(group.time_s, group.time_s < 10 ? 2 : 0) + " s";
    return text;
}

/// Of the first finished seed; an empty one where there is none.
Image finished_image(const ReportData& data, const GroupSummary& group) {
    for (const std::string& cell : group.cells) {
        const std::string file = data.directory + "/cells/" + cell + "/image.exr";
        if (data.row_of(cell)["status"] == "ok" && std::filesystem::exists(file))
            return load_image(file);
    }
    return {};
}

std::vector<Panel> panels_of(const ReportData& data, const Figure& figure) {
    const Variant& variant = data.reproduction->specification.variants.front();
    std::vector<Panel> panels;
    for (const Selection& selection : figure.of) {
        for (const GroupSummary* group : select(data.groups, selection, variant)) {
            Image image = finished_image(data, *group);
            if (image.empty()) continue;
            const std::string reference = data.row_of(group->cells.front())["reference_file"];
            const std::string file = data.directory + "/" + reference + ".exr";
            if (panels.empty() && std::filesystem::exists(file))
                panels.push_back({load_image(file), "reference", group->scene});
            panels.push_back({std::move(image), short_name(*group), numbers_text(data, *group)});
        }
    }
    return panels;
}

void draw_panel(Grid<glm::u8vec3>& picture, const Panel& panel, glm::ivec2 corner) {
    Grid<glm::u8vec3> small = thumbnail(panel.image);
    const cv::Rect place(corner.x, corner.y, small.size().width, small.size().height);
    view(small).copyTo(view(picture)(place));
    const TextStyle name{8.0, kInk, false};
    const TextStyle numbers{8.0, kSoftInk, false};
    const auto lines = wrap_text(panel.title, {kPanel, 2}, name);
    int y = corner.y + kPanel + 14;
    for (const std::string& line : lines) {
        draw_text(picture, line, {corner.x, y}, name);
        y += 14;
    }
    draw_text(picture, panel.numbers, {corner.x, y}, numbers);
}

}  // namespace

Grid<glm::u8vec3> mosaic_raster(const ReportData& data, const std::string& id) {
    std::vector<std::string_view> known;
    const Figure* chosen = nullptr;
    if (data.reproduction) {
        for (const Figure& figure : data.reproduction->specification.figures) {
            if (figure.kind != FigureKind::mosaic) continue;
            known.push_back(figure.id);
            if (figure.id == id) chosen = &figure;
        }
    }
    if (chosen == nullptr)
        throw Error(ExitCode::usage,
                    "command line: --figure: found \"" + id + "\", allowed: " +
                        (known.empty() ? "none, the matrix has no mosaic" : join(known)));
    const std::vector<Panel> panels = panels_of(data, *chosen);
    if (panels.empty())
        throw Error(ExitCode::file, data.directory + ": holds no image of the figure " + id);
    const int count = static_cast<int>(panels.size());
    const int columns = std::min(count, kColumns);
    const int rows = (count + columns - 1) / columns;
    Grid<glm::u8vec3> picture(
        {columns * (kPanel + kGap) + kGap, rows * (kPanel + kCaption + kGap) + kGap}, kPaper);
    for (int i = 0; i < count; ++i) {
        draw_panel(picture, panels[static_cast<std::size_t>(i)],
                   {kGap + i % columns * (kPanel + kGap),
                    kGap + i / columns * (kPanel + kCaption + kGap)});
    }
    return picture;
}

}  // namespace vecino
