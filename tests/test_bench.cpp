// SPDX-License-Identifier: Apache-2.0
//
// What a benchmark says must fit together; how fast anything is, is no test's business. The
// benchmarks themselves, hidden: vecino_tests "[benchmark]".
#include <algorithm>
#include <cstdio>
#include <set>

#include "core/error.h"
#include "core/json_read.h"
#include "core/trace_bench.h"
#include "eval/bench.h"
#include "eval/round_robin.h"
#include "filters/schemes.h"
#include "tests/bad_input.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/scene_text.h"
#include "tests/temp_dir.h"

using namespace vecino;
using namespace vecino::test;

namespace {

BenchSettings tiny() {
    BenchSettings settings;
    settings.size = {12, 10};
    settings.spp = 4;
    settings.repeats = 1;
    return settings;
}

std::uint64_t rays_of(const TraceBench& bench, RayKind kind) {
    return bench.packets().only(kind).rays();
}

void check_row(const TraceRow& row) {
    CAPTURE(row.scene, row.light_sampling, row.simd_width);
    CHECK(row.samples_per_s.median > 0);
    CHECK(row.samples_per_s_one_thread.median > 0);
    CHECK(row.thread_speedup > 0);
    CHECK(row.scalar_speedup > 0);
    CHECK(row.primary_rays_per_s.value_or(0) > 0);
    CHECK(row.bounce_rays_per_s.value_or(0) > 0);
    CHECK(row.shadow_rays_per_s.has_value() == (row.light_sampling == "nee"));
    // Depth 2: at most 3 vertices, of which 2 ask for light.
    CHECK(row.rays_per_sample > 1);
    CHECK(row.rays_per_sample < (row.light_sampling == "nee" ? 4 : 3));
    CHECK(row.embree_share.median > 0);
}

}  // namespace

TEST_CASE("recorded packets hold every ray of a render, each as one kind", "[bench]") {
    const std::string name = GENERATE("cornell_sphere", "hard_shadows", "illustration_16");
    const int width = GENERATE(from_range(simd_widths()));
    CAPTURE(name, width);
    RenderSettings settings = small_settings({20, 20}, 9);
    settings.simd_width = width;
    const TraceBench bench(repository_scene(name), settings, 50);
    CHECK(bench.simd_width() == width);
    CHECK(bench.samples() == 450);
    CHECK(bench.packets().rays() == bench.trace());
    CHECK(rays_of(bench, RayKind::primary) == bench.samples());
    CHECK(rays_of(bench, RayKind::bounce) > 0);
    CHECK(rays_of(bench, RayKind::bounce) <= bench.samples());
    CHECK(rays_of(bench, RayKind::primary) + rays_of(bench, RayKind::shadow) +
              rays_of(bench, RayKind::bounce) ==
          bench.packets().rays());
}

TEST_CASE("a render counts the rays that a benchmark of all its pixels records", "[bench]") {
    RenderSettings settings = small_settings({1, 1}, 200);
    settings.planes = {Plane::radiance};
    settings.light_sampling = GENERATE(LightSampling::none, LightSampling::nee);
    const Scene scene = repository_scene("cornell");
    const TraceBench bench(scene, settings, 1);
    CHECK(bench.packets().rays() == render(scene, settings).statistics.rays);
}

TEST_CASE("rays that ask for the background are bounces, not shadow rays", "[bench]") {
    Scene scene = repository_scene("cornell");
    std::erase_if(scene.objects, [&](const Object& object) {
        return scene.materials[object.material].emission != glm::vec3(0.0f);
    });
    scene.background = glm::vec3(1.0f);
    const TraceBench bench(scene, small_settings({16, 16}, 16), 30);
    CHECK(rays_of(bench, RayKind::shadow) == 0);
    CHECK(rays_of(bench, RayKind::bounce) > bench.samples() / 2);
    CHECK(rays_of(bench, RayKind::primary) == bench.samples());
}

