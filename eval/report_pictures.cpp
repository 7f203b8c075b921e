// SPDX-License-Identifier: Apache-2.0
#include "eval/report_pictures.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <vector>

#include "core/error.h"
#include "core/files.h"
#include "core/image_io.h"
#include "core/parallel.h"
#include "eval/error_map.h"
#include "eval/html_text.h"

namespace vecino {
namespace {

// Image and two maps as PNG in base64, of path-traced grain, as measured at 512x512.
constexpr double kBytesPerPixel = 4.3;
constexpr double kMostBytes = 72e6;
constexpr double kMostPlaneBytes = 1e9;

struct Reference {
    Image linear;
    Image display;
};

/// A cell with an image, and what was found in its maps.
struct MapJob {
    std::string cell;
    std::string folder;
    std::string linked_folder;  ///< the same, as the page names it
    std::string plane_path;     ///< of its float values, beside the page
    const Reference* reference = nullptr;
    GroupPictures* shown = nullptr;  ///< of the group that this cell stands for
    bool is_embedded = true;         ///< its pictures, into the page
    float magnitude_range = 0;
    float sign_range = 0;
    bool has_non_finite = false;
};

using References = std::map<std::string, Reference>;  ///< by file

/// Where the script with a plane lies.
std::string plane_path(const ReportData& data, const std::string& id) {
    return data.directory + "/planes/" + id + ".js";
}

void load_reference(const ReportData& data, const std::string& file, References& references,
                    ReportPictures& pictures) {
    if (references.contains(file)) return;
    const std::string path = data.directory + "/" + file;
    Reference& reference = references[file];
    reference.linear = load_image(path + ".exr");
    reference.display = display_image(reference.linear);
    const Extent size = reference.linear.size();
    pictures.sizes[file] = size;
    if (pictures.embedded) {
        pictures.embedded_references[file] =
            plane_element(file, size, plane_base64(reference.linear));
    } else {
        write_plane_script(reference.linear, file, plane_path(data, file));
    }
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
            MapJob job{cell, folder, "cells/" + cell + "/", plane_path(data, "cells/" + cell),
                       &references.at(file)};
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
            bytes += kBytesPerPixel * static_cast<double>(job.reference->linear.size().area());
            job.is_embedded = bytes <= kMostBytes;
        }
    }
}

void for_each_job(std::vector<MapJob>& jobs, const std::function<void(MapJob&)>& body) {
    for_each_block(jobs.size(), 1, 0, [&](BlockRange block) { body(jobs[block.begin]); });
}

void measure(MapJob& job) {
    const Image image = display_image(load_image(job.folder + "image.exr"));
    const Image& reference = job.reference->display;
    const Grid<float> magnitude = display_error_values(image, reference, ErrorKind::magnitude);
    job.magnitude_range = suggested_range(magnitude);
    job.sign_range = suggested_range(display_error_values(image, reference, ErrorKind::sign));
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
    const Grid<float> values = display_error_values(image, job.reference->display, style.kind);
    const bool is_signed = style.kind == ErrorKind::sign;
    save_raster(error_picture(values, style),
                job.folder + (is_signed ? "error_signed.png" : "error.png"));
    if (job.shown == nullptr) return "";
    return raster_url(error_colours(values, style), job, is_signed ? "map_signed.png" : "map.png");
}

/// The float values of a shown cell, for the viewer.
void keep_plane(const MapJob& job, const Image& image, const ReportPictures& pictures) {
    job.shown->plane = job.linked_folder.substr(0, job.linked_folder.size() - 1);
    if (!pictures.embedded) {
        write_plane_script(image, job.shown->plane, job.plane_path);
        return;
    }
    const bool is_exact = *pictures.embedded == PlanePrecision::float32;
    job.shown->embedded_plane = plane_element(
        job.shown->plane, image.size(),
        is_exact ? plane_base64(image) : difference_base64(image, job.reference->linear));
}

void draw_maps(const MapJob& job, const ReportPictures& pictures) {
    // Loaded again, not kept since measure(): a matrix may hold more images than memory does.
    const Image linear = load_image(job.folder + "image.exr");
    if (job.shown != nullptr) keep_plane(job, linear, pictures);
    const Image image = display_image(linear);
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

/// As the page names it: relative to itself.
std::string planes_folder(const ReportData& data, const PlaneOptions& options) {
    namespace fs = std::filesystem;
    const fs::path page = options.page.empty() ? data.directory + "/report.html" : options.page;
    const fs::path folder = fs::absolute(data.directory) / "planes";
    return fs::proximate(folder, fs::absolute(page).parent_path()).generic_string();
}

void require_openable(const std::vector<MapJob>& jobs, const PlaneOptions& options) {
    if (!options.embedded) return;
    double bytes = 0;
    for (const MapJob& job : jobs) {
        if (job.shown != nullptr)
            bytes += embedded_bytes(job.reference->linear.size(), *options.embedded);
    }
    if (bytes <= kMostPlaneBytes) return;
    throw Error(ExitCode::usage,
                "command line: --embed: found " + std::to_string(std::llround(bytes * 1e-6)) +
                    " MB of " + precision_name(*options.embedded) +
                    " values, allowed: up to 1000 MB; without it they lie beside the page");
}

}  // namespace

ReportPictures make_report_pictures(const ReportData& data, const PlaneOptions& options) {
    ReportPictures pictures;
    pictures.embedded = options.embedded;
    pictures.planes_folder = planes_folder(data, options);
    add_figure_pictures(data, pictures);
    References references;
    std::vector<MapJob> jobs = map_jobs(data, references, pictures);
    choose_embedded(data, jobs);
    require_openable(jobs, options);
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
