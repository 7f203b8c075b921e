// SPDX-License-Identifier: Apache-2.0
//
// The pictures of the report: a card per group with its image and error maps, the reference of each
// scene, and the colour bars that all maps share.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "eval/commands.h"
#include "eval/error_map.h"
#include "eval/html_text.h"
#include "eval/report_sections.h"

namespace vecino {
namespace {

// Images up to this size are shown larger than they are: with square pixels, not blurred.
constexpr int kSmallSide = 192;
constexpr int kBarColours = 65;

std::string hex_colour(glm::u8vec3 colour) {
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", unsigned{colour.r}, unsigned{colour.g},
                  unsigned{colour.b});
    return text;
}

/// Colours of a map from the lower end of its range to the upper one.
std::string gradient(const ErrorPictureStyle& style) {
    const float low = style.kind == ErrorKind::sign ? -style.range : 0.0f;
    Grid<float> ramp({kBarColours, 1});
    for (int i = 0; i < kBarColours; ++i) {
        const float t = static_cast<float>(i) / (kBarColours - 1);
        ramp(i, 0) = low * (1 - t) + style.range * t;
    }
    const Grid<glm::u8vec3> colours = error_colours(ramp, style);
    std::string list;
    for (const glm::u8vec3 colour : colours.values()) list += "," + hex_colour(colour);
    return "linear-gradient(to right" + list + ")";
}

std::string tick(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", std::abs(value));
    return text;
}

struct ColourBar {
    ErrorPictureStyle style;
    const char* id;
    const char* name;
    const char* picture_of;  ///< for those who hear the page
};

std::string bar_html(const ColourBar& bar) {
    const auto range = static_cast<double>(bar.style.range);
    std::vector<std::string> ticks{"0", tick(range / 2), "≥ " + tick(range)};
    if (bar.style.kind == ErrorKind::sign) {
        ticks = {"≤ −" + tick(range), "0", "≥ +" + tick(range)};
    }
    std::string html = "<div class=\"bar\" id=\"" + std::string(bar.id) + "\"><span class=\"of\">" +
                       bar.name + "</span><span class=\"colours\" role=\"img\" aria-label=\"" +
                       bar.picture_of + "\" style=\"background-image:" + gradient(bar.style) +
                       "\"></span><span class=\"ticks\">";
    for (const std::string& text : ticks) html += "<span>" + text + "</span>";
    return html + "</span></div>\n";
}

struct Shot {
    int view;  ///< the key that shows it in the viewer
    const char* name;
    const std::string& url;
};

std::string shot_html(const Shot& shot, const std::string& of, Extent size) {
    const std::string name = shot.name;
    if (shot.url.empty()) {
        return "<div class=\"shot none\"><span>no picture</span><small>" + name + "</small></div>";
    }
    const bool is_small = std::max(size.width, size.height) <= kSmallSide;
    return "<button type=\"button\" class=\"shot\" data-view=\"" + std::to_string(shot.view) +
           "\"><img" + (is_small ? " class=\"small\"" : "") + " alt=\"" + name + " of " +
           escaped(of) + "\" width=\"" + std::to_string(size.width) + "\" height=\"" +
           std::to_string(size.height) + "\" loading=\"lazy\" decoding=\"async\" src=\"" +
           shot.url + "\"><small>" + name + "</small></button>";
}

std::string psnr_html(const ReportData& data, const GroupSummary& group) {
    const std::string interval = psnr_float_interval(group);
    std::string html = "<span><b>" + psnr_float_text(data, group) + "</b>";
    if (!interval.empty()) html += " " + interval;
    return html + (group.psnr_float_db ? " dB</span>" : "</span>");
}

std::string key_numbers(const ReportData& data, const GroupSummary& group) {
    if (group.seeds == 0) return "<span class=\"failed\">failed</span>";
    std::string html = psnr_html(data, group);
    if (group.ssim) html += " <span>ssim " + number_text(group.ssim->mean, 4) + "</span>";
    if (group.relmse) {
        html +=
            " <span>relmse " + number_text(group.relmse->mean, data.relmse_decimals) + "</span>";
    }
    if (!(group.time_s > 0)) return html;  // not known
    html += " <span>" + number_text(group.time_s, data.time_decimals) + " s";
    if (group.time_share > 0) html += " (" + number_text(100 * group.time_share, 1) + " % of path)";
    return html + "</span>";
}

class Cards {
  public:
    Cards(const ReportData& data, const ReportPictures& pictures)
        : data_(data), pictures_(pictures) {
        for (const auto& [file, url] : pictures.references) {
            reference_ids_.emplace(file, "r" + std::to_string(reference_ids_.size()));
        }
    }

