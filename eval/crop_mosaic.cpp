// SPDX-License-Identifier: Apache-2.0
#include "eval/crop_mosaic.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/image_io.h"
#include "eval/cell_vti.h"
#include "eval/colour_map.h"
#include "eval/commands.h"
#include "eval/metrics.h"
#include "eval/pixel_values.h"
#include "eval/text.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

// Twice the size at which it is read, for print and for screens that have as many pixels.
constexpr int kScale = 2;
constexpr int kCropWidth = 130 * kScale;
constexpr int kWholeWidth = 170 * kScale;
constexpr int kLeastRows = 230 * kScale;  // less is enlarged to it
constexpr double kMostEnlarged = 1.6;
constexpr int kGap = 3 * kScale;
constexpr int kMargin = 8 * kScale;
constexpr int kLine = 14 * kScale;
constexpr int kFrame = 2 * kScale;
constexpr std::size_t kNameLines = 3;
constexpr std::size_t kMostResults = 12;
constexpr glm::u8vec3 kInk{26, 29, 33};
constexpr glm::u8vec3 kSoftInk{90, 99, 112};
constexpr glm::u8vec3 kPaper{255, 255, 255};
// Okabe and Ito's, which differ without colour vision, too.
constexpr glm::u8vec3 kFrameColours[] = {{230, 159, 0},  {86, 180, 233}, {0, 158, 115},
                                         {240, 228, 66}, {213, 94, 0},   {204, 121, 167}};

TextStyle name_style() {
    return {8.0 * kScale, kInk, false};
}

cv::Scalar scalar(glm::u8vec3 colour) {
    return {double(colour.r), double(colour.g), double(colour.b)};
}

cv::Mat view(Grid<glm::u8vec3>& raster) {
    return {raster.size().height, raster.size().width, CV_8UC3, raster.values().data()};
}

/// One column: an image and what stands above and below it.
struct Entry {
    std::string name;
    Grid<glm::u8vec3> picture;
    std::vector<std::optional<double>> values;  ///< by metric
};

struct Block {
    std::string scene;
    Entry reference;
    std::vector<Entry> results;
};

Grid<glm::u8vec3> as_shown(const Image& image) {
    Grid<glm::u8vec3> shown(image.size(), kNonFiniteColour);
    for (std::size_t i = 0; i < image.values().size(); ++i) {
        const glm::vec3& value = image.values()[i];
        if (is_finite(value)) shown.values()[i] = glm::u8vec3(255.0f * display_value(value) + 0.5f);
    }
    return shown;
}

std::optional<double> metric_value(const Json& row, const std::string& metric) {
    const Json value = metric == "time_s" ? row["time_s"].value("total", Json())
                                          : row["metrics"].value(metric, Json());
    // Ceilings take no time, for nobody could make them.
    if (!value.is_number() || (metric == "time_s" && !(value > 0))) return std::nullopt;
    return value.get<double>();
}

std::string value_text(const std::string& metric, const std::optional<double>& value) {
    if (!value) return "-";
    if (metric.ends_with("_db")) return number_text(*value, 2);
    if (metric.find("ssim") != std::string::npos) return number_text(*value, 4);
    char text[40];
    std::snprintf(text, sizeof text, "%#.3g", *value);  // 0.290, to stand below 0.279
    std::string digits = text;
    if (digits.ends_with('.')) digits.pop_back();
    return digits;
}

bool is_higher_better(const std::string& metric) {
    const auto found = std::ranges::find(all_metrics(), metric, &MetricInfo::name);
    return found != all_metrics().end() && found->higher_is_better;
}

void require_known(const std::vector<std::string>& metrics) {
    const std::vector<std::string> known = mosaic_metrics();
    for (const std::string& metric : metrics) {
        if (std::ranges::find(known, metric) != known.end()) continue;
        std::string allowed;
        for (const std::string& name : known) allowed += (allowed.empty() ? "" : ", ") + name;
        throw Error(ExitCode::usage,
                    "command line: --metric: found \"" + metric + "\", allowed: " + allowed);
    }
}

