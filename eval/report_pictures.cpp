// SPDX-License-Identifier: Apache-2.0
#include "eval/report_pictures.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <vector>

#include "core/files.h"
#include "core/image_io.h"
#include "core/parallel.h"
#include "eval/error_map.h"
#include "eval/html_text.h"

namespace vecino {
namespace {

/// A cell with an image, and what was found in its maps.
// Image and two maps as PNG in base64, of path-traced grain, as measured at 512x512.
constexpr double kBytesPerPixel = 4.3;
constexpr double kMostBytes = 72e6;

struct MapJob {
    std::string cell;
    std::string folder;
    std::string linked_folder;         ///< the same, as the page names it
    const Image* reference = nullptr;  ///< display values, as all that is compared here
    GroupPictures* shown = nullptr;    ///< of the group that this cell stands for
    bool is_embedded = true;           ///< its pictures, into the page
    float magnitude_range = 0;
    float sign_range = 0;
    bool has_non_finite = false;
};

using References = std::map<std::string, Image>;  ///< display values, by file

void load_reference(const ReportData& data, const std::string& file, References& references,
                    ReportPictures& pictures) {
    if (references.contains(file)) return;
    const std::string path = data.directory + "/" + file;
    references[file] = display_image(load_image(path + ".exr"));
    pictures.sizes[file] = references[file].size();
    if (std::filesystem::exists(path + ".png")) {
        pictures.references[file] = png_url(read_file(path + ".png"));
    }
}

/// The first finished cell with an image; else the first with one.
std::string shown_cell(const ReportData& data, const GroupSummary& group) {
    std::string shown;
    for (const std::string& cell : group.cells) {
        if (!std::filesystem::exists(data.directory + "/cells/" + cell + "/image.exr")) continue;
        if (data.row_of(cell)["status"] == "ok") return cell;
        if (shown.empty()) shown = cell;
    }
    return shown;
}

std::vector<MapJob> map_jobs(const ReportData& data, References& references,
                             ReportPictures& pictures) {
    std::vector<MapJob> jobs;
    for (const GroupSummary& group : data.groups) {
        const std::string shown = shown_cell(data, group);
        for (const std::string& cell : group.cells) {
            const std::string folder = data.directory + "/cells/" + cell + "/";
            const std::string file = data.row_of(cell).value("reference_file", "");
            if (file.empty() || !std::filesystem::exists(folder + "image.exr")) continue;
            load_reference(data, file, references, pictures);
            MapJob job{cell, folder, "cells/" + cell + "/", &references.at(file)};
            if (cell == shown) {
                job.shown = &pictures.by_group[group.group];
                job.shown->cell = cell;
            }
            jobs.push_back(std::move(job));
        }
    }
    return jobs;
}

/// Groups whose pictures the page shows more than once.
std::set<std::string> groups_in_figures(const ReportData& data) {
    std::set<std::string> names;
    if (!data.reproduction) return names;
    const Reproduction& specification = data.reproduction->specification;
    for (const Figure& figure : specification.figures) {
        for (const Selection& selection : figure.of) {
            for (const auto* group : select(data.groups, selection, specification.variants.front()))
                names.insert(group->group);
        }
    }
    return names;
}

/// Pictures go into the page until it is as large as a browser opens with ease; those of figures
/// first. The rest stays beside it.
void choose_embedded(const ReportData& data, std::vector<MapJob>& jobs) {
    const std::set<std::string> preferred = groups_in_figures(data);
    double bytes = 0;
    for (const bool in_figures : {true, false}) {
        for (MapJob& job : jobs) {
            if (job.shown == nullptr) continue;
            const std::string group = data.row_of(job.cell)["group"];
            if (preferred.contains(group) != in_figures) continue;
            bytes += kBytesPerPixel * static_cast<double>(job.reference->size().area());
            job.is_embedded = bytes <= kMostBytes;
        }
    }
}

void for_each_job(std::vector<MapJob>& jobs, const std::function<void(MapJob&)>& body) {
    for_each_block(jobs.size(), 1, 0, [&](BlockRange block) { body(jobs[block.begin]); });
}

void measure(MapJob& job) {
    const Image image = display_image(load_image(job.folder + "image.exr"));
    const Grid<float> magnitude = display_error_values(image, *job.reference, ErrorKind::magnitude);
    job.magnitude_range = suggested_range(magnitude);
    job.sign_range = suggested_range(display_error_values(image, *job.reference, ErrorKind::sign));
    job.has_non_finite =
        !std::ranges::all_of(magnitude.values(), [](float value) { return std::isfinite(value); });
}

/// Into the page, or as a file beside it that the page names.
std::string raster_url(const Grid<glm::u8vec3>& raster, const MapJob& job,
                       const std::string& name) {
    if (!job.is_embedded) {
        save_raster(raster, job.folder + name);
        return job.linked_folder + name;
    }
    const TemporaryFile file(job.folder + "map.png");
    save_raster(raster, file.path());
    return png_url(read_file(file.path()));
}

/// Returns the URL of the bare map, if it is to be shown.
std::string draw_map(const MapJob& job, const Image& image, const ErrorPictureStyle& style) {
    const Grid<float> values = display_error_values(image, *job.reference, style.kind);
    const bool is_signed = style.kind == ErrorKind::sign;
    save_raster(error_picture(values, style),
                job.folder + (is_signed ? "error_signed.png" : "error.png"));
    if (job.shown == nullptr) return "";
    return raster_url(error_colours(values, style), job, is_signed ? "map_signed.png" : "map.png");
}

void draw_maps(const MapJob& job, const ReportPictures& pictures) {
    // Loaded again, not kept since measure(): a matrix may hold more images than memory does.
    const Image image = display_image(load_image(job.folder + "image.exr"));
    const std::string magnitude =
        draw_map(job, image, {ErrorKind::magnitude, pictures.magnitude_range, job.cell});
    const std::string sign = draw_map(job, image, {ErrorKind::sign, pictures.sign_range, job.cell});
    if (job.shown == nullptr) return;
    job.shown->magnitude = magnitude;
    job.shown->sign = sign;
    const std::string png = job.folder + "image.png";
    if (!std::filesystem::exists(png)) return;
    job.shown->image = job.is_embedded ? png_url(read_file(png)) : job.linked_folder + "image.png";
}

void add_figure_pictures(const ReportData& data, ReportPictures& pictures) {
    if (!data.reproduction) return;
    for (const Figure& figure : data.reproduction->specification.figures) {
        if (figure.kind == FigureKind::mosaic) continue;
        pictures.figures[figure.id] = figure_pictures(data, figure);
    }
}

}  // namespace

ReportPictures make_report_pictures(const ReportData& data) {
    ReportPictures pictures;
    add_figure_pictures(data, pictures);
    References references;
    std::vector<MapJob> jobs = map_jobs(data, references, pictures);
    choose_embedded(data, jobs);
    pictures.has_linked =
        std::ranges::any_of(jobs, [](const MapJob& job) { return !job.is_embedded; });
    for_each_job(jobs, measure);
    std::vector<float> magnitude_ranges;
    std::vector<float> sign_ranges;
    for (const MapJob& job : jobs) {
        magnitude_ranges.push_back(job.magnitude_range);
        sign_ranges.push_back(job.sign_range);
        pictures.has_non_finite = pictures.has_non_finite || job.has_non_finite;
    }
    if (jobs.empty()) return pictures;
    pictures.magnitude_range = shared_range(magnitude_ranges);
    pictures.sign_range = shared_range(sign_ranges);
    for_each_job(jobs, [&](const MapJob& job) { draw_maps(job, pictures); });
    return pictures;
}

}  // namespace vecino
