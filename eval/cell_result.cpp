// SPDX-License-Identifier: Apache-2.0
#include "eval/cell_result.h"

#include <filesystem>

#include "core/files.h"
#include "core/image_io.h"
#include "core/timing.h"
#include "eval/ceiling.h"
#include "eval/external_command.h"
#include "eval/frame_jobs.h"
#include "eval/metrics_json.h"

namespace vecino {
namespace {

struct BuiltImage {
    Reconstruction made;
    double reconstruct_s = 0;
    double elsewhere_s = 0;  ///< tracing by another program
    double guide_s = 0;
};

ReconstructionRequest request_of(const Cell& cell, GuideStore& guides) {
    ReconstructionRequest request{cell.settings.size, cell.parameters, 0};
    if (cell.scheme->uses_guide()) request.guide = &guides.get(cell.parameters.guide_scale).frame;
    return request;
}

BuiltImage reconstruct_timed(const Cell& cell, const Frame& low, const CellInput& input) {
    std::vector<double> times;
    BuiltImage built;
    const ReconstructionRequest request = request_of(cell, *input.guides);
    if (cell.scheme->uses_guide())
        built.guide_s = input.guides->get(cell.parameters.guide_scale).trace_s;
    for (int i = 0; i < input.matrix->repeat; ++i) {
        const Stopwatch watch;
        built.made = reconstruct(low, *cell.scheme, request);
        times.push_back(watch.seconds());
        if (times.back() > kRepeatBelow_s) break;
    }
    built.reconstruct_s = median(times);
    return built;
}

void require_made(const std::filesystem::path& output, const ExternalCommand& command) {
    if (std::filesystem::exists(output)) return;
    throw Error(ExitCode::file, "command " + command.arguments.front() +
                                    ": found no file at {output}, allowed: an image there (" +
                                    command.log + ")");
}

/// Runs the source's command, on the traced frame if it reads one.
SourcedImage run_source(const Cell& cell, const CellInput& input, const RunDirectory& directory) {
    const ImageSource& source = *cell.image;
    const std::string folder = "cells/" + cell.name;
    Placeholders values = placeholders_of(cell.scene, cell.settings);
    const auto temporary = [&](const std::string& extension) {
        // Of this run alone: a command that outlives a killed run goes on writing to its own.
        return std::filesystem::absolute(directory.file_in(folder, temporary_name(extension)));
    };
    const std::filesystem::path output = temporary(source.output);
    const std::filesystem::path frame = temporary(".exr");
    values["output"] = output.string();
    values["input"] = frame.string();
    if (source.reads_frame()) save_frame(input.traced->render.frame, frame.string());
    ExternalCommand command{{}, folder_of(*input.matrix), directory.file_in(folder, "command.log")};
    for (const std::string& argument : source.command)
        command.arguments.push_back(fill_template(argument, values));
    std::vector<double> times;
    while (times.size() < static_cast<std::size_t>(input.matrix->repeat)) {
        std::filesystem::remove(output);  // what an earlier go left is no result
        times.push_back(run_command(command));
        require_made(output, command);
        if (times.back() > kRepeatBelow_s) break;
    }
    SourcedImage made = load_sourced_image(source, output.string());
    if (!source.time_s && source.time_attribute.empty()) made.time_s = median(times);
    std::filesystem::remove(output);  // image.exr holds it from now on
    std::filesystem::remove(frame);
    return made;
}

BuiltImage image_from_elsewhere(const Cell& cell, const CellInput& input,
                                const RunDirectory& directory) {
    const ImageSource& source = *cell.image;
    SourcedImage image =
        source.command.empty()
            ? load_sourced_image(source, sourced_path(*input.matrix, source.file,
                                                      placeholders_of(cell.scene, cell.settings)))
            : run_source(cell, input, directory);
    BuiltImage built{{.image = std::move(image.frame.radiance)}, 0, 0};
    (source.reads_frame() ? built.reconstruct_s : built.elsewhere_s) = image.time_s;
    return built;
}

BuiltImage build_image(const Cell& cell, const CellInput& input, const RunDirectory& directory) {
    switch (cell.kind) {
        case CellKind::image:
            return image_from_elsewhere(cell, input, directory);
        case CellKind::scheme: {
            if (cell.inject.empty())
                return reconstruct_timed(cell, input.traced->render.frame, input);
            Frame low = input.traced->render.frame;
            inject(cell.inject, low);
            return reconstruct_timed(cell, low, input);
        }
        case CellKind::blocky_ceiling: {
            const Extent low = reduced(cell.settings.size, cell.settings.reduction);
            return {{.image = blocky_ceiling(input.reference->image, low)}, 0};
        }
        case CellKind::path:
        case CellKind::method:
            break;
    }
    return {{.image = input.traced->render.frame.radiance}, input.traced->reconstruct_s};
}

/// Of a ceiling, a region's metrics are those of the best image for that region.
nlohmann::json compare_cell(const Cell& cell, const Image& image, const CellInput& input,
                            bool& is_finite) {
    const StoredReference& reference = *input.reference;
    const RegionMap* const regions =
        reference.regions.values().empty() ? nullptr : &reference.regions;
    const auto measured = [&](const Image& each) {
        return compare(each, reference.image, regions, input.matrix->metrics);
    };
    const Comparison comparison = measured(image);
    is_finite = comparison.non_finite.count == 0;
    nlohmann::json metrics = comparison_json(comparison);
    if (cell.kind != CellKind::blocky_ceiling || regions == nullptr) return metrics;
    const Extent low = reduced(cell.settings.size, cell.settings.reduction);
    const Image by_region = blocky_ceiling(reference.image, low, regions);
    metrics["regions"] = comparison_json(measured(by_region))["regions"];
    return metrics;
}

double save(const Image& image, const Cell& cell, const RunDirectory& directory) {
    const std::string folder = "cells/" + cell.name;
    const Stopwatch watch;
    save_image(image, directory.file_in(folder, "image.exr"));
    const double write_s = watch.seconds();
    save_image(image, directory.file_in(folder, "image.png"));
    return write_s;
}

nlohmann::json times_json(const RenderStatistics& s, const BuiltImage& built, double write_s) {
    return {{"scene", s.scene_s},
            {"trace", s.trace_s},
            {"guide", built.guide_s},
            {"reconstruct", built.reconstruct_s},
            {"write", write_s},
            {"total", s.scene_s + s.trace_s + built.guide_s + built.reconstruct_s + write_s}};
}

/// What the cell makes of a frame of its settings.
Image image_of(const Cell& cell, const Frame& frame, GuideStore& guides) {
    if (cell.scheme == nullptr) return frame.radiance;
    return reconstruct(frame, *cell.scheme, request_of(cell, guides)).image;
}

nlohmann::json measure_stability(const Cell& cell, const Image& image, const CellInput& input,
                                 const RunDirectory& directory) {
    nlohmann::json json = shimmer_json(
        input.shifted, {&image, &input.reference->image}, [&](const ShiftedView& view) {
            RenderSettings settings = cell.settings;
            settings.camera_shift += view.shift;
            GuideStore guides(*input.scene, settings, 1);
            Image shifted = image_of(cell, view.frame, guides);
            save_image(shifted,
                       directory.file_in("cells/" + cell.name, shifted_image_file(view.shift)));
            return shifted;
        });
    if (!input.matrix->stability->elasticity) return {{"shimmer", json}};
    // A scheme takes the same frame in another way; a method has to render anew.
    const auto make = [&](const Cell& other) {
        return cell.kind == CellKind::method
                   ? render_frame(other, *input.scene).render.frame.radiance
                   : image_of(other, input.traced->render.frame, *input.guides);
    };
    return {{"shimmer", json}, {"elasticity", elasticity_json(cell, input.reference->image, make)}};
}

nlohmann::json measure(const Cell& cell, const CellInput& input, const RunDirectory& directory) {
    const BuiltImage built = build_image(cell, input, directory);
    nlohmann::json row;
    bool is_finite = false;
    row["metrics"] = compare_cell(cell, built.made.image, input, is_finite);
    const double write_s = save(built.made.image, cell, directory);
    RenderStatistics s =
        input.traced == nullptr ? RenderStatistics{} : input.traced->render.statistics;
    s.trace_s += built.elsewhere_s;
    // What took no time that is known did not take that of writing alone either.
    const bool is_timed = s.trace_s + built.reconstruct_s > 0;
    row["time_s"] = times_json(s, built, is_timed ? write_s : 0);
    row["counts"] = {{"samples", s.samples},
                     {"rays", s.rays},
                     {"dropped_samples", s.dropped_samples + built.made.dropped_samples},
                     {"fallback_pixels", built.made.fallback_pixels},
                     {"non_finite_pixels", built.made.non_finite_pixels}};
    if (input.traced != nullptr) row["threads"] = s.threads;
    if (cell.kind == CellKind::method) {
        row["facts"] = input.traced->facts;
        // Which a method decides itself, and no parameter tells.
        const double asked = double(cell.spp_asked) * double(cell.settings.size.area());
        row["samples_ratio"] = static_cast<double>(s.samples) / asked;
    }
    // What injected samples leave is what their cell is there to show.
    is_finite = is_finite && (built.made.non_finite_pixels == 0 || !cell.inject.empty());
    row["status"] = is_finite ? "ok" : "failed";
    if (!is_finite) row["reason"] = "non-finite pixels";
    if (is_finite && input.matrix->stability && has_stability(cell))
        row["stability"] = measure_stability(cell, built.made.image, input, directory);
    return row;
}

}  // namespace

nlohmann::json failed_result(const std::string& reason) {
    return {{"status", "failed"}, {"reason", reason}};
}

nlohmann::json error_result(const Cell& cell, const Error& error) {
    nlohmann::json result = failed_result(error.what());
    // What is wrong with an image from elsewhere is no matter of a method of ours.
    const bool is_refusal = error.code() == ExitCode::usage && cell.kind != CellKind::image;
    if (is_refusal) result["status"] = "refused";
    return result;
}

bool is_of_cell(const Error& error) {
    return dynamic_cast<const WriteError*>(&error) == nullptr &&
           error.code() != ExitCode::interrupted;
}

nlohmann::json cell_result(const Cell& cell, const CellInput& input,
                           const RunDirectory& directory) {
    try {
        return measure(cell, input, directory);
    } catch (const Error& error) {
        if (!is_of_cell(error)) throw;
        return error_result(cell, error);
    }
}

}  // namespace vecino
