// SPDX-License-Identifier: Apache-2.0
//
// Renders by surface records and by paths, to hold one against the other.
#pragma once

#include "core/render.h"
#include "eval/metrics.h"
#include "filters/surface_records.h"
#include "tests/catch.h"

namespace vecino::test {

constexpr SurfaceRecordsPlan kSmallPlan{4, 64, 4, 1, 256, 128, 0.85, 0.15};

inline Render records(const Scene& scene, const RenderSettings& settings,
                      const SurfaceRecordsPlan& plan = kSmallPlan) {
    return render_surface_records(scene, settings, plan);
}

inline double db(const Image& test, const Image& reference) {
    const Comparison comparison = compare(test, reference);
    REQUIRE(comparison.metrics.has_value());
    return comparison.metrics->psnr_float_db.value_or(200.0);
}

/// Paths of another seed.
inline Image paths(const Scene& scene, RenderSettings settings, int spp) {
    settings.spp = spp;
    settings.seed = 77;
    settings.planes = {Plane::radiance};
    return render(scene, settings).frame.radiance;
}

}  // namespace vecino::test