    std::string run() {
        std::string html;
        for (const std::string& scene : data_.scenes) {
            html +=
                "<section class=\"scene\"><h3>" + escaped(scene) + "</h3>\n<div class=\"cards\">\n";
            for (const auto& [file, id] : reference_ids_) {
                const nlohmann::json* row = row_with(file, scene);
                if (row != nullptr) html += reference_card(file, *row);
            }
            for (std::size_t i = 0; i < data_.groups.size(); ++i) {
                if (data_.groups[i].scene == scene) html += card(i);
            }
            html += "</div></section>\n";
        }
        return html;
    }

  private:
    /// A row that was held against a reference; null if none of the scene was.
    const nlohmann::json* row_with(const std::string& reference_file,
                                   const std::string& scene) const {
        const auto row = std::ranges::find_if(data_.rows, [&](const nlohmann::json& each) {
            return each["scene"] == scene && each.value("reference_file", "") == reference_file;
        });
        return row == data_.rows.end() ? nullptr : &*row;
    }

    std::string reference_card(const std::string& file, const nlohmann::json& row) const {
        const Shot shot{2, "reference", pictures_.references.at(file)};
        const std::string scene = row["scene"];
        return "<article class=\"card\" id=\"" + reference_ids_.at(file) +
               "\"><h4>Reference</h4>\n<div class=\"shots\">" +
               shot_html(shot, scene, pictures_.sizes.at(file)) + "<p class=\"about\">" +
               escaped(reference_text(row)) + "<br>" + escaped(file) + ".exr</p></div></article>\n";
    }

    std::string card(std::size_t index) const {
        const GroupSummary& group = data_.groups[index];
        const auto found = pictures_.by_group.find(group.group);
        const GroupPictures shown =
            found == pictures_.by_group.end() ? GroupPictures{} : found->second;
        const std::string cell = shown.cell.empty() ? group.cells.front() : shown.cell;
        const std::string file = data_.row_of(cell).value("reference_file", "");
        const auto size = pictures_.sizes.find(file);
        const Extent extent = size == pictures_.sizes.end() ? Extent{} : size->second;
        const auto reference = reference_ids_.find(file);

        std::string html = "<article class=\"card\" id=\"g" + std::to_string(index) +
                           "\" data-name=\"" + escaped(group.group) + "\" data-reference=\"" +
                           (reference == reference_ids_.end() ? "" : reference->second) +
                           "\"><h4>" + marker_html(data_.style_of(group.method)) +
                           escaped(short_name(group)) + "</h4>\n<div class=\"shots\">";
        for (const Shot& shot :
             {Shot{1, "image", shown.image}, Shot{3, "magnitude", shown.magnitude},
              Shot{4, "signed", shown.sign}}) {
            html += shot_html(shot, group.group, extent);
        }
        return html + "</div>\n<p class=\"key\">" + key_numbers(data_, group) + "</p></article>\n";
    }

    const ReportData& data_;
    const ReportPictures& pictures_;
    std::map<std::string, std::string> reference_ids_;  ///< of the page, by reference file
};

}  // namespace

std::string colour_bars_html(const ReportPictures& pictures) {
    if (!(pictures.magnitude_range > 0)) return "";
    const ColourBar magnitude{{ErrorKind::magnitude, pictures.magnitude_range, ""},
                              "bar-3",
                              "magnitude, display value (sRGB, 0 to 1)",
                              "colour bar: dark is no error, light is a large one"};
    const ColourBar sign{{ErrorKind::sign, pictures.sign_range, ""},
                         "bar-4",
                         "signed, image − reference, display value",
                         "colour bar: blue is darker than the reference, red is lighter"};
    std::string html = "<div class=\"bars\">" + bar_html(magnitude) + bar_html(sign);
    if (pictures.has_non_finite) {
        const ErrorPictureStyle& style = magnitude.style;
        const Grid<float> nan({1, 1}, std::nanf(""));
        html +=
            "<div class=\"bar nan\"><span class=\"of\">not finite</span><span class=\"colours\" "
            "style=\"background:" +
            hex_colour(error_colours(nan, style)(0, 0)) + "\"></span></div>";
    }
    return html + "</div>";
}

std::string cards_html(const ReportData& data, const ReportPictures& pictures) {
    return Cards(data, pictures).run();
}

}  // namespace vecino
