// SPDX-License-Identifier: Apache-2.0
#include "filters/record_band.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "core/frame_planes.h"
#include "core/parallel.h"
#include "core/render_task.h"
#include "core/timing.h"
#include "filters/half_shadow.h"
#include "filters/needed_samples.h"
#include "filters/pixel_needs.h"
#include "filters/pixel_sampler.h"
#include "filters/record_check.h"
#include "filters/record_resolve.h"
#include "filters/records.h"

namespace vecino {
namespace {

class Band {
  public:
    Band(const BandContext& context, const BandRows& rows, StagedRender& out)
        : context_(context),
          tracer_(context.tracer),
          rows_(rows.made),
          clusters_(context.clusters),
          out_(out),
          plan_(out.plan),
          exceptions_(static_cast<std::size_t>(rows.made.end - rows.made.begin)) {
        clusters_.begin(rows.sampled);
    }

    void run() {
        StageTimes& times = out_.times;
        const bool paced = context_.pace != nullptr;
        if (paced) timed(times.trials_s, [&] { choose_pilot(); });
        timed(times.pilot_s, [&] { trace_pilot(); });
        context_.checkpoint();
        timed(times.needs_s, [&] { find_needs_of_rows(); });
        if (paced) context_.pace->take_stage(pilot_work_s_, times.pilot_s);
        if (paced) timed(times.trials_s, [&] { choose_structure(); });
        timed(times.records_s, [&] { gather(); });
        context_.checkpoint();
        timed(times.fit_s, [&] { fit_records(map_, plan_, tracer_.threads); });
        timed(times.needs_s, [&] {
            needed_.emplace(NeedInputs{tracer_, clusters_, map_}, rows_, needy_);
        });
        if (paced) timed(times.trials_s, [&] { choose_edges(); });
        if (plan_.edge_spp > 0) needed_->give(plan_.edge_spp, needy_);
        context_.checkpoint();
        timed(times.samples_s, [&] {
            smooth_half_shadow(tracer_, {rows_, needy_, plan_.pilot_spp}, clusters_);
            add_samples();
        });
        context_.checkpoint();
        timed(times.resolve_s, [&] { resolve(); });
        context_.checkpoint();
        for (const auto& row : needy_) out_.counts.needy_pixels += row.size();
        for (const RecordLevel& level : map_.levels) out_.counts.records += level.records.size();
    }

  private:
    static void timed(double& seconds, const std::function<void()>& stage) {
        const Stopwatch watch;
        stage();
        seconds += watch.seconds();
    }

    template <class Body>
    void for_each_row(RowRange rows, const Body& body) const {
        for_each_block(static_cast<std::size_t>(rows.end - rows.begin), 1, tracer_.threads,
                       [&](BlockRange block) { body(rows.begin + static_cast<int>(block.begin)); });
    }

    // ------------------------------------------------------------ stages

    void trace_pilot() {
        const RenderSettings& settings = context_.settings;
        const bool wanted = common(settings.planes, kFirstHitPlanes) != Planes{};
        const bool centre = settings.first_hit == FirstHit::centre;
        std::atomic<std::uint64_t> rays = 0;
        for_each_row(clusters_.rows(), [&](int y) {
            const bool store = wanted && y >= rows_.begin && y < rows_.end;
            std::vector<FirstHitRecord> hits(store ? static_cast<std::size_t>(clusters_.width())
                                                   : 0);
            rays += clusters_.trace_row(tracer_, y, plan_.pilot_spp,
                                        store && !centre ? hits.data() : nullptr);
            if (store && centre) rays += trace_centres(y, hits);
            for (std::size_t x = 0; x < hits.size(); ++x)
                store_first_hit(hits[x], {static_cast<int>(x), y}, out_.render.frame);
        });
        out_.render.statistics.rays += rays;
        out_.render.statistics.samples += static_cast<std::uint64_t>(clusters_.width()) *
                                          static_cast<std::uint64_t>(rows_.end - rows_.begin) *
                                          static_cast<std::uint64_t>(plan_.pilot_spp);
    }

    std::uint64_t trace_centres(int y, std::vector<FirstHitRecord>& hits) const {
        std::uint64_t rays = 0;
        for (int x = 0; x < clusters_.width(); x += kBlockSamples) {
            const int count = std::min(kBlockSamples, clusters_.width() - x);
            rays += context_.kernel.trace_centres(tracer_.task, {x, y, 0, count},
                                                  &hits[static_cast<std::size_t>(x)]);
        }
        return rays;
    }

    void find_needs_of_rows() {
        if (plan_.edge_spp > 0) {
            needy_ = find_needs(tracer_, clusters_, rows_, plan_.pilot_spp);
        } else {
            needy_.resize(exceptions_.size());
        }
    }

