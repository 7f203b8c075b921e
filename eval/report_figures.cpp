// SPDX-License-Identifier: Apache-2.0
//
// The figures of a publication, made again: mosaics of a run's pictures with their error maps.
#include <algorithm>
#include <map>

#include "eval/commands.h"
#include "eval/html_text.h"
#include "eval/report_sections.h"

namespace vecino {
namespace {

/// A picture that stands on the page already, in the card of its group: script fills it in, so that
/// no picture is in the file twice.
std::string borrowed_shot(const std::string& id, int view, const std::string& alt) {
    return "<button type=\"button\" class=\"shot\" data-view=\"" + std::to_string(view) +
           "\" data-of=\"" + id + "\"><img alt=\"" + escaped(alt) + "\" loading=\"lazy\"></button>";
}

std::string group_panel(const ReportData& data, const GroupSummary& group) {
    const std::string id = "g" + std::to_string(index_of(data, group));
    std::string html = "<div class=\"panel\"><div class=\"pair\">" +
                       borrowed_shot(id, 1, "image of " + group.group) +
                       borrowed_shot(id, 3, "error of " + group.group) + "</div><a href=\"#" + id +
                       "\">" + escaped(group.group) + "</a>";
    const std::string psnr = psnr_float_text(data, group);
    const auto& interior = group.region_psnr_float_db[region_index(Region::interior)];
    html += "<small>" + psnr + " dB";
    if (interior) html += ", interior " + number_text(interior->mean, 2) + " dB";
    return html + "</small></div>\n";
}

std::string mosaic(const ReportData& data, const Figure& figure) {
    const Variant& variant = data.reproduction->specification.variants.front();
    // By parameters first, so that the same ones of all scenes stand side by side.
    std::vector<const GroupSummary*> panels;
    std::map<std::string, std::size_t> rank;
    for (const Selection& selection : figure.of) {
        for (const GroupSummary* group : select(data.groups, selection, variant)) {
            rank.try_emplace(short_name(*group), panels.size());
            panels.push_back(group);
        }
    }
    std::ranges::stable_sort(
        panels, {}, [&](const GroupSummary* group) { return rank.at(short_name(*group)); });
    std::string html = "<div class=\"mosaic\">";
    for (const GroupSummary* group : panels) html += group_panel(data, *group);
    if (panels.empty()) html += "<p class=\"note\">No result of this run belongs here.</p>";
    return html + "</div>";
}

std::string picture_panel(const LabelledPicture& picture) {
    return "<div class=\"panel\"><img class=\"whole\" alt=\"" + escaped(picture.label) +
           "\" loading=\"lazy\" src=\"" + picture.url + "\"><small>" + escaped(picture.label) +
           "</small></div>\n";
}

std::string drawn(const Figure& figure, const ReportPictures& pictures) {
    const auto found = pictures.figures.find(figure.id);
    if (found == pictures.figures.end() || found->second.empty())
        return "<p class=\"note\">No result of this run belongs here.</p>";
    std::string html = "<div class=\"mosaic\">";
    for (const LabelledPicture& picture : found->second) html += picture_panel(picture);
    return html + "</div>";
}

/// Horizontal bands of one picture, each with its label at the left.
std::string bands(const Figure& figure, const ReportPictures& pictures) {
    const auto found = pictures.figures.find(figure.id);
    if (found == pictures.figures.end() || found->second.empty())
        return "<p class=\"note\">No result of this run belongs here.</p>";
    std::string html = "<div class=\"bands\">";
    for (const LabelledPicture& picture : found->second) {
        html += "<div><img alt=\"\" src=\"" + picture.url + "\"><span>" + escaped(picture.label) +
                "</span></div>\n";
    }
    return html + "</div>";
}

std::string figure_html(const ReportData& data, const ReportPictures& pictures,
                        const Figure& figure) {
    std::string body;
    switch (figure.kind) {
        case FigureKind::mosaic:
            body = mosaic(data, figure);
            break;
        case FigureKind::strips:
            body = bands(figure, pictures);
            break;
        case FigureKind::reference:
        case FigureKind::light:
            body = drawn(figure, pictures);
    }
    return "<figure class=\"figure\" id=\"" + escaped(figure.id) + "\"><figcaption>" +
           escaped(figure.title) + "</figcaption>\n" + body + "</figure>\n";
}

}  // namespace

std::string figures_html(const ReportData& data, const ReportPictures& pictures) {
    if (!data.reproduction || data.reproduction->specification.figures.empty()) return "";
    std::string html =
        "<section id=\"figures\">\n<h2>Figures</h2>\n<p class=\"note\">Each image with its error "
        "map; all maps share the range of the colour bar under Pictures. <span class=\"js-only\">A "
        "click enlarges.</span></p>\n<noscript><p class=\"note\">The mosaics need JavaScript; "
        "their pictures stand below.</p></noscript>\n";
    for (const Figure& figure : data.reproduction->specification.figures)
        html += figure_html(data, pictures, figure);
    return html + "</section>\n";
}

}  // namespace vecino
