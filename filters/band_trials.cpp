// SPDX-License-Identifier: Apache-2.0
#include "filters/band_trials.h"

#include <algorithm>
#include <cmath>
#include <glm/vec3.hpp>
#include <span>
#include <utility>

#include "core/parallel.h"
#include "core/timing.h"
#include "filters/record_check.h"

namespace vecino {
namespace {

/// With the twentieth part that is greatest taken for as great as the greatest of the others: of
/// few values, one beside a contact would speak for all.
double usual_mean(std::vector<double> values) {
    if (values.empty()) return 0;
    std::ranges::sort(values);
    const double most = values[(values.size() - 1) * 19 / 20];
    double sum = 0;
    for (const double value : values) sum += std::min(value, most);
    return sum / static_cast<double>(values.size());
}

/// Returns the light over pi that reaches records: their mean.
glm::vec3 find_of_records(std::span<const RecordTrial> trials, PaceFindings& findings) {
    constexpr double kFitNoise = 0.4;  // of a record's own, once it is fitted to those around
    glm::vec3 light(0.0f);
    int count = 0;
    std::vector<double> noise;
    for (const RecordTrial& trial : trials) {
        if (trial.paths == 0) continue;  // it was not made
        ++count;
        light += (trial.light - light) / static_cast<float>(count);
        findings.records_at_16 += (trial.records_at_16 - findings.records_at_16) / count;
        findings.surfaces += (trial.surfaces - findings.surfaces) / count;
        noise.insert(noise.end(), trial.noise.begin(), trial.noise.end());
        findings.record_noise = std::pow(trial.paths / 512.0, kRecordSlope);
    }
    findings.record_noise *= kFitNoise * usual_mean(std::move(noise));
    return light;
}

}  // namespace

BandTrials::BandTrials(const Inputs& inputs) : inputs_(inputs) {
    for (const auto& row : inputs.needy) needy_pixels_ += static_cast<double>(row.size());
}

PixelSampler BandTrials::sampler(const SurfaceRecordsPlan& plan) const {
    return PixelSampler({inputs_.tracer, inputs_.kernel, inputs_.clusters, inputs_.records, plan});
}

// ---------------------------------------------------------------- first samples

PilotCost BandTrials::pilot_cost() const {
    return {first_samples_s(1), first_samples_s(4)};
}

/// Of one thread, for a pixel with so many.
double BandTrials::first_samples_s(int samples) const {
    constexpr int kBlocks = 48, kApart = 5;
    const RowRange rows = inputs_.rows;
    const int columns = (inputs_.clusters.width() + kPilotPixels - 1) / kPilotPixels;
    const int blocks = columns * (rows.end - rows.begin);
    const int step = std::max(blocks / kBlocks, 1);
    return inputs_.pace.typical([&](int number) {
        int pixels = 0;
        const ThreadStopwatch watch;
        for (int i = kApart * number % step; i < blocks; i += step, pixels += kPilotPixels) {
            const Pixel at{i % columns * kPilotPixels, rows.begin + i / columns};
            inputs_.clusters.try_samples(inputs_.tracer, at, samples);
        }
        return watch.seconds() / pixels;
    });
}

// ---------------------------------------------------------------- structure

PaceFindings BandTrials::structure() const {
    constexpr std::uint32_t kTrySamples = 32;
    PaceFindings findings;
    findings.needy_pixels = needy_pixels_;
    glm::vec3 ambient(0.0f);
    if (has_records(inputs_.tracer.task)) {
        RecordTrial made[kMostTrials];
        findings.path_s = inputs_.pace.typical([&](int number) {
            RecordTrial& trial = made[number];
            trial = try_records({inputs_.tracer, inputs_.clusters}, number);
            return trial.path_s;
        });
        ambient = find_of_records(made, findings);
    }
    const auto given = [this](std::size_t, std::size_t) {
        return static_cast<std::uint32_t>(inputs_.plan.pilot_spp) + kTrySamples;
    };
    findings.sample_s = inputs_.pace.typical([&](int number) { return unit_s(number, given); });
    findings.has_record_light = ambient != glm::vec3(0.0f);
    findings.edges = edge_curves(ambient);
    return findings;
}

/// By some of the needy pixels, before there are records. ambient: light over pi in the place of
/// theirs.
std::vector<std::pair<int, EdgeCurve>> BandTrials::edge_curves(const glm::vec3& ambient) const {
    constexpr std::size_t kRun = 4, kOneOf = 8;  // rows: needs of neighbours are looked at
    NeedyRows some(inputs_.needy.size());
    for (std::size_t r = 0; r < some.size(); ++r) {
        if (r / kRun % kOneOf == kOneOf / 2) some[r] = inputs_.needy[r];
    }
    const RecordMap none;
    const int pilot_spp = inputs_.plan.pilot_spp;
    const NeededSamples needed({inputs_.tracer, inputs_.clusters, pilot_spp, none, ambient},
                               inputs_.rows, some);
    std::vector<std::pair<int, EdgeCurve>> curves;
    for (int spp = pilot_spp; spp <= std::max(Pace::kMostPilotSpp, pilot_spp); spp *= 2)
        curves.emplace_back(spp, EdgeCurve{});
    for_each_block(curves.size(), 1, inputs_.tracer.threads, [&](BlockRange block) {
        auto& [spp, curve] = curves[block.begin];
        curve = edge_curve(needed, some, spp);
    });
    return curves;
}

EdgeCurve BandTrials::edge_curve(const NeededSamples& needed, const NeedyRows& some,
                                 int pilot_spp) const {
    constexpr int kMostSpp = 1024;
    constexpr std::size_t kPixels = 2048;
    std::size_t pixels = 0;
    for (const auto& row : some) pixels += row.size();
    const std::size_t one_of = std::max(pixels / kPixels, std::size_t{1});
    const double frame =
        static_cast<double>(inputs_.clusters.width()) * (inputs_.rows.end - inputs_.rows.begin);
    EdgeCurve curve;
    for (int edge_spp = 1; edge_spp <= kMostSpp; edge_spp *= 2) {
        const auto seen = needed.outlook(some, {edge_spp, pilot_spp, one_of});
        const double per_pixel = 1 / std::max(seen.pixels, 1.0);
        curve.push_back({static_cast<double>(edge_spp), seen.work * per_pixel,
                         seen.error * per_pixel * needy_pixels_ / frame});
    }
    return curve;
}

// ---------------------------------------------------------------- edges

double BandTrials::edge_unit_s(const NeededSamples& needed) const {
    constexpr int kManySpp = 256;  // more take as long each
    const int edge_spp = std::min(inputs_.plan.edge_spp, kManySpp);
    const auto given = [&](std::size_t row, std::size_t i) {
        return needed.samples(row, i, edge_spp);
    };
    return inputs_.pace.typical([&](int number) { return unit_s(number, given); });
}

/// Of one thread, by some of the pixels.
double BandTrials::unit_s(int number, const Given& given) const {
    std::vector<NeedyPlace> places;
    // All trials together are a quarter of what there is to do, at most.
    const auto pixels = static_cast<std::size_t>(std::clamp(needy_pixels_ / 16, 16.0, 128.0));
    visit_some({number, pixels, 16}, [&](std::size_t r, std::size_t i) {
        places.push_back({inputs_.needy[r][i], inputs_.rows.begin + static_cast<int>(r)});
        places.back().pixel.samples = given(r, i);
    });
    const PixelSampler sampler = this->sampler(inputs_.plan);
    double work = 0;
    for (const NeedyPlace& place : places) work += sampler.work(place);
    if (!(work > 0)) {  // none of these gets any: it is about others
        for (NeedyPlace& place : places) {
            place.pixel.samples =
                static_cast<std::uint32_t>(inputs_.plan.pilot_spp + kOwnPacketSpp);
            work += sampler.work(place);
        }
    }
    const ThreadStopwatch watch;
    sampler.sample(places, [](const NeedyPlace&, const SampledPixel&) {});
    return watch.seconds() / std::max(work, 1.0);
}

double BandTrials::edge_work(const NeededSamples& needed, int edge_spp) const {
    SurfaceRecordsPlan plan = inputs_.plan;
    plan.edge_spp = edge_spp;
    const PixelSampler sampler = this->sampler(plan);
    double work = 0, count = 0;
    visit_some({0, 1024, 1}, [&](std::size_t r, std::size_t i) {
        NeedyPixel pixel = inputs_.needy[r][i];
        pixel.samples = needed.samples(r, i, edge_spp);
        work += sampler.work({pixel, inputs_.rows.begin + static_cast<int>(r)});
        if ((pixel.needs & kNeedsShadow) != 0) work += kSmoothingWork;
        ++count;
    });
    return count > 0 ? work * needy_pixels_ / count : 0;
}

ErrorFindings BandTrials::errors(const NeededSamples& needed) const {
    const auto& [tracer, kernel, clusters, rows, needy, records, plan, pace] = inputs_;
    const std::vector<Pixel> shared = shared_pixels(rows, needy);
    ErrorFindings findings;
    findings.samples = needed.outlook(needy, {plan.edge_spp, plan.pilot_spp}).error;
    findings.shared_pixels = static_cast<double>(shared.size());
    if (!has_records(tracer.task)) return findings;
    const NeedInputs inputs{tracer, clusters, plan.pilot_spp, records};
    const RecordCheckSize size = pace.check_size(plan);
    findings.at_shared = check_records(inputs, shared, size);
    findings.elsewhere =
        check_records(inputs, scattered_pixels(rows, clusters.width(), size.pixels), size);
    return findings;
}

/// Calls visit(row, number).
template <class Visit>
void BandTrials::visit_some(const Choice& choice, const Visit& visit) const {
    constexpr std::size_t kApart = 7;
    const auto all = static_cast<std::size_t>(needy_pixels_);
    const std::size_t step = std::max(all * choice.run / choice.pixels, choice.run);
    std::size_t at = kApart * choice.run * static_cast<std::size_t>(choice.number);
    for (std::size_t r = 0; r < inputs_.needy.size(); ++r) {
        const std::size_t end = at + inputs_.needy[r].size();
        for (std::size_t k = at; k < end; k = (k / step + 1) * step) {
            const std::size_t until = std::min(k / step * step + choice.run, end);
            for (std::size_t i = k; i < until; ++i) visit(r, i - at);
        }
        at = end;
    }
}

}  // namespace vecino