    void gather() {
        if (!has_records(tracer_.task)) return;
        CountRecords count;
        if (context_.pace != nullptr) {
            count = [this](const RecordCount& level) { context_.pace->choose_paths(level, plan_); };
        }
        RecordWork work = gather_records({tracer_, clusters_}, plan_, count);
        map_ = std::move(work.map);
        RenderStatistics& statistics = out_.render.statistics;
        statistics.rays += work.rays;
        statistics.samples += work.paths;
        statistics.dropped_samples += work.dropped;
    }

    [[nodiscard]] PixelSampler sampler() const {
        return PixelSampler({tracer_, context_.kernel, clusters_, map_, plan_});
    }

    void add_samples() {
        const PixelSampler sampler = this->sampler();
        std::atomic<std::uint64_t> rays = 0, samples = 0;
        for_each_row(rows_, [&](int y) {
            RowExceptions& exceptions = exceptions_[row(y)];
            for (const NeedyPixel& pixel : needy_[row(y)]) {
                const SampledPixel made = sampler.sample(pixel, y);
                rays += made.rays;
                samples += made.samples;
                if (made.samples == 0) continue;
                if (made.traced) {
                    exceptions.traced.push_back(*made.traced);
                } else {
                    clusters_.store(pixel.x, y, made.clusters);
                }
                exceptions.orphans.insert(exceptions.orphans.end(), made.orphans.begin(),
                                          made.orphans.end());
            }
        });
        out_.render.statistics.rays += rays;
        out_.render.statistics.samples += samples;
    }

    void resolve() {
        std::atomic<std::uint64_t> non_finite = 0;
        for_each_row(rows_, [&](int y) {
            non_finite += resolve_row({tracer_.task, clusters_, map_}, y, exceptions_[row(y)],
                                      out_.render.frame);
        });
        out_.render.statistics.non_finite_pixels += non_finite;
    }

    // ------------------------------------------------------------ choices of a pace

    void choose_pilot() {
        context_.pace->choose_pilot(try_first_samples(1), plan_);
        const auto pixels = static_cast<double>(clusters_.width()) *
                            (clusters_.rows().end - clusters_.rows().begin);
        pilot_work_s_ = pixels * try_first_samples(plan_.pilot_spp);
    }

    /// Seconds of one thread for a pixel with so many.
    double try_first_samples(int samples) const {
        constexpr int kBlocks = 48, kApart = 5;
        const int columns = (clusters_.width() + kPilotPixels - 1) / kPilotPixels;
        const int blocks = columns * (rows_.end - rows_.begin);
        const int step = std::max(blocks / kBlocks, 1);
        return context_.pace->typical([&](int number) {
            int pixels = 0;
            const ThreadStopwatch watch;
            for (int i = kApart * number % step; i < blocks; i += step, pixels += kPilotPixels) {
                const Pixel at{i % columns * kPilotPixels, rows_.begin + i / columns};
                clusters_.try_samples(tracer_, at, samples);
            }
            return watch.seconds() / pixels;
        });
    }

    void choose_structure() {
        constexpr std::uint32_t kTrySamples = 32;
        constexpr double kFitNoise = 0.06;  // of a record's own, once it is fitted to those around
        PaceFindings findings;
        findings.needy_pixels = needy_pixels();
        if (has_records(tracer_.task)) {
            findings.has_record_light = false;
            findings.path_s = context_.pace->typical([this, &findings](int number) {
                const RecordTrial made = try_records({tracer_, clusters_}, number);
                findings.records_at_16 = made.records_at_16;
                findings.has_record_light |= made.has_light;
                findings.surfaces = made.surfaces;
                findings.record_noise =
                    kFitNoise * made.noise * std::pow(made.paths / 512.0, kRecordSlope);
                return made.path_s;
            });
        }
        findings.sample_s = context_.pace->typical([this](int number) {
            return try_pixels(number, [this](std::size_t, std::size_t) {
                return static_cast<std::uint32_t>(plan_.pilot_spp) + kTrySamples;
            });
        });
        context_.pace->choose_structure(findings, plan_);
    }

    void choose_edges() {
        choose_edge_spp();
        ErrorFindings findings = find_errors();
        // Of lamps paths know by chance what clusters know exactly.
        if (tracer_.task.light_count == 0 && context_.pace->wants_paths(findings, plan_)) {
            plan_.edge_light = EdgeLight::paths;
            choose_edge_spp();
            findings.samples = needed_->error(needy_, plan_.edge_spp, plan_.pilot_spp);
        }
        if (out_.counts.bands == 1)
            out_.expected_error = context_.pace->expected_error(findings, plan_);
    }

