// SPDX-License-Identifier: Apache-2.0
//
// How fast the schemes with a guide are, hidden: vecino_tests "[benchmark]".
#include <algorithm>
#include <cstdio>

#include "core/first_hits.h"
#include "core/timing.h"
#include "filters/guide.h"
#include "filters/schemes.h"
#include "tests/catch.h"

using namespace vecino;

namespace {

constexpr int kRounds = 7;

/// Milliseconds, the least of some rounds; of one thread, its own time.
template <class Watch, class Run>
double milliseconds(const Run& run) {
    double least = 1e9;
    for (int i = 0; i < kRounds; ++i) {
        const Watch watch;
        run();
        least = std::min(least, 1e3 * watch.seconds());
    }
    return least;
}

}  // namespace

TEST_CASE("how fast schemes with a guide rebuild 512x512 pixels", "[.][benchmark]") {
    const Scene scene = load_scene(std::string(VECINO_SOURCE_DIR) + "/scenes/cornell_sphere.json");
    RenderSettings settings;
    settings.spp = 4;
    settings.planes = {Plane::radiance, Plane::emission};
    std::printf("guide  tracing ms  scheme           reduction  all threads ms  one thread ms\n");
    for (const int scale : {1, 2, 4}) {
        RenderSettings fine = settings;
        fine.size = {512 * scale, 512 * scale};
        fine.planes = kGuidePlanes;
        Frame guide;
        const double guide_ms =
            milliseconds<Stopwatch>([&] { guide = trace_first_hits(scene, fine).frame; });
        for (const char* name : {"joint_bilateral", "guided_fit"}) {
            const Scheme& scheme = find_scheme(name);
            for (const int reduction : {1, 2, 3, 4}) {
                settings.reduction = reduction;
                const Frame low = render(scene, settings).frame;
                const auto rebuild = [&](int threads) {
                    (void)reconstruct(low, scheme, {{512, 512}, scheme.defaults, threads, &guide});
                };
                const double all_ms = milliseconds<Stopwatch>([&] { rebuild(0); });
                const double one_ms = milliseconds<ThreadStopwatch>([&] { rebuild(1); });
                std::printf("%d x %d  %10.1f  %-15s  %9d  %14.1f  %13.1f\n", scale, scale, guide_ms,
                            name, reduction, all_ms, one_ms);
            }
        }
    }
}
