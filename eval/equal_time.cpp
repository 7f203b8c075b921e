// SPDX-License-Identifier: Apache-2.0
#include "eval/equal_time.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "core/files.h"
#include "core/timing.h"
#include "eval/frame_jobs.h"
#include "eval/guide_store.h"
#include "eval/run_directory.h"

namespace vecino {
namespace {

// Long enough that a render's rate is steady, short beside the frames themselves.
constexpr double kRender_s = 0.3;
constexpr int kRounds = 5;
constexpr int kFullPackets_spp = 64;  // a multiple of every packet width

/// What the answer depends on: all but the answer itself, the seed, and how neighbours are weighed,
/// which takes no time beside tracing. Cells that differ in that alone share their answer, and with
/// it their frames.
nlohmann::json question(const Cell& cell) {
    nlohmann::json json = cell.parameters_json();
    json.erase("spp");
    json.erase("seed");
    for (const SchemeOption& row : scheme_options()) {
        const bool takes_time =
            row.name == "window" || row.name == "order" || row.name == "guide_scale";
        if (!takes_time) json.erase(std::string(row.name));
    }
    return json;
}

RenderSettings path_settings(const Cell& cell) {
    RenderSettings settings = cell.settings;
    settings.reduction = 1;
    settings.spp = 1;
    settings.planes = {Plane::radiance};
    return settings;
}

RenderSettings low_settings(const Cell& cell) {
    RenderSettings settings = path_settings(cell);
    settings.reduction = cell.settings.reduction;
    settings.planes = planes_read_by(cell);
    return settings;
}

double trace_s(const Scene& scene, const RenderSettings& settings) {
    return render(scene, settings).statistics.trace_s;
}

int calibrate(const Scene& scene, RenderSettings settings, int asked_spp) {
    return calibration_spp(asked_spp, [&](int spp) {
        settings.spp = spp;
        return trace_s(scene, settings);
    });
}

/// With the guide that it takes.
double reconstruct_s(const Scene& scene, const Cell& cell) {
    const Frame low = render(scene, low_settings(cell)).frame;
    ReconstructionRequest request{cell.settings.size, cell.parameters, 0};
    GuideStore guides(scene, cell.settings, kRounds);
    double guide_s = 0;
    if (cell.scheme->uses_guide()) {
        const TracedGuide& guide = guides.get(cell.parameters.guide_scale);
        request.guide = &guide.frame;
        guide_s = guide.trace_s;
    }
    std::vector<double> times;
    // A small image takes microseconds: a few repeats could all fall into one busy moment.
    for (const Stopwatch all; times.size() < kRounds || all.seconds() < kRender_s / 4;) {
        const Stopwatch watch;
        (void)reconstruct(low, *cell.scheme, request);
        times.push_back(watch.seconds());
    }
    return guide_s + median(times);
}

}  // namespace

EqualTimeBudgets::EqualTimeBudgets(std::string path) : path_(std::move(path)) {
    if (!std::filesystem::exists(path_)) return;
    auto read = nlohmann::json::parse(read_file(path_), nullptr, false);
    if (read.is_object()) entries_ = std::move(read);
}

std::optional<int> EqualTimeBudgets::spp(const Cell& cell) const {
    const auto entry = entries_.find(cell.group);
    if (entry == entries_.end() || !entry->is_object()) return std::nullopt;
    const nlohmann::json spp = entry->value("spp", nlohmann::json());
    const bool is_same = entry->value("question", nlohmann::json()) == question(cell);
    const bool is_count =
        spp.is_number_integer() && spp >= 1 && spp <= std::numeric_limits<int>::max();
    if (!is_same || !is_count) return std::nullopt;
    return spp.get<int>();
}

std::optional<int> EqualTimeBudgets::spp(const Cell& cell, const std::string& state) const {
    const auto found = spp(cell);
    // Whatever stands there, should somebody have edited the file.
    const nlohmann::json stored =
        found ? entries_[cell.group].value("state", nlohmann::json()) : nlohmann::json();
    if (stored != state) return std::nullopt;
    return found;
}

std::optional<int> EqualTimeBudgets::spp_like(const Cell& cell, const std::string& state) const {
    Cell like = cell;
    for (const auto& [group, entry] : entries_.items()) {
        like.group = group;
        if (const auto found = spp(like, state)) return found;
    }
    return std::nullopt;
}

void EqualTimeBudgets::put(const Cell& cell, const std::string& state, int spp) {
    entries_[cell.group] = {{"spp", spp}, {"question", question(cell)}, {"state", state}};
    write_text_file(path_, entries_.dump(1) + "\n");
}

int calibration_spp(int asked_spp, const std::function<double(int spp)>& seconds_of) {
    // Few samples leave lanes of a packet idle, and tell nothing of the rate of many.
    if (asked_spp < kFullPackets_spp) return asked_spp;
    for (int spp = kFullPackets_spp;; spp *= 4) {
        const double seconds = seconds_of(spp);
        if (seconds <= kRender_s / 4 && spp < (1 << 20)) continue;
        const double wanted = spp * std::min(1.0, kRender_s / seconds);
        const int packets = static_cast<int>(wanted) / kFullPackets_spp;
        return std::max(1, packets) * kFullPackets_spp;
    }
}

int equal_time_spp(const EqualTimes& times) {
    const double spp = std::round((times.path_s - times.reconstruct_s) / times.low_s_per_spp);
    return static_cast<int>(std::clamp(spp, 1.0, double{std::numeric_limits<int>::max()}));
}

int measure_equal_time_spp(const Scene& scene, const Cell& cell) {
    RenderSettings path = path_settings(cell);
    RenderSettings low = low_settings(cell);
    path.spp = calibrate(scene, path, cell.spp_asked);
    low.spp = calibrate(scene, low,
                        budgeted_spp(Budget::equal_samples, cell.spp_asked,
                                     {path.size, reduced(low.size, low.reduction)}));
    std::vector<double> path_times;
    std::vector<double> low_times;
    for (int i = 0; i < kRounds; ++i) {  // in turn, so that a slow moment meets both
        path_times.push_back(trace_s(scene, path));
        low_times.push_back(trace_s(scene, low));
    }
    return equal_time_spp({.path_s = median(path_times) / path.spp * cell.spp_asked,
                           .low_s_per_spp = median(low_times) / low.spp,
                           .reconstruct_s = reconstruct_s(scene, cell)});
}

}  // namespace vecino
