// SPDX-License-Identifier: Apache-2.0
//
// The kernels behind surface_records, held against each other.
#include <cmath>
#include <vector>

#include "core/flat_scene.h"
#include "core/record_task.h"
#include "core/render_task.h"
#include "tests/catch.h"
#include "tests/scene_text.h"

using namespace vecino;
using namespace vecino::test;

namespace {

bool is_near(float a, float b) {
    return std::abs(a - b) <= 1e-4f * (std::abs(a) + std::abs(b)) + 1e-6f;
}

/// The cluster of a list that stands for the same side of the same surface.
const Cluster* same_in(const ClusterList& list, const Cluster& cluster) {
    for (int k = 0; k < list.count; ++k) {
        const Cluster& other = list.clusters[k];
        float cosine = 0;
        for (int c = 0; c < 3; ++c) cosine += other.first_normal[c] * cluster.first_normal[c];
        if (other.object == cluster.object && (cluster.object < 0 || cosine > 0.7f)) return &other;
    }
    return nullptr;
}

void check_same(const TraceTask& task, const Cluster& a, const Cluster& b) {
    CHECK(a.count == b.count);
    CHECK(a.shadow_count == b.shadow_count);
    CHECK(a.first_sample == b.first_sample);
    for (int c = 0; c < 3; ++c) {
        CHECK(is_near(a.position[c], b.position[c]));
        CHECK(is_near(a.albedo[c], b.albedo[c]));
        CHECK(is_near(a.emission[c], b.emission[c]));
        CHECK(is_near(a.picked[c], b.picked[c]));
        CHECK(is_near(a.unshadowed[c], b.unshadowed[c]));
    }
    for (std::uint32_t l = 0; l < task.light_count && l < kMostExactLights; ++l) {
        CHECK(is_near(a.lights[l].exact, b.lights[l].exact));
        CHECK(is_near(a.lights[l].open, b.lights[l].open));
        CHECK(is_near(a.lights[l].seen, b.lights[l].seen));
    }
}

}  // namespace

TEST_CASE("pixels that share packets see what each of them sees on its own", "[surface_records]") {
    const Scene scene = repository_scene(GENERATE("checker_spheres", "corridor"));
    RenderSettings settings;
    settings.size = {96, 96};
    settings.max_depth = 2;
    settings.simd_width = GENERATE_REF(from_range(simd_widths()));
    const FlatScene flat = flatten(scene);
    const TraceTask task = render_task(scene, flat, settings);
    const RecordKernel& kernel = *kernel_for(settings.simd_width).records;
    constexpr std::uint32_t kFirst = 2;
    int several = 0;
    for (int y = 5; y < 96; y += 9) {
        FewSamples few{};
        few.count = 13;
        few.begin = kFirst;
        ClusterList alone[kPilotPixels] = {}, shared[kPilotPixels] = {};
        for (int i = 0; i < few.count; ++i) {
            few.x[i] = 7 * i;
            few.y[i] = y - i % 3;
            few.end[i] = kFirst + 1 + static_cast<std::uint32_t>(i % 6);
            kernel.add_samples(task, {few.x[i], few.y[i], 0, kFirst, -1, true}, alone[i]);
            shared[i] = alone[i];
            kernel.add_samples(task, {few.x[i], few.y[i], kFirst, few.end[i], -1, true}, alone[i]);
        }
        CHECK(kernel.add_few(task, few, shared) > 0);
        for (int i = 0; i < few.count; ++i) {
            REQUIRE(shared[i].count == alone[i].count);
            CHECK(shared[i].crowded == alone[i].crowded);
            if (alone[i].count > 1) ++several;
            for (int k = 0; k < alone[i].count; ++k) {
                const Cluster* const same = same_in(shared[i], alone[i].clusters[k]);
                REQUIRE(same != nullptr);
                check_same(task, alone[i].clusters[k], *same);
            }
        }
    }
    CHECK(several > 2);
}
