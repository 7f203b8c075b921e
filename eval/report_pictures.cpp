// SPDX-License-Identifier: Apache-2.0
#include "eval/report_pictures.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/files.h"
#include "core/image_io.h"
#include "core/parallel.h"
#include "eval/error_map.h"
#include "eval/html_text.h"

namespace vecino {
namespace {

/// A cell with an image, and what was found in its maps.
struct MapJob {
    std::string cell;
    std::string folder;
    const Image* reference = nullptr;
    GroupPictures* shown = nullptr;  ///< of the group that this cell stands for
    float magnitude_range = 0;
    float sign_range = 0;
    bool has_non_finite = false;
};

using References = std::map<std::string, Image>;

void load_reference(const ReportData& data, const std::string& file, References& references,
                    ReportPictures& pictures) {
    if (references.contains(file)) return;
    const std::string path = data.directory + "/" + file;
    references[file] = load_image(path + ".exr");
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
            MapJob job{cell, folder, &references.at(file)};
            if (cell == shown) {
                job.shown = &pictures.by_group[group.group];
                job.shown->cell = cell;
            }
            jobs.push_back(std::move(job));
        }
    }
    return jobs;
}

void for_each_job(std::vector<MapJob>& jobs, const std::function<void(MapJob&)>& body) {
    for_each_block(jobs.size(), 1, 0, [&](BlockRange block) { body(jobs[block.begin]); });
}

void measure(MapJob& job) {
    const Image image = load_image(job.folder + "image.exr");
    const Grid<float> magnitude = error_values(image, *job.reference, ErrorKind::magnitude);
    job.magnitude_range = suggested_range(magnitude);
    job.sign_range = suggested_range(error_values(image, *job.reference, ErrorKind::sign));
    job.has_non_finite =
        !std::ranges::all_of(magnitude.values(), [](float value) { return std::isfinite(value); });
}

std::string raster_url(const Grid<glm::u8vec3>& raster, const std::string& folder) {
    const TemporaryFile file(folder + "map.png");
    save_raster(raster, file.path());
    return png_url(read_file(file.path()));
}

/// Returns the URL of the bare map, if it is to be shown.
std::string draw_map(const MapJob& job, const Image& image, const ErrorPictureStyle& style) {
    const Grid<float> values = error_values(image, *job.reference, style.kind);
    const char* name = style.kind == ErrorKind::sign ? "error_signed.png" : "error.png";
    save_raster(error_picture(values, style), job.folder + name);
    return job.shown == nullptr ? "" : raster_url(error_colours(values, style), job.folder);
}

void draw_maps(const MapJob& job, const ReportPictures& pictures) {
    // Loaded again, not kept since measure(): a matrix may hold more images than memory does.
    const Image image = load_image(job.folder + "image.exr");
    const std::string magnitude =
        draw_map(job, image, {ErrorKind::magnitude, pictures.magnitude_range, job.cell});
    const std::string sign = draw_map(job, image, {ErrorKind::sign, pictures.sign_range, job.cell});
    if (job.shown == nullptr) return;
    job.shown->magnitude = magnitude;
    job.shown->sign = sign;
    const std::string png = job.folder + "image.png";
    if (std::filesystem::exists(png)) job.shown->image = png_url(read_file(png));
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
