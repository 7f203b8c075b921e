// SPDX-License-Identifier: Apache-2.0
//
// Benchmarks of the hot paths: tracing per scene and packet width, the schemes, and what planes
// cost. Everything of a benchmark is timed in turn, round after round, so that a slow spell of the
// machine meets all of it; a number is the median over rounds, a ratio the median of the ratios
// within a round.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/render.h"

namespace vecino {

/// A scene that is benchmarked.
struct BenchScene {
    std::string name;
    Scene scene;
};

/// The scenes that the program holds: the repository's four boxes, and one whose sphere is a fine
/// mesh.
std::vector<std::string> bench_scene_names();

/// One of these, or else a scene file. Throws as load_scene() does.
BenchScene bench_scene(const std::string& name_or_path);

struct BenchSettings {
    Extent size{128, 128};  ///< of the renders that are timed
    int spp = 16;
    int repeats = 5;  ///< rounds, >= 1, after one that does not count
    int threads = 0;  ///< 0: all
};

/// A number over the rounds.
struct Measured {
    double median = 0;
    double spread = 0;  ///< half of what lies between least and most, as a share of the median
};

/// A scene, traced with one packet width.
struct TraceRow {
    std::string scene;
    std::string light_sampling;
    int simd_width = 0;
    Measured samples_per_s;     ///< of a whole render on all threads
    double thread_speedup = 0;  ///< over a render on one thread
    /// @name One thread, by the time that it ran
    /// Of 128 pixels; by the thread's own clock, so that other programs hardly matter.
    /// @{
    Measured samples_per_s_one_thread;
    double scalar_speedup = 0;  ///< over width 1
    /// Rays/s through Embree alone, by kind; none where the paths have no such ray.
    std::optional<double> primary_rays_per_s, shadow_rays_per_s, bounce_rays_per_s;
    double rays_per_sample = 0;
    Measured embree_share;  ///< Embree's time over that of tracing the same pixels
    /// @}
};

/// A scheme that rebuilds 512x512 pixels, window 7.
struct SchemeRow {
    std::string scheme;  ///< with the weighting, where there is a choice
    int reduction = 0;
    Measured time_s;                ///< on all threads
    Measured time_s_one_thread;     ///< by the thread's own clock, as what follows
    double time_over_nearest = 0;   ///< of the same reduction
    double time_over_factor_2 = 0;  ///< of the same scheme at reduction 2
};

/// A render that makes more planes than radiance.
struct PlanesRow {
    std::string scene;
    std::string planes;
    Measured time_s;                ///< of the render on one thread, by the thread's own clock
    double time_over_radiance = 0;  ///< alone
};

/// Each throws Error(interrupted) when progress answers false.
std::vector<TraceRow> bench_tracing(const std::vector<BenchScene>& scenes,
                                    const BenchSettings& settings, const Progress& progress = {});
std::vector<SchemeRow> bench_schemes(const BenchScene& scene, const BenchSettings& settings,
                                     const Progress& progress = {});
std::vector<PlanesRow> bench_planes(const std::vector<BenchScene>& scenes,
                                    const BenchSettings& settings, const Progress& progress = {});

struct BenchReport {
    std::vector<TraceRow> tracing;
    std::vector<SchemeRow> schemes;
    std::vector<PlanesRow> planes;
};

/// The rows under "tracing", "schemes" and "planes".
nlohmann::json bench_json(const BenchReport& report);
/// The same as tables.
std::string bench_text(const BenchReport& report);
/// What the keys of the JSON mean, a line each, for help.
std::string bench_key_text();

}  // namespace vecino