    ErrorFindings find_errors() const {
        const std::vector<Pixel> shared = shared_pixels(rows_, needy_);
        ErrorFindings findings;
        findings.samples = needed_->error(needy_, plan_.edge_spp, plan_.pilot_spp);
        findings.shared_pixels = static_cast<double>(shared.size());
        if (!has_records(tracer_.task)) return findings;
        const NeedInputs inputs{tracer_, clusters_, map_};
        const RecordCheckSize size = context_.pace->check_size(plan_);
        findings.at_shared = check_records(inputs, shared, size);
        findings.elsewhere =
            check_records(inputs, scattered_pixels(rows_, clusters_.width(), size.pixels), size);
        return findings;
    }

    void choose_edge_spp() {
        constexpr int kManySpp = 256;  // more take as long each
        const int edge_spp = std::clamp(plan_.edge_spp, kLeastEdgeSpp, kManySpp);
        const auto given = [this, edge_spp](std::size_t row, std::size_t i) {
            return needed_->samples(row, i, edge_spp);
        };
        const double unit_s =
            context_.pace->typical([&](int number) { return try_pixels(number, given); });
        context_.pace->choose_edges([this](int samples) { return work_of(samples); }, unit_s,
                                    plan_);
    }

    /// Seconds of one thread for a unit of work on needy pixels. samples: of a pixel, by row and
    /// number.
    double try_pixels(int number,
                      const std::function<std::uint32_t(std::size_t, std::size_t)>& samples) const {
        struct Place {
            NeedyPixel pixel;
            int y;
        };
        std::vector<Place> places;
        // All trials together are a quarter of what there is to do, at most.
        const auto pixels = static_cast<std::size_t>(std::clamp(needy_pixels() / 16, 16.0, 128.0));
        visit_some({number, pixels, 16}, [&](std::size_t r, std::size_t i) {
            places.push_back({needy_[r][i], rows_.begin + static_cast<int>(r)});
            places.back().pixel.samples = samples(r, i);
        });
        const PixelSampler sampler = this->sampler();
        double work = 0;
        for (const Place& place : places) work += sampler.work(place.pixel, place.y);
        const ThreadStopwatch watch;
        for (const Place& place : places) (void)sampler.sample(place.pixel, place.y);
        return watch.seconds() / std::max(work, 1.0);
    }

    /// Extrapolated from some of the needy pixels.
    double work_of(int edge_spp) const {
        SurfaceRecordsPlan plan = plan_;
        plan.edge_spp = edge_spp;
        const PixelSampler sampler({tracer_, context_.kernel, clusters_, map_, plan});
        double work = 0, count = 0;
        visit_some({0, 1024, 1}, [&](std::size_t r, std::size_t i) {
            NeedyPixel pixel = needy_[r][i];
            pixel.samples = needed_->samples(r, i, edge_spp);
            work += sampler.work(pixel, rows_.begin + static_cast<int>(r));
            ++count;
        });
        return count > 0 ? work * needy_pixels() / count : 0;
    }

    [[nodiscard]] double needy_pixels() const {
        std::size_t all = 0;
        for (const auto& row : needy_) all += row.size();
        return static_cast<double>(all);
    }

    /// Some of the needy pixels: about so many, in runs of neighbours, as they are sampled in.
    struct Choice {
        int number;  ///< others for each
        std::size_t pixels, run;
    };

    /// Calls visit(row, number) for them.
    template <class Visit>
    void visit_some(const Choice& choice, const Visit& visit) const {
        constexpr std::size_t kApart = 7;
        const auto all = static_cast<std::size_t>(needy_pixels());
        const std::size_t step = std::max(all * choice.run / choice.pixels, choice.run);
        std::size_t at = kApart * choice.run * static_cast<std::size_t>(choice.number);
        for (std::size_t r = 0; r < needy_.size(); ++r) {
            for (std::size_t i = 0; i < needy_[r].size(); ++i, ++at) {
                if (at % step < choice.run) visit(r, i);
            }
        }
    }

    [[nodiscard]] std::size_t row(int y) const { return static_cast<std::size_t>(y - rows_.begin); }

    const BandContext& context_;
    const RecordTracer& tracer_;
    RowRange rows_;
    PixelClusters& clusters_;
    StagedRender& out_;
    SurfaceRecordsPlan& plan_;
    RecordMap map_;
    NeedyRows needy_;
    double pilot_work_s_ = 0;  ///< of one thread
    std::optional<NeededSamples> needed_;
    std::vector<RowExceptions> exceptions_;
};

}  // namespace

void make_band(const BandContext& context, const BandRows& rows, StagedRender& out) {
    Band(context, rows, out).run();
}

}  // namespace vecino
