// SPDX-License-Identifier: Apache-2.0
#include "filters/record_band.h"

#include <atomic>
#include <optional>
#include <utility>
#include <vector>

#include "core/frame_planes.h"
#include "core/parallel.h"
#include "core/render_task.h"
#include "core/timing.h"
#include "filters/band_trials.h"
#include "filters/half_shadow.h"
#include "filters/needed_samples.h"
#include "filters/pixel_needs.h"
#include "filters/pixel_sampler.h"
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
          sampled_rows_(rows.sampled),
          clusters_(context.clusters),
          out_(out),
          plan_(out.plan),
          before_(out.render.statistics),
          exceptions_(static_cast<std::size_t>(rows.made.end - rows.made.begin)) {}

    void run() {
        StageTimes& times = out_.times;
        const bool paced = context_.pace != nullptr;
        if (paced) timed(times.trials_s, [&] { choose_pilot(); });
        timed(times.pilot_s, [&] { trace_pilot(); });
        context_.checkpoint();
        timed(times.needs_s, [&] { find_needs_of_rows(); });
        if (paced) choose_structure();
        timed(times.records_s, [&] { gather(); });
        context_.checkpoint();
        timed(times.fit_s, [&] { fit_records(map_, plan_, tracer_.threads); });
        timed(times.needs_s, [&] {
            needed_.emplace(NeedInputs{tracer_, clusters_, plan_.pilot_spp, map_}, rows_, needy_);
        });
        if (paced) timed(times.trials_s, [&] { choose_edges(); });
        if (plan_.edge_spp > 0) needed_->give(plan_.edge_spp, needy_);
        context_.checkpoint();
        timed(times.samples_s, [&] {
            const GivenSamples given{rows_, needy_, plan_.pilot_spp};
            smooth_half_shadow(tracer_, given, clusters_);
            add_samples();
            fit_half_shadow(tracer_, given, clusters_);
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
        clusters_.begin(sampled_rows_);
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
        // Pixels of several rows fill the packets that they share.
        const std::size_t rows = plan_.edge_spp < kOwnPacketSpp ? 4 : 1;
        for_each_block(needy_.size(), rows, tracer_.threads, [&](BlockRange block) {
            std::vector<NeedyPlace> places;
            for (std::size_t r = block.begin; r < block.end; ++r) {
                for (const NeedyPixel& pixel : needy_[r])
                    places.push_back({pixel, rows_.begin + static_cast<int>(r)});
            }
            sampler.sample(places, [&](const NeedyPlace& place, const SampledPixel& made) {
                rays += made.rays;
                samples += made.samples;
                take(place, made);
            });
        });
        out_.render.statistics.rays += rays;
        out_.render.statistics.samples += samples;
    }

    void take(const NeedyPlace& place, const SampledPixel& made) {
        RowExceptions& exceptions = exceptions_[row(place.y)];
        if (made.traced) {
            exceptions.traced.push_back(*made.traced);
        } else {
            clusters_.store(place.pixel.x, place.y, made.clusters);
        }
        exceptions.orphans.insert(exceptions.orphans.end(), made.orphans.begin(),
                                  made.orphans.end());
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

    [[nodiscard]] BandTrials trials() const {
        return BandTrials(
            {tracer_, context_.kernel, clusters_, rows_, needy_, map_, plan_, *context_.pace});
    }

    void choose_pilot() {
        const PilotCost cost = trials().pilot_cost();
        context_.pace->choose_pilot(cost, plan_);
        const auto pixels =
            static_cast<double>(clusters_.width()) * (sampled_rows_.end - sampled_rows_.begin);
        pilot_work_s_ = pixels * cost.of(plan_.pilot_spp);
    }

    void choose_structure() {
        StageTimes& times = out_.times;
        context_.pace->take_pilot(pilot_work_s_, times.pilot_s, times.needs_s);
        const int pilot_spp = plan_.pilot_spp;
        timed(times.trials_s,
              [&] { context_.pace->choose_structure(trials().structure(), plan_); });
        if (plan_.pilot_spp == pilot_spp) return;
        // The first look was too short: it is thrown away.
        out_.render.statistics = before_;
        timed(times.pilot_s, [&] { trace_pilot(); });
        timed(times.needs_s, [&] { find_needs_of_rows(); });
    }

    void choose_edges() {
        const BandTrials trials = this->trials();
        choose_edge_spp(trials);
        ErrorFindings findings = trials.errors(*needed_);
        const bool has_lamps = tracer_.task.light_count > 0;
        if (context_.pace->wants_paths(findings, plan_, has_lamps)) {
            plan_.edge_light = EdgeLight::paths;
            choose_edge_spp(trials);
            findings.samples = needed_->outlook(needy_, {plan_.edge_spp, plan_.pilot_spp}).error;
        }
        if (out_.counts.bands == 1)
            out_.expected_error = context_.pace->expected_error(findings, plan_);
    }

    void choose_edge_spp(const BandTrials& trials) {
        const double unit_s = trials.edge_unit_s(*needed_);
        context_.pace->choose_edges(
            [&](int edge_spp) { return trials.edge_work(*needed_, edge_spp); }, unit_s, plan_);
    }

    [[nodiscard]] std::size_t row(int y) const { return static_cast<std::size_t>(y - rows_.begin); }

    const BandContext& context_;
    const RecordTracer& tracer_;
    RowRange rows_, sampled_rows_;
    PixelClusters& clusters_;
    StagedRender& out_;
    SurfaceRecordsPlan& plan_;
    RecordMap map_;
    NeedyRows needy_;
    RenderStatistics before_;  ///< this band
    double pilot_work_s_ = 0;  ///< of one thread
    std::optional<NeededSamples> needed_;
    std::vector<RowExceptions> exceptions_;
};

}  // namespace

void make_band(const BandContext& context, const BandRows& rows, StagedRender& out) {
    Band(context, rows, out).run();
}

}  // namespace vecino
