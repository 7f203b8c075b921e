// SPDX-License-Identifier: Apache-2.0
#include "filters/surface_records.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "core/error.h"
#include "core/frame_planes.h"
#include "core/parallel.h"
#include "core/render_task.h"
#include "core/timing.h"
#include "filters/band_survey.h"
#include "filters/pace.h"
#include "filters/pixel_clusters.h"
#include "filters/pixel_needs.h"
#include "filters/record_band.h"
#include "filters/surface_records_stages.h"

namespace vecino {
namespace {

// Pixels of a band: what is held of them at a time takes some 200 MB.
constexpr std::size_t kBandPixels = std::size_t{1} << 20;

void require(bool holds, const char* name, const std::string& found, const char* allowed) {
    if (holds) return;
    throw Error(ExitCode::usage, std::string(name) + ": found " + found + ", allowed: " + allowed);
}

void require_between(int value, int least, int most, const char* name) {
    const std::string allowed = std::to_string(least) + " to " + std::to_string(most);
    require(value >= least && value <= most, name, std::to_string(value), allowed.c_str());
}

void check_plan(const SurfaceRecordsPlan& plan, const RenderSettings& settings) {
    require_between(plan.pilot_spp, 1, 4096, "pilot_spp");
    require_between(plan.edge_spp, 0, 65536, "edge_spp");
    require_between(plan.cell, 1, 256, "cell");
    require_between(plan.levels, 0, 8, "levels");
    require_between(plan.record_paths, 1, 1 << 20, "record_paths");
    require_between(plan.refined_record_paths, 1, 1 << 20, "refined_record_paths");
    require_between(plan.fit_order, 0, 2, "fit_order");
    require(plan.fit_sigma > 0, "fit_sigma", std::to_string(plan.fit_sigma), "more than 0");
    require(plan.refine_tau > 0, "refine_tau", std::to_string(plan.refine_tau), "more than 0");
    for (const PlaneInfo& info : all_planes()) {
        const bool is_mean = kMeanPlanes.has(info.plane);
        require(!is_mean || !settings.planes.has(info.plane), "planes", std::string(info.name),
                "all but the means of first hits (with the method surface_records)");
    }
    require(settings.light_sampling == LightSampling::nee, "light_sampling", "none",
            "nee (with the method surface_records)");
}

/// What a frame can hold of the planes asked for.
Planes planes_to_make(const RenderSettings& settings) {
    Planes planes{Plane::radiance};
    for (const PlaneInfo& info : all_planes()) {
        if (info.plane != Plane::variance && settings.planes.has(info.plane))
            planes.add(info.plane);
    }
    return planes;
}

/// Rows of a band, whole cells of them; the same for all sides that divide 48, so that a pace can
/// still choose among these.
int band_rows(Extent size, int cell) {
    const auto width = static_cast<std::size_t>(size.width);
    const int unit = std::lcm(cell, 48);
    const int rows = std::max(static_cast<int>(kBandPixels / width), 16 * std::max(cell, 16));
    return (rows + unit - 1) / unit * unit;
}

std::vector<BandRows> bands_of(Extent size, int rows, int margin) {
    std::vector<BandRows> bands;
    for (int top = 0; top < size.height; top += rows) {
        const RowRange made{top, std::min(top + rows, size.height)};
        bands.push_back(
            {made, {std::max(top - margin, 0), std::min(made.end + margin, size.height)}});
    }
    return bands;
}

}  // namespace

StagedRender render_in_stages(const Scene& scene, const RenderSettings& settings,
                              const StagedRun& run, const Progress& progress) {
    check_settings(settings);
    check_plan(run.plan, settings);
    const TraceKernel& kernel = kernel_for(settings.simd_width);
    const Extent size = reduced(settings.size, settings.reduction);
    StagedRender out{{make_frame(size, planes_to_make(settings)), {}}, {}, {}, run.plan};
    RenderStatistics& statistics = out.render.statistics;
    statistics.threads = settings.threads > 0 ? settings.threads : default_thread_count();
    statistics.simd_width = kernel.width;
    if (scene.pattern != Pattern::none) {
        fill_pattern(out.render.frame, size);
        return out;
    }
    const Stopwatch scene_watch;
    const FlatScene flat = flatten(scene);
    const TraceTask task = render_task(scene, flat, settings);
    const RecordTracer tracer{task, *kernel.records, settings.threads};
    // Fits reach two cells around those that a pixel is blended from, which are one away.
    const int margin = std::max(3 * run.plan.cell, kNeedsReach);
    const int rows = band_rows(size, run.plan.cell);
    out.counts.band_rows = rows;
    PixelClusters clusters(size.width, std::min(rows + 2 * margin, size.height),
                           static_cast<int>(task.light_count));
    statistics.scene_s = scene_watch.seconds();
    const Stopwatch trace_watch;
    int steps = 0;
    std::vector<BandRows> bands = bands_of(size, rows, margin);
    out.counts.bands = static_cast<int>(bands.size());
    const int all_steps = 5 * out.counts.bands;
    const auto checkpoint = [&] {
        ++steps;
        if (progress && !progress(static_cast<double>(steps) / all_steps))
            throw Error(ExitCode::interrupted, "interrupted");
    };
    Pace* pace = run.pace;
    if (pace != nullptr) {
        pace->begin();
        if (bands.size() > 1) pace->choose_first(bands, survey_bands(tracer, bands, clusters));
    }
    for (const BandRows& band : bands) {
        make_band({tracer, kernel, settings, clusters, pace, checkpoint}, band, out);
        pace = nullptr;  // the first band has chosen for all
    }
    statistics.trace_s = trace_watch.seconds();
    return out;
}

Render render_surface_records(const Scene& scene, const RenderSettings& settings,
                              const SurfaceRecordsPlan& plan, const Progress& progress) {
    return render_in_stages(scene, settings, {plan}, progress).render;
}

SurfaceRecordsPlan surface_records_plan(int spp) {
    // Of plain paths at 2, 4, 8, ... samples per pixel.
    constexpr SurfaceRecordsPlan kPlans[] = {
        {1, 16, 16, 0, 64, 64, 1.0, 0.15},      {2, 32, 8, 0, 64, 64, 1.0, 0.15},
        {4, 64, 8, 0, 256, 128, 1.0, 0.15},     {8, 128, 8, 0, 512, 256, 0.85, 0.15},
        {16, 256, 4, 1, 512, 256, 1.0, 0.15},   {16, 512, 4, 1, 1024, 512, 1.0, 0.15},
        {32, 1024, 4, 2, 2048, 1024, 1.0, 0.2},
    };
    const int step = static_cast<int>(std::floor(std::log2(std::max(spp, 2)))) - 1;
    constexpr int kLast = static_cast<int>(std::size(kPlans)) - 1;
    return kPlans[std::clamp(step, 0, kLast)];
}

}  // namespace vecino
