// SPDX-License-Identifier: Apache-2.0
#include "filters/auto_pilot.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/timing.h"
#include "filters/noisy_errors.h"
#include "filters/surface_records_stages.h"

namespace vecino {
namespace {

constexpr double kLeastPixels = 3600;
constexpr int kFewSpp = 4, kManySpp = 16;  ///< for a packet of 16 lanes all the same

// Offsets of the seed: no pilot frame shares its points with another or with the final frame.
constexpr std::uint32_t kSeedA = 0x5bd1e995u, kSeedB = 0x27d4eb2fu;

// ---------------------------------------------------------------- frames

struct PathFrame {
    Image radiance;
    double seconds = 0;
    double rays_per_path = 0;
    int lanes = 1;
};

class PilotFrames {
  public:
    PilotFrames(const Scene& scene, const RenderSettings& settings, const Progress& progress)
        : scene_(scene), settings_(settings) {
        settings_.planes = Planes{Plane::radiance};
        if (progress) progress_ = [&progress](double) { return progress(0); };
    }

    [[nodiscard]] Extent size(int reduction) const {
        return reduced(settings_.size, settings_.reduction * reduction);
    }
    [[nodiscard]] double pixels(int reduction) const {
        return static_cast<double>(size(reduction).area());
    }
    [[nodiscard]] double scene_s() const { return scene_s_; }
    /// The same, and counts anew.
    double take_scene_s() { return std::exchange(scene_s_, 0.0); }
    [[nodiscard]] const RenderSettings& settings() const { return settings_; }

    PathFrame path(int reduction, int spp, std::uint32_t seed) {
        RenderSettings settings = reduced_settings(reduction, seed);
        settings.spp = spp;
        Render made = render(scene_, settings, progress_);
        scene_s_ += made.statistics.scene_s;
        const auto paths = static_cast<double>(std::max<std::uint64_t>(made.statistics.samples, 1));
        return {std::move(made.frame.radiance), made.statistics.trace_s,
                static_cast<double>(made.statistics.rays) / paths, made.statistics.simd_width};
    }

    StagedRender records(int reduction, const SurfaceRecordsPlan& plan, std::uint32_t seed) {
        StagedRender made =
            render_in_stages(scene_, reduced_settings(reduction, seed), {plan}, progress_);
        scene_s_ += made.render.statistics.scene_s;
        return made;
    }

  private:
    [[nodiscard]] RenderSettings reduced_settings(int reduction, std::uint32_t seed) const {
        RenderSettings settings = settings_;
        settings.reduction *= reduction;
        settings.seed = settings_.seed + seed;
        return settings;
    }

    const Scene& scene_;
    RenderSettings settings_;
    Progress progress_;
    double scene_s_ = 0;
};

/// Cells at the pilot's resolution that stand for cells of so many pixels of the whole frame.
SurfaceRecordsPlan pilot_plan(int cell, int reduction) {
    return {4, 64, std::max(cell / reduction, 1), 0, 16, 16, 0.85, 0.15};
}

// ---------------------------------------------------------------- what they say

class PilotRun {
  public:
    PilotRun(PilotFrames& frames, std::optional<double> budget_s)
        : frames_(frames), budget_s_(budget_s) {
        pilot_.found.pixels = frames.pixels(1);
        pilot_.found.has_records_method = frames.settings().light_sampling == LightSampling::nee;
        while (frames.pixels(pilot_.reduction) > look_pixels()) ++pilot_.reduction;
    }

    Pilot run() {
        const PathFrame first = frames_.path(pilot_.reduction, 1, kSeedA);  // touches memory
        const double start_s = watch_.seconds();  // threads start: no part of any budget
        watch_ = {};
        (void)frames_.take_scene_s();
        if (is_hurried()) {
            assume();
            // Where noise alone tells that there is hardly any: four frames, as long as the first.
            if (4 * first.seconds <= share() * *budget_s_) measure_path();
        } else {
            look();
            compare();
        }
        pilot_.spent_s = spent_s();
        pilot_.scene_s = frames_.scene_s() + start_s;
        return pilot_;
    }

