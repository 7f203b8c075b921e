// SPDX-License-Identifier: Apache-2.0
#include "eval/bench.h"

#include <array>
#include <memory>

#include "core/first_hits.h"
#include "core/timing.h"
#include "core/trace_bench.h"
#include "eval/round_robin.h"
#include "filters/guide.h"
#include "filters/schemes.h"

namespace vecino {
namespace {

// So many that their packets stand for the image, so few that they stay in a core's second cache,
// as those of a render do.
constexpr int kReplayedPixels = 128;

RenderSettings render_settings(const BenchSettings& bench) {
    RenderSettings settings;
    settings.size = bench.size;
    settings.spp = bench.spp;
    settings.threads = bench.threads;
    settings.planes = {Plane::radiance};
    return settings;
}

/// Adds a render of a scene to what is timed: the tracing alone.
std::size_t add_render(RoundRobin& robin, const Scene& scene, const RenderSettings& settings) {
    return robin.add([&scene, settings] { return render(scene, settings).statistics.trace_s; });
}

/// One scene and width: what is timed of it.
class TraceUnits {
  public:
    TraceUnits(RoundRobin& robin, const BenchScene& scene, const RenderSettings& settings)
        : settings_(settings), pixels_(scene.scene, settings, kReplayedPixels) {
        all_threads_ = add_render(robin, scene.scene, settings);
        RenderSettings one = settings;
        one.threads = 1;
        one_thread_ = add_render(robin, scene.scene, one);
        trace_ = robin.add([this] { return thread_seconds_per_run([this] { pixels_.trace(); }); });
        replay_ = add_replay(robin, pixels_.packets());
        for (const RayKind kind : {RayKind::primary, RayKind::shadow, RayKind::bounce}) {
            Kind& replayed = kinds_[static_cast<std::size_t>(kind)];
            replayed.packets = std::make_unique<PacketLog>(pixels_.packets().only(kind));
            if (replayed.packets->rays() == 0) continue;
            replayed.unit = add_replay(robin, *replayed.packets);
        }
    }
    TraceUnits(const TraceUnits&) = delete;
    TraceUnits& operator=(const TraceUnits&) = delete;

    [[nodiscard]] TraceRow row(const RoundRobin& robin, const TraceUnits& scalar) const {
        TraceRow row;
        row.simd_width = pixels_.simd_width();
        const double samples =
            static_cast<double>(settings_.size.area()) * static_cast<double>(settings_.spp);
        row.samples_per_s = robin.rate(all_threads_, samples);
        row.thread_speedup = robin.ratio(one_thread_, all_threads_).median;
        row.samples_per_s_one_thread = robin.rate(trace_, static_cast<double>(pixels_.samples()));
        row.scalar_speedup = robin.ratio(scalar.trace_, trace_).median;
        row.primary_rays_per_s = rays_per_s(robin, RayKind::primary);
        row.shadow_rays_per_s = rays_per_s(robin, RayKind::shadow);
        row.bounce_rays_per_s = rays_per_s(robin, RayKind::bounce);
        row.rays_per_sample =
            static_cast<double>(pixels_.packets().rays()) / static_cast<double>(pixels_.samples());
        row.embree_share = robin.ratio(replay_, trace_);
        return row;
    }

  private:
    struct Kind {
        std::unique_ptr<PacketLog> packets;
        std::optional<std::size_t> unit;
    };

    std::size_t add_replay(RoundRobin& robin, const PacketLog& packets) {
        return robin.add([this, &packets] {
            return thread_seconds_per_run([&] { packets.replay(pixels_.embree()); });
        });
    }

    [[nodiscard]] std::optional<double> rays_per_s(const RoundRobin& robin, RayKind kind) const {
        const Kind& replayed = kinds_[static_cast<std::size_t>(kind)];
        if (!replayed.unit) return std::nullopt;
        return robin.rate(*replayed.unit, static_cast<double>(replayed.packets->rays())).median;
    }