TEST_CASE("a replay finds the same hits again, and every primary ray's in a closed box",
          "[bench]") {
    RenderSettings settings = small_settings({16, 16}, 16);
    settings.simd_width = GENERATE(from_range(simd_widths()));
    const TraceBench box(scene_from(closed_cube(R"({"albedo": [0.5, 0.5, 0.5]})")), settings, 20);
    const PacketLog primary = box.packets().only(RayKind::primary);
    CHECK(primary.replay(box.embree()) == box.samples());
    const TraceBench bench(repository_scene("cornell_sphere"), settings, 20);
    const std::uint64_t hits = bench.packets().replay(bench.embree());
    CHECK(hits > 0);
    CHECK(hits < bench.packets().rays());
    CHECK(bench.packets().replay(bench.embree()) == hits);
}

TEST_CASE("one ray at a time finds the hits that packets find", "[bench]") {
    // The same samples in another grouping: rays differ in their last bits at most.
    RenderSettings settings = small_settings({32, 32}, 16);
    const Scene scene = repository_scene(GENERATE("cornell_sphere", "checker_spheres"));
    const auto hits = [&](int width) {
        settings.simd_width = width;
        const TraceBench bench(scene, settings, 60);
        return static_cast<double>(bench.packets().replay(bench.embree()));
    };
    CHECK(hits(1) == Approx(hits(4)).epsilon(0.01));
}

TEST_CASE("the tracing benchmark has a row for every scene, light sampling and width", "[bench]") {
    const std::vector<BenchScene> scenes = {bench_scene("cornell"), bench_scene("cornell_mesh")};
    double last = 0;
    const std::vector<TraceRow> rows = bench_tracing(scenes, tiny(), [&](double done) {
        CHECK(done > last);
        last = done;
        return true;
    });
    CHECK(last == Approx(1.0));
    CHECK(rows.size() == 2 * 2 * simd_widths().size());
    std::set<std::string> names;
    for (const TraceRow& row : rows) {
        check_row(row);
        if (row.simd_width == 1) CHECK(row.scalar_speedup == 1.0);
        names.insert(row.scene + row.light_sampling + std::to_string(row.simd_width));
    }
    CHECK(names.size() == rows.size());
}

TEST_CASE("the benchmark of schemes times every row of their table", "[bench]") {
    const std::vector<SchemeRow> rows = bench_schemes(bench_scene("cornell_sphere"), tiny());
    for (const int reduction : {2, 3, 4}) {
        for (const Scheme& scheme : all_schemes()) {
            const auto count = std::ranges::count_if(rows, [&](const SchemeRow& row) {
                const std::string base = row.scheme.substr(0, row.scheme.find('.'));
                return row.reduction == reduction && base == scheme.name;
            });
            CAPTURE(scheme.name, reduction);
            CHECK(count == (scheme.reads("weighting") ? 3 : 1));
        }
    }
    for (const SchemeRow& row : rows) {
        CAPTURE(row.scheme, row.reduction);
        CHECK(row.time_s.median > 0);
        CHECK(row.time_s_one_thread.median > 0);
        CHECK(row.time_over_nearest > 0);
        if (row.scheme == "nearest") CHECK(row.time_over_nearest == 1.0);
        if (row.reduction == 2) CHECK(row.time_over_factor_2 == 1.0);
    }
}

TEST_CASE("medians, ranges and ratios are taken over rounds, less the first", "[bench]") {
    RoundRobin robin;
    std::vector<double> one{9, 1, 2, 4};
    std::vector<double> two{9, 3, 4, 8};
    const auto next = [](std::vector<double>& values) {
        const double value = values.front();
        values.erase(values.begin());
        return value;
    };
    const std::size_t first = robin.add([&] { return next(one); });
    const std::size_t second = robin.add([&] { return next(two); });
    robin.run(3, {});
    CHECK(robin.time(first).median == 2.0);
    CHECK(robin.time(first).spread == 0.75);
    CHECK(robin.rate(second, 8.0).median == 2.0);
    CHECK(robin.ratio(second, first).median == 2.0);  // of 3, 2 and 2, not 4 / 2
    CHECK(robin.ratio(second, first).spread == 0.25);
}