  private:
    void compare() {
        const int reduction = affordable_reduction();
        if (reduction == 0) return;
        const int first = pilot_.reduction;
        pilot_.reduction = reduction;
        measure_path();
        if (!pilot_.found.has_records_method || path_is_enough()) return;
        measure_records(first);
    }

    [[nodiscard]] bool path_is_enough() const {
        return is_beyond_sight(plan_path(pilot_.found, pilot_.rates, (1 - share()) * budget()));
    }

    /// Of the first frames: they take some 600 ns a pixel, ten times that where most are edges, and
    /// where threads have little to do their start is what counts.
    [[nodiscard]] double look_pixels() const {
        constexpr double kShare = 0.005, kPixel_s = 600e-9;
        return std::clamp(kShare * budget_s_.value_or(0) / kPixel_s, is_hurried() ? 2048.0 : 4096.0,
                          65536.0);
    }

    /// First, small frames of each: what a path costs, and what there is to see.
    void look() {
        const int reduction = pilot_.reduction;
        const PathFrame path = frames_.path(reduction, kManySpp, kSeedA);
        pilot_.found.lanes = path.lanes;
        rays_per_path_ = path.rays_per_path;
        pilot_.rates = nominal_rates(rays_per_path_);
        if (budget_s_) {
            const double path_s = path.seconds / (frames_.pixels(reduction) * kManySpp);
            pilot_.rates = slower(pilot_.rates, path_s / pilot_.rates.path_sample_s);
        }
        if (!pilot_.found.has_records_method) return;
        const SurfaceRecordsPlan plan = pilot_plan(16, reduction);
        const StagedRender made = frames_.records(reduction, plan, kSeedA);
        first_needy_ = static_cast<double>(made.counts.needy_pixels);
        count(made, plan.cell * reduction, kUsualGrowth);
        extrapolate_needy(first_needy_, kUsualNeedySlope);
    }

    /// Of the budget. Where pixels are few, the smallest pilot may take more of it: a method that
    /// does not suit the scene would cost more than that.
    [[nodiscard]] double share() const {
        constexpr double kAmple_s = 2e-6;  // of a pixel
        constexpr double kMostShare = 0.16;
        if (!budget_s_ || *budget_s_ < kAmple_s * pilot_.found.pixels) return kPilotShare;
        return std::clamp(kLeastPilot_s / *budget_s_, kPilotShare, kMostShare);
    }

    /// Whether even the smallest frames take more than the pilot's share, on a usual machine.
    [[nodiscard]] bool is_hurried() const {
        return budget_s_ && pilot_.found.has_records_method && share() * *budget_s_ < kLeastPilot_s;
    }

    /// In seconds; where a budget is given in samples, those of a usual machine.
    [[nodiscard]] double budget() const {
        return budget_s_
                   ? *budget_s_
                   : frames_.settings().spp * pilot_.found.pixels * pilot_.rates.path_sample_s;
    }

    void assume() {
        constexpr double kUsualRecords = 1.06 / 64;
        pilot_.rates = nominal_rates(kUsualRays);
        pilot_.found.needy_pixels = kUsualNeedy * pilot_.found.pixels;
        pilot_.found.records_at_8 = kUsualRecords * pilot_.found.pixels;
        pilot_.found.record_growth = kUsualGrowth;
    }

    [[nodiscard]] double spent_s() const { return watch_.seconds() - frames_.scene_s(); }

    /// The largest frames that the pilot's share of the budget has room for; 0: none.
    [[nodiscard]] int affordable_reduction() const {
        const double left_s = share() * budget() - (budget_s_ ? spent_s() : 0);
        const double least = std::min(kLeastPixels, frames_.pixels(pilot_.reduction));
        for (int reduction = 1; frames_.pixels(reduction) >= least && reduction <= kMostReduction;
             ++reduction) {
            if (frames_.pixels(reduction) > kMostPixels) continue;
            if (cost(reduction) <= left_s) return reduction;
        }
        return 0;
    }

