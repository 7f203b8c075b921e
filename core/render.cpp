// SPDX-License-Identifier: Apache-2.0
#include "core/render.h"

#include <array>
#include <string>

#include "core/error.h"
#include "core/frame_planes.h"
#include "core/part.h"
#include "core/pixel_tracer.h"
#include "core/render_task.h"
#include "core/trace_task.h"

namespace vecino {
namespace {

/// Whether first hits are those of rays of their own.
bool traces_centres(const RenderSettings& settings) {
    return settings.first_hit == FirstHit::centre &&
           common(settings.planes, kFirstHitPlanes) != Planes{};
}

}  // namespace

std::vector<int> simd_widths() {
    std::vector<int> widths;
    for (const int width : {16, 8, 4, 1}) {
        if (find_trace_kernel(width) != nullptr) widths.push_back(width);
    }
    return widths;
}

Planes planes_to_make(const RenderSettings& settings) {
    Planes planes{Plane::radiance};
    for (const PlaneInfo& info : all_planes()) {
        const bool possible = info.plane != Plane::variance || settings.spp > 1;
        if (possible && settings.planes.has(info.plane)) planes.add(info.plane);
    }
    return planes;
}

VarianceOf variance_of(const RenderSettings& settings) {
    if (!planes_to_make(settings).has(Plane::variance)) return VarianceOf::nothing;
    return settings.sampler == Sampler::sobol ? VarianceOf::streams : VarianceOf::samples;
}

Render render(const Scene& scene, const RenderSettings& settings, const Progress& progress) {
    check_settings(settings);
    const RenderStatistics statistics = first_statistics(settings);
    const Extent size = reduced(settings.size, settings.reduction);
    Render result{make_frame(size, planes_to_make(settings)), statistics};
    if (scene.pattern == Pattern::xy_gradient) {
        fill_pattern(result.frame, size);
        return result;
    }
    PixelTracer tracer(scene, settings, variance_of(settings));
    const bool centres = traces_centres(settings);
    const auto trace = [&](PixelTrace& pixel) {
        pixel.trace({0, settings.spp});
        if (centres) pixel.trace_centre();
        store_first_hit(pixel.first_hit(), pixel.at(), result.frame);
        store_means(pixel.guide_sums(), settings.spp, pixel.at(), result.frame);
        const PixelValues values = pixel.values();
        store_values(values, pixel.at(), result.frame);
        if (!is_finite(values.radiance())) pixel.mark_non_finite();
    };
    tracer.for_each_pixel(trace, progress);
    result.statistics = tracer.statistics();
    return result;
}

PartRender render_part(const Scene& scene, const RenderSettings& settings, SampleInterval samples,
                       const Progress& progress) {
    check_settings(settings);
    const std::string fault = interval_fault(samples, settings.spp);
    if (!fault.empty()) throw Error(ExitCode::usage, "samples: " + fault);
    if (scene.pattern != Pattern::none) {
        throw Error(ExitCode::usage, "samples: found the scene " + scene.name +
                                         ", which is a pattern, allowed: a scene of objects");
    }
    if (common(settings.planes, kMeanPlanes) != Planes{}) {
        throw Error(ExitCode::usage,
                    "planes: found albedo_mean or normal_mean with a part of the samples, allowed: "
                    "with all of them");
    }
    const Extent size = reduced(settings.size, settings.reduction);
    const Planes planes = planes_to_make(settings);
    const VarianceOf variance = variance_of(settings);
    PartRender result{{samples, planes, variance, SampleSums(size, sum_count(variance)), {}}, {}};
    Part& part = result.part;
    if (samples.begin == 0) part.first_hits = make_frame(size, common(planes, kFirstHitPlanes));
    PixelTracer tracer(scene, settings, variance);
    const bool centres = samples.begin == 0 && traces_centres(settings);
    const auto trace = [&](PixelTrace& pixel) {
        pixel.trace(samples);
        if (centres) pixel.trace_centre();
        std::array<ExactSum::Digits, kMostSums> sums;
        pixel.sums().sums(sums);
        part.sums.store(pixel.index(), sums);
        store_first_hit(pixel.first_hit(), pixel.at(), part.first_hits);
    };
    tracer.for_each_pixel(trace, progress);
    result.statistics = tracer.statistics();
    return result;
}

}  // namespace vecino