void require_inside(const std::vector<Crop>& crops, Extent image, const std::string& scene) {
    for (const Crop& crop : crops) {
        // In 64 bits: a crop may be as large as an int says.
        const bool is_inside = crop.x + std::int64_t{crop.width} <= image.width &&
                               crop.y + std::int64_t{crop.height} <= image.height;
        if (is_inside) continue;
        throw Error(ExitCode::usage, "command line: --crop: found one that ends at " +
                                         std::to_string(crop.x + std::int64_t{crop.width}) + "," +
                                         std::to_string(crop.y + std::int64_t{crop.height}) +
                                         ", allowed: within the image of " + scene + ", " +
                                         size_text(image));
    }
}

Block& block_of(const ReportData& data, const Json& row, const MosaicOptions& options,
                std::vector<Block>& blocks) {
    const std::string scene = row["scene"];
    const auto known = std::ranges::find(blocks, scene, &Block::scene);
    if (known != blocks.end()) return *known;
    const std::string file = data.directory + "/" + row.value("reference_file", "") + ".exr";
    // Where there is an overview, the scene's name stands below it.
    const std::string name = options.crops.empty() ? scene + ", reference" : "reference";
    blocks.push_back({scene, {name, as_shown(load_image(file)), {}}, {}});
    return blocks.back();
}

std::vector<Block> blocks_of(const ReportData& data, const std::vector<const Json*>& rows,
                             const MosaicOptions& options) {
    std::vector<Block> blocks;
    std::set<std::string> groups;
    for (const Json* row : rows) {
        if ((*row)["status"] != "ok" || !has_images(data, *row)) continue;
        if (!groups.insert((*row)["group"]).second) continue;
        Block& block = block_of(data, *row, options, blocks);
        const std::string file = data.directory + "/cells/" + (*row)["cell"].get<std::string>();
        const auto group = std::ranges::find(data.groups, (*row)["group"].get<std::string>(),
                                             &GroupSummary::group);
        Entry entry{short_name(*group), as_shown(load_image(file + "/image.exr")), {}};
        for (const std::string& metric : options.metrics)
            entry.values.push_back(metric_value(*row, metric));
        block.results.push_back(std::move(entry));
        if (block.results.size() > kMostResults)
            throw Error(ExitCode::usage, "command line: --only: found more than " +
                                             std::to_string(kMostResults) + " results of " +
                                             block.scene + ", allowed: at most as many");
    }
    if (blocks.empty())
        throw Error(ExitCode::file, data.directory + ": holds no image of the cells asked for");
    return blocks;
}

/// Where things lie in a block, in pixels.
struct Layout {
    std::vector<Crop> crops;  ///< the whole image where none was asked for
    bool has_overview = false;
    int column = 0;            ///< width
    std::vector<int> heights;  ///< of the rows
    int rows_height = 0;
    cv::Size overview;
    std::size_t name_lines = 1;
    std::size_t metrics = 0;

    [[nodiscard]] int columns_left() const {
        return kMargin + (has_overview ? overview.width + 2 * kGap : 0);
    }
    [[nodiscard]] int left(std::size_t i) const {
        return columns_left() + static_cast<int>(i) * (column + kGap);
    }
    [[nodiscard]] int top() const {
        return kMargin / 2 + static_cast<int>(name_lines) * kLine + kGap;
    }
    [[nodiscard]] int height() const {
        return top() + rows_height + static_cast<int>(std::max<std::size_t>(metrics, 1)) * kLine +
               kMargin;
    }
};

std::vector<std::string> name_lines(const Entry& entry, int width) {
    return wrap_text(entry.name, {width, kNameLines}, name_style());
}