    [[nodiscard]] double cost(int reduction) const {
        const double pixels = frames_.pixels(reduction);
        const double path_s = 4 * kManySpp * pixels * pilot_.rates.path_sample_s;
        if (!pilot_.found.has_records_method) return path_s;
        PilotFindings found = pilot_.found;
        const double smaller = static_cast<double>(pilot_.reduction) / reduction;
        found.pixels = pixels;
        found.needy_pixels = first_needy_ * std::pow(smaller, kUsualNeedySlope);
        // Cells of the pilot count as what they stand for: their number is not that of its pixels.
        const auto frame_s = [&](int cell) {
            SurfaceRecordsPlan plan = pilot_plan(cell, reduction);
            plan.cell *= reduction;
            return surface_records_cost(found, pilot_.rates, plan);
        };
        return path_s + 2 * frame_s(16) + frame_s(8);
    }

    void measure_path() {
        const int reduction = pilot_.reduction;
        const PathFrame few_a = frames_.path(reduction, kFewSpp, kSeedA);
        const PathFrame few_b = frames_.path(reduction, kFewSpp, kSeedB);
        path_a_ = frames_.path(reduction, kManySpp, kSeedA);
        path_b_ = frames_.path(reduction, kManySpp, kSeedB);
        const double few = 0.5 * squared_difference(few_a.radiance, few_b.radiance).mean;
        const double many = 0.5 * squared_difference(path_a_.radiance, path_b_.radiance).mean;
        PathErrors errors{many, 1};
        if (few > 0 && many > 0) {
            const double octaves = std::log2(double{kManySpp} / kFewSpp);
            errors.slope = std::clamp(std::log2(few / many) / octaves, 0.8, 1.6);
        }
        pilot_.found.path = errors;
        pilot_.found.lanes = path_a_.lanes;
        if (!budget_s_) return;
        const double path_s =
            std::min(path_a_.seconds, path_b_.seconds) / (frames_.pixels(reduction) * kManySpp);
        pilot_.rates = slower(pilot_.rates, path_s / pilot_.rates.path_sample_s);
    }

    void measure_records(int first_reduction) {
        const int reduction = pilot_.reduction;
        const SurfaceRecordsPlan coarse = pilot_plan(16, reduction);
        const SurfaceRecordsPlan fine = pilot_plan(8, reduction);
        const StagedRender a = frames_.records(reduction, coarse, kSeedA);
        const StagedRender b = frames_.records(reduction, coarse, kSeedB);
        const auto needy = static_cast<double>(a.counts.needy_pixels);
        extrapolate_needy(needy, needy_slope(needy, first_reduction));
        count(a, coarse.cell * reduction, kUsualGrowth);
        RecordErrors errors = kUsualErrors;
        take_noise(a, b, coarse, errors);
        if (fine.cell < coarse.cell) {
            const StagedRender finer = frames_.records(reduction, fine, kSeedA);
            const double growth = static_cast<double>(finer.counts.records) /
                                  std::max<double>(static_cast<double>(a.counts.records), 1);
            count(finer, fine.cell * reduction, std::clamp(growth, 2.0, 4.0));
            take_bias(a, finer, coarse.cell * reduction, errors);
        }
        take_unexplained(a, errors);
        pilot_.found.records = errors;
    }

    /// Noise is that of needy pixels, or of records: the more pixels are needy, the more of the
    /// former.
    void take_noise(const StagedRender& a, const StagedRender& b, const SurfaceRecordsPlan& plan,
                    RecordErrors& errors) {
        noise_ = 0.5 * squared_difference(a.render.frame.radiance, b.render.frame.radiance).mean;
        const double needy = static_cast<double>(a.counts.needy_pixels);
        const double share = std::min(needy / frames_.pixels(pilot_.reduction), 1.0);
        errors.edge_noise = noise_ * share * share / edge_noise_share(plan);
        errors.record_noise = noise_ * (1 - share * share) / record_noise_share(plan);
    }