    RenderSettings settings_;
    TraceBench pixels_;
    std::array<Kind, 3> kinds_;
    std::size_t all_threads_, one_thread_, trace_, replay_;
};

struct NamedScheme {
    std::string name;
    const Scheme* scheme;
    SchemeParameters parameters;
};

/// Every row of the table, with every weighting where it has a choice.
std::vector<NamedScheme> schemes_to_time() {
    std::vector<NamedScheme> named;
    for (const Scheme& scheme : all_schemes()) {
        SchemeParameters parameters = scheme.defaults;
        if (!scheme.uses_guide()) parameters.window = 7;
        if (!scheme.reads("weighting")) {
            named.push_back({std::string(scheme.name), &scheme, parameters});
            continue;
        }
        for (const Weighting weighting :
             {Weighting::proportional, Weighting::inverse, Weighting::gaussian}) {
            parameters.weighting = weighting;
            const std::string slug = find_scheme_option("weighting").slug(parameters);
            named.push_back({std::string(scheme.name) + "." + slug, &scheme, parameters});
        }
    }
    return named;
}

struct NamedPlanes {
    const char* name;
    Planes planes;
};

std::vector<NamedPlanes> planes_to_time() {
    const Planes first_hit{Plane::radiance, Plane::albedo,   Plane::position,
                           Plane::normal,   Plane::distance, Plane::id};
    return {{"radiance", {Plane::radiance}},
            {"radiance and first hits", first_hit},
            {"radiance and variance", {Plane::radiance, Plane::variance}},
            {"all", Planes::all()}};
}

}  // namespace

std::vector<TraceRow> bench_tracing(const std::vector<BenchScene>& scenes,
                                    const BenchSettings& settings, const Progress& progress) {
    struct Named {
        std::string scene, light_sampling;
        std::unique_ptr<TraceUnits> units;
        std::size_t scalar;  ///< where the units of width 1 stand
    };
    RoundRobin robin;
    std::vector<Named> all;
    RenderSettings render = render_settings(settings);
    const std::vector<int> widths = simd_widths();  // widest first, 1 last
    for (const BenchScene& scene : scenes) {
        for (const auto& [name, sampling] :
             {std::pair{"nee", LightSampling::nee}, std::pair{"none", LightSampling::none}}) {
            render.light_sampling = sampling;
            const std::size_t scalar = all.size() + widths.size() - 1;
            for (const int width : widths) {
                render.simd_width = width;
                all.push_back(
                    {scene.name, name, std::make_unique<TraceUnits>(robin, scene, render), scalar});
            }
        }
    }
    robin.run(settings.repeats, progress);
    std::vector<TraceRow> rows;
    for (const Named& named : all) {
        rows.push_back(named.units->row(robin, *all[named.scalar].units));
        rows.back().scene = named.scene;
        rows.back().light_sampling = named.light_sampling;
    }
    return rows;
}

std::vector<SchemeRow> bench_schemes(const BenchScene& scene, const BenchSettings& settings,
                                     const Progress& progress) {
    constexpr Extent kSize{512, 512};
    constexpr std::array kReductions = {2, 3, 4};
    RenderSettings low = render_settings(settings);
    low.size = kSize;
    low.spp = 4;
    low.planes = Planes::all();
    std::array<Frame, kReductions.size()> frames;
    RenderSettings full = low;
    full.planes = kGuidePlanes;
    const Frame guide = trace_first_hits(scene.scene, full).frame;
    RoundRobin robin;
    const std::vector<NamedScheme> schemes = schemes_to_time();
    for (std::size_t i = 0; i < frames.size(); ++i) {
        low.reduction = kReductions[i];
        frames[i] = render(scene.scene, low).frame;
        for (const NamedScheme& named : schemes) {
            const auto rebuild = [&, i](int threads) {
                reconstruct(frames[i], *named.scheme, {kSize, named.parameters, threads, &guide});
            };
            robin.add([=] { return seconds_per_run([&] { rebuild(settings.threads); }); });
            robin.add([=] { return thread_seconds_per_run([&] { rebuild(1); }); });
        }
    }
    robin.run(settings.repeats, progress);
    std::vector<SchemeRow> rows;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        for (std::size_t k = 0; k < schemes.size(); ++k) {
            // Every scheme has two units: all threads, then one.
            const std::size_t unit = 2 * (i * schemes.size() + k);
            const std::size_t nearest = 2 * i * schemes.size() + 1;
            rows.push_back({schemes[k].name, kReductions[i], robin.time(unit), robin.time(unit + 1),
                            robin.ratio(unit + 1, nearest).median,
                            robin.ratio(unit + 1, 2 * k + 1).median});
        }
    }
    return rows;
}

std::vector<PlanesRow> bench_planes(const std::vector<BenchScene>& scenes,
                                    const BenchSettings& settings, const Progress& progress) {
    RoundRobin robin;
    RenderSettings render = render_settings(settings);
    // With Sobol samples the variance plane is made from other samples: no cost of planes.
    render.sampler = Sampler::independent;
    render.threads = 1;
    const std::vector<NamedPlanes> planes = planes_to_time();
    for (const BenchScene& scene : scenes) {
        for (const NamedPlanes& named : planes) {
            render.planes = named.planes;
            robin.add([&scene, render] {
                return thread_seconds_per_run([&] { vecino::render(scene.scene, render); });
            });
        }
    }
    robin.run(settings.repeats, progress);
    std::vector<PlanesRow> rows;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        for (std::size_t k = 0; k < planes.size(); ++k) {
            const std::size_t unit = i * planes.size() + k;
            rows.push_back({scenes[i].name, planes[k].name, robin.time(unit),
                            robin.ratio(unit, i * planes.size()).median});
        }
    }
    return rows;
}

}  // namespace vecino
