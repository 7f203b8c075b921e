// SPDX-License-Identifier: Apache-2.0
#include "eval/cell_result.h"

#include <filesystem>

#include "core/error.h"
#include "core/image_io.h"
#include "core/timing.h"
#include "eval/ceiling.h"
#include "eval/external_command.h"
#include "eval/metrics_json.h"

namespace vecino {
namespace {

struct BuiltImage {
    Reconstruction made;
    double reconstruct_s = 0;
    double elsewhere_s = 0;  ///< tracing by another program
};

BuiltImage reconstruct_timed(const Cell& cell, const Frame& low, int repeat) {
    std::vector<double> times;
    BuiltImage built;
    for (int i = 0; i < repeat; ++i) {
        const Stopwatch watch;
        built.made = reconstruct(low, *cell.scheme, {cell.settings.size, cell.parameters, 0});
        times.push_back(watch.seconds());
        if (times.back() > kRepeatBelow_s) break;
    }
    built.reconstruct_s = median(times);
    return built;
}

/// Runs the source's command, on the traced frame if it reads one.
SourcedImage run_source(const Cell& cell, const CellInput& input, const RunDirectory& directory) {
    const ImageSource& source = *cell.image;
    const std::string folder = "cells/" + cell.name;
    Placeholders values = placeholders_of(cell.scene, cell.settings);
    const std::filesystem::path output =
        std::filesystem::absolute(directory.file_in(folder, "made" + source.output));
    const std::filesystem::path frame =
        std::filesystem::absolute(directory.file_in(folder, "input.exr"));
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
        case CellKind::scheme:
            return reconstruct_timed(cell, input.traced->render.frame, input.matrix->repeat);
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

nlohmann::json times_json(const RenderStatistics& s, double reconstruct_s, double write_s) {
    return {{"scene", s.scene_s},
            {"trace", s.trace_s},
            {"reconstruct", reconstruct_s},
            {"write", write_s},
            {"total", s.scene_s + s.trace_s + reconstruct_s + write_s}};
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
    row["time_s"] = times_json(s, built.reconstruct_s, is_timed ? write_s : 0);
    row["counts"] = {{"samples", s.samples},
                     {"rays", s.rays},
                     {"dropped_samples", s.dropped_samples + built.made.dropped_samples},
                     {"fallback_pixels", built.made.fallback_pixels},
                     {"non_finite_pixels", built.made.non_finite_pixels}};
    if (input.traced != nullptr) row["threads"] = s.threads;
    if (cell.kind == CellKind::method) row["facts"] = input.traced->facts;
    is_finite = is_finite && built.made.non_finite_pixels == 0;
    row["status"] = is_finite ? "ok" : "failed";
    if (!is_finite) row["reason"] = "non-finite pixels";
    return row;
}

}  // namespace

nlohmann::json cell_result(const Cell& cell, const CellInput& input,
                           const RunDirectory& directory) {
    try {
        return measure(cell, input, directory);
    } catch (const Error& error) {
        if (error.code() == ExitCode::interrupted) throw;
        return {{"status", "failed"}, {"reason", error.what()}};
    }
}

}  // namespace vecino