    /// What halved cells change beyond noise is bias of the coarse ones.
    void take_bias(const StagedRender& coarse, const StagedRender& fine, int cell,
                   RecordErrors& errors) {
        const MeanError both =
            squared_difference(coarse.render.frame.radiance, fine.render.frame.radiance);
        const double beyond = both.mean - 2 * noise_;
        bias_ = std::max(beyond, 0.0);
        if (beyond < 3 * both.standard_error) return;  // it may be noise
        errors.bias_at_8 = std::max(beyond / bias_share(cell), 0.25 * kUsualErrors.bias_at_8);
    }

    /// Traced paths must not say much else.
    void take_unexplained(const StagedRender& a, RecordErrors& errors) const {
        const MeanError found =
            error_against(a.render.frame.radiance, path_a_.radiance, path_b_.radiance);
        const double explained = noise_ + bias_;
        if (found.mean - 2 * found.standard_error > 2 * explained)
            errors.unexplained = found.mean - explained;
    }

    [[nodiscard]] double needy_slope(double needy, int first_reduction) const {
        if (first_reduction == pilot_.reduction || !(first_needy_ > 0) || !(needy > 0))
            return kUsualNeedySlope;
        const double smaller = static_cast<double>(first_reduction) / pilot_.reduction;
        return std::clamp(std::log(needy / first_needy_) / std::log(smaller), 1.0, 2.0);
    }

    void extrapolate_needy(double needy, double slope) {
        pilot_.found.needy_pixels =
            std::min(needy * std::pow(pilot_.reduction, slope), pilot_.found.pixels);
    }

    void count(const StagedRender& made, int cell, double growth) {
        pilot_.found.record_growth = growth;
        pilot_.found.records_at_8 =
            static_cast<double>(made.counts.records) * std::pow(growth, std::log2(cell / 8.0));
    }

    static constexpr double kLeastPilot_s = 0.03;
    static constexpr double kUsualRays = 3.4;         ///< of a path
    static constexpr double kUsualGrowth = 3.8;       ///< of records by halved cells
    static constexpr double kUsualNeedySlope = 1.15;  ///< needy pixels to the size of the frame
    static constexpr int kMostReduction = 2048;
    static constexpr double kMostPixels = 1 << 20;

    PilotFrames& frames_;
    std::optional<double> budget_s_;
    Stopwatch watch_;
    Pilot pilot_;
    double rays_per_path_ = 0;
    double first_needy_ = 0;
    double noise_ = 0, bias_ = 0;  ///< of the pilot's frames
    PathFrame path_a_, path_b_;
};

}  // namespace

PathTiming time_path(const Scene& scene, const RenderSettings& settings, double guess_s,
                     double seconds) {
    PilotFrames frames(scene, settings, {});
    const auto packets = [&](int reduction) {
        return seconds / (frames.pixels(reduction) * kManySpp * guess_s);
    };
    int reduction = 1;
    while (packets(reduction) < 1 && frames.pixels(reduction) > kLeastPixels) ++reduction;
    const double pixels = frames.pixels(reduction);
    const int few = kManySpp * std::clamp(static_cast<int>(packets(reduction) / 4), 1, 256);
    const int many = 3 * few;
    const double few_s = frames.path(reduction, few, kSeedA).seconds;
    const double many_s = frames.path(reduction, many, kSeedA).seconds;
    // Two, as a render takes some time before its first sample.
    const double all = many_s / (pixels * many);
    const double sample_s = std::clamp((many_s - few_s) / (pixels * (many - few)), 0.65 * all, all);
    return {sample_s, many_s - sample_s * pixels * many, few_s + many_s};
}

Pilot run_pilot(const Scene& scene, const RenderSettings& settings, std::optional<double> budget_s,
                const Progress& progress) {
    PilotFrames frames(scene, settings, progress);
    return PilotRun(frames, budget_s).run();
}

double nominal_budget_s(const Pilot& pilot, const RenderSettings& settings) {
    return settings.spp * pilot.found.pixels * pilot.rates.path_sample_s;
}

}  // namespace vecino