TEST_CASE("an interrupted benchmark ends with the code of interrupts", "[bench]") {
    int calls = 0;
    const Error error = error_of([&] {
        bench_tracing({bench_scene("cornell")}, tiny(), [&](double) { return ++calls < 3; });
    });
    CHECK(error.code() == ExitCode::interrupted);
    CHECK(calls == 3);
}

TEST_CASE("the mesh of the benchmark is its sphere", "[bench]") {
    const auto mean = [](const Scene& scene) {
        RenderSettings settings = small_settings({32, 32}, 256);
        settings.planes = {Plane::radiance};
        return mean_of(render(scene, settings).frame.radiance);
    };
    const glm::dvec3 sphere = mean(bench_scene("cornell_sphere").scene);
    const glm::dvec3 mesh = mean(bench_scene("cornell_mesh").scene);
    for (int c = 0; c < 3; ++c) CHECK(mesh[c] == Approx(sphere[c]).epsilon(0.01));
}

TEST_CASE("bench writes JSON with documented keys, and takes scene files", "[bench]") {
    const TempDir dir;
    const std::string scene = VECINO_SOURCE_DIR "/scenes/illustration_13.json";
    check_success(dir, "bench \"" + scene + "\" --size 8x8 --spp 2 --repeats 1 -o bench.json");
    const nlohmann::json json = parse_json_text(dir.read("bench.json"), "bench.json");
    std::set<std::string> keys;
    for (const auto& [key, value] : json.items()) keys.insert(key);
    CHECK(keys == std::set<std::string>{"tracing", "schemes", "planes", "host", "date", "size",
                                        "spp", "repeats", "threads"});
    CHECK(json["host"].contains("cpu"));
    CHECK(json["size"] == nlohmann::json{8, 8});
    CHECK(json["tracing"].size() == 2 * simd_widths().size());
    CHECK(json["planes"].size() == 4);
    const std::string help = bench_key_text();
    for (const char* const part : {"tracing", "schemes", "planes"}) {
        for (const auto& [key, value] : json[part].front().items()) {
            CAPTURE(part, key);
            CHECK(help.find("  " + key + " ") != std::string::npos);
            const bool sound = value.is_string() || value.is_number() || value.is_null();
            CHECK(sound);
        }
    }
    CHECK(json["tracing"][0]["scene"] == "illustration_13");
}

TEST_CASE("bad usage of bench is one line and changes no file", "[bench]") {
    const TempDir dir;
    const std::string pattern = "\"" VECINO_SOURCE_DIR "/scenes/illustration_9.json\"";
    const Mistake mistakes[] = {
        {"no such scene", "bench nowhere.json", 4, "nowhere.json"},
        {"a pattern", "bench " + pattern + " --size 8x8 --spp 1", 64,
         "illustration_9: found a pattern"},
        {"no size", "bench --size 8", 64, "--size"},
        {"no samples", "bench --spp 0", 64, "--spp"},
        {"no rounds", "bench --repeats 0", 64, "--repeats"},
        {"no threads", "bench --threads 0", 64, "--threads"},
        {"nothing to write to", "bench -o \"\"", 64, "-o"},
        {"no such folder", "bench -o nowhere/bench.json", 4, "nowhere/bench.json"},
    };
    check_mistakes(dir, mistakes);
}

TEST_CASE("how fast packets are traced", "[.][benchmark]") {
    BenchReport report;
    report.tracing = bench_tracing({bench_scene("cornell"), bench_scene("cornell_sphere")}, {});
    std::printf("%s\n", bench_text(report).c_str());
}

TEST_CASE("how fast the schemes rebuild a large image", "[.][benchmark]") {
    BenchReport report;
    report.schemes = bench_schemes(bench_scene("cornell_sphere"), {});
    std::printf("%s\n", bench_text(report).c_str());
}

TEST_CASE("what planes cost a render", "[.][benchmark]") {
    BenchReport report;
    report.planes = bench_planes({bench_scene("cornell"), bench_scene("cornell_sphere")}, {});
    std::printf("%s\n", bench_text(report).c_str());
}