Layout layout_of(const Block& block, const MosaicOptions& options) {
    const Extent size = block.reference.picture.size();
    Layout layout;
    layout.has_overview = !options.crops.empty();
    layout.crops =
        layout.has_overview ? options.crops : std::vector{Crop{0, 0, size.width, size.height}};
    layout.metrics = options.metrics.size();
    const auto set_rows = [&](int width) {
        layout.column = width;
        layout.heights.clear();
        layout.rows_height = kGap * (static_cast<int>(layout.crops.size()) - 1);
        for (const Crop& crop : layout.crops) {
            layout.heights.push_back(
                std::max(1, cvRound(double(width) * crop.height / crop.width)));
            layout.rows_height += layout.heights.back();
        }
    };
    set_rows(layout.has_overview ? kCropWidth : kWholeWidth);
    if (layout.has_overview && layout.rows_height < kLeastRows) {
        const double larger =
            std::min(kMostEnlarged, double(kLeastRows) / double(layout.rows_height));
        set_rows(cvRound(kCropWidth * larger));
    }
    layout.overview = {std::max(1, cvRound(double(layout.rows_height) * size.width / size.height)),
                       layout.rows_height};
    layout.name_lines = name_lines(block.reference, layout.column).size();
    for (const Entry& entry : block.results)
        layout.name_lines = std::max(layout.name_lines, name_lines(entry, layout.column).size());
    return layout;
}

/// Pixels stay squares where a picture is enlarged so far that they are seen.
void draw_part(Grid<glm::u8vec3>& canvas, Grid<glm::u8vec3>& picture, const Crop& part,
               const cv::Rect& place) {
    const cv::Mat source = view(picture)({part.x, part.y, part.width, part.height});
    const bool is_reduced = place.width < part.width;
    const bool is_large = place.width >= 2 * part.width;
    const int method = is_reduced ? cv::INTER_AREA
                       : is_large ? cv::INTER_NEAREST
                                  : cv::INTER_LINEAR;
    cv::Mat target = view(canvas)(place);
    cv::resize(source, target, place.size(), 0, 0, method);
}

/// A frame within a place, with a dark line on both sides: it is seen on any picture.
void draw_frame(Grid<glm::u8vec3>& canvas, cv::Rect place, glm::u8vec3 colour) {
    cv::Mat target = view(canvas);
    const auto ring = [&](int inset, glm::u8vec3 ink) {
        cv::rectangle(
            target,
            {place.x + inset, place.y + inset, place.width - 2 * inset, place.height - 2 * inset},
            scalar(ink), 1);
    };
    ring(0, kInk);
    for (int i = 1; i <= kFrame; ++i) ring(i, colour);
    ring(kFrame + 1, kInk);
}

glm::u8vec3 frame_colour(std::size_t crop) {
    return kFrameColours[crop % std::size(kFrameColours)];
}

void draw_centred(Grid<glm::u8vec3>& canvas, const std::string& text, glm::ivec2 middle,
                  const TextStyle& style) {
    draw_text(canvas, text, {middle.x - text_width(text, style) / 2, middle.y}, style);
}

/// Where a crop lies in the overview; no smaller than its frame.
cv::Rect marker(const Crop& crop, const Layout& layout, Extent image, int top) {
    const auto along = [](int at, int from, int to) { return cvRound(double(at) * to / from); };
    const int least = 2 * kFrame + 4;
    const int width = std::max(least, along(crop.width, image.width, layout.overview.width));
    const int height = std::max(least, along(crop.height, image.height, layout.overview.height));
    const int x =
        std::min(along(crop.x, image.width, layout.overview.width), layout.overview.width - width);
    const int y = std::min(along(crop.y, image.height, layout.overview.height),
                           layout.overview.height - height);
    return {kMargin + std::max(0, x), top + std::max(0, y), width, height};
}

void draw_overview(Grid<glm::u8vec3>& canvas, Block& block, const Layout& layout, int top) {
    const Extent size = block.reference.picture.size();
    const int image_top = top + layout.top();
    draw_part(canvas, block.reference.picture, {0, 0, size.width, size.height},
              {{kMargin, image_top}, layout.overview});
    for (std::size_t i = 0; i < layout.crops.size(); ++i)
        draw_frame(canvas, marker(layout.crops[i], layout, size, image_top), frame_colour(i));
    draw_centred(canvas, block.scene,
                 {kMargin + layout.overview.width / 2, image_top + layout.rows_height + kLine},
                 name_style());
}

