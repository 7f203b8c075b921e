// SPDX-License-Identifier: Apache-2.0
#include "eval/cell_result.h"

#include "core/error.h"
#include "core/image_io.h"
#include "core/timing.h"
#include "eval/ceiling.h"
#include "eval/metrics_json.h"

namespace vecino {
namespace {

struct BuiltImage {
    Reconstruction made;
    double reconstruct_s = 0;
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

BuiltImage build_image(const Cell& cell, const CellInput& input) {
    switch (cell.kind) {
        case CellKind::scheme:
            return reconstruct_timed(cell, input.traced->frame, input.repeat);
        case CellKind::blocky_ceiling: {
            const Extent low = reduced(cell.settings.size, cell.settings.reduction);
            return {{.image = blocky_ceiling(input.reference->image, low)}, 0};
        }
        case CellKind::path:
            break;
    }
    return {{.image = input.traced->frame.radiance}, 0};
}

/// Of a ceiling, a region's metrics are those of the best image for that region.
nlohmann::json compare_cell(const Cell& cell, const Image& image, const CellInput& input,
                            bool& is_finite) {
    const StoredReference& reference = *input.reference;
    const Comparison comparison =
        compare(image, reference.image, &reference.regions, input.metrics);
    is_finite = comparison.non_finite.count == 0;
    nlohmann::json metrics = comparison_json(comparison);
    if (cell.kind != CellKind::blocky_ceiling) return metrics;
    const Extent low = reduced(cell.settings.size, cell.settings.reduction);
    const Image by_region = blocky_ceiling(reference.image, low, &reference.regions);
    metrics["regions"] = comparison_json(
        compare(by_region, reference.image, &reference.regions, input.metrics))["regions"];
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
    const BuiltImage built = build_image(cell, input);
    nlohmann::json row;
    bool is_finite = false;
    row["metrics"] = compare_cell(cell, built.made.image, input, is_finite);
    const double write_s = save(built.made.image, cell, directory);
    const RenderStatistics s =
        input.traced == nullptr ? RenderStatistics{} : input.traced->statistics;
    row["time_s"] =
        input.traced == nullptr ? times_json(s, 0, 0) : times_json(s, built.reconstruct_s, write_s);
    row["counts"] = {{"samples", s.samples},
                     {"rays", s.rays},
                     {"dropped_samples", s.dropped_samples + built.made.dropped_samples},
                     {"fallback_pixels", built.made.fallback_pixels},
                     {"non_finite_pixels", built.made.non_finite_pixels}};
    if (input.traced != nullptr) row["threads"] = s.threads;
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
        return {{"status", "failed"}, {"reason", error.what()}};
    }
}

}  // namespace vecino