void draw_column(Grid<glm::u8vec3>& canvas, Entry& entry, const Layout& layout, glm::ivec2 corner) {
    const int middle = corner.x + layout.column / 2;
    const auto lines = name_lines(entry, layout.column);
    int y = corner.y + layout.top() - kGap - kLine / 4 - static_cast<int>(lines.size() - 1) * kLine;
    for (const std::string& line : lines) {
        draw_centred(canvas, line, {middle, y}, name_style());
        y += kLine;
    }
    y = corner.y + layout.top();
    for (std::size_t i = 0; i < layout.crops.size(); ++i) {
        const cv::Rect place(corner.x, y, layout.column, layout.heights[i]);
        draw_part(canvas, entry.picture, layout.crops[i], place);
        if (layout.has_overview) draw_frame(canvas, place, frame_colour(i));
        y += layout.heights[i] + kGap;
    }
}

/// The best number that a line shows.
std::string best_text(const Block& block, const std::string& metric, std::size_t index) {
    std::optional<double> best;
    for (const Entry& entry : block.results) {
        const std::optional<double>& value = entry.values[index];
        if (!value) continue;
        const bool is_better =
            !best || (is_higher_better(metric) ? *value > *best : *value < *best);
        if (is_better) best = value;
    }
    return value_text(metric, best);
}

void draw_labels(Grid<glm::u8vec3>& canvas, const Block& block, const MosaicOptions& options,
                 const Layout& layout, int top) {
    int y = top + layout.top() + layout.rows_height + kLine;
    for (std::size_t m = 0; m < options.metrics.size(); ++m, y += kLine) {
        const std::string& metric = options.metrics[m];
        const std::string best = best_text(block, metric, m);
        draw_centred(canvas, metric, {layout.left(0) + layout.column / 2, y},
                     {8.0 * kScale, kSoftInk, false});
        for (std::size_t i = 0; i < block.results.size(); ++i) {
            const std::string text = value_text(metric, block.results[i].values[m]);
            const bool is_best = block.results.size() > 1 && text == best && text != "-";
            draw_centred(canvas, text, {layout.left(i + 1) + layout.column / 2, y},
                         {8.0 * kScale, kInk, is_best});
        }
    }
}

}  // namespace

Crop parse_crop(const std::string& text) {
    Crop crop;
    int used = 0;
    const int read = std::sscanf(text.c_str(), "%9d,%9d,%9d,%9d%n", &crop.x, &crop.y, &crop.width,
                                 &crop.height, &used);
    const bool is_whole = read == 4 && static_cast<std::size_t>(used) == text.size();
    if (is_whole && crop.x >= 0 && crop.y >= 0 && crop.width > 0 && crop.height > 0) return crop;
    throw Error(ExitCode::usage,
                "command line: --crop: found \"" + text +
                    "\", allowed: X,Y,WIDTH,HEIGHT in pixels, such as 10,20,64,48");
}

std::vector<std::string> mosaic_metrics() {
    std::vector<std::string> names;
    for (const MetricInfo& metric : all_metrics()) names.emplace_back(metric.name);
    names.emplace_back("time_s");
    return names;
}

Grid<glm::u8vec3> crop_mosaic(const ReportData& data, const std::vector<const Json*>& rows,
                              const MosaicOptions& options) {
    require_known(options.metrics);
    std::vector<Block> blocks = blocks_of(data, rows, options);
    std::vector<Layout> layouts;
    Extent size;
    for (const Block& block : blocks) {
        require_inside(options.crops, block.reference.picture.size(), block.scene);
        for (const Entry& entry : block.results)
            require_inside(options.crops, entry.picture.size(), entry.name);
        layouts.push_back(layout_of(block, options));
        size.width =
            std::max(size.width, layouts.back().left(block.results.size() + 1) - kGap + kMargin);
        size.height += layouts.back().height();
    }
    Grid<glm::u8vec3> canvas(size, kPaper);
    int top = 0;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        const Layout& layout = layouts[b];
        if (layout.has_overview) draw_overview(canvas, blocks[b], layout, top);
        draw_column(canvas, blocks[b].reference, layout, {layout.left(0), top});
        for (std::size_t i = 0; i < blocks[b].results.size(); ++i)
            draw_column(canvas, blocks[b].results[i], layout, {layout.left(i + 1), top});
        draw_labels(canvas, blocks[b], options, layout, top);
        top += layout.height();
    }
    return canvas;
}

}  // namespace vecino
