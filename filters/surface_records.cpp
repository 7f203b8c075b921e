// SPDX-License-Identifier: Apache-2.0
#include "filters/surface_records.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <mutex>
#include <string>

#include "core/error.h"
#include "core/frame_planes.h"
#include "core/parallel.h"
#include "core/render_task.h"
#include "core/timing.h"
#include "filters/pixel_clusters.h"
#include "filters/pixel_needs.h"
#include "filters/record_resolve.h"
#include "filters/records.h"
#include "filters/surface_records_stages.h"

namespace vecino {
namespace {

// Pixels of a band: what is held of them at a time takes some 200 MB.
constexpr std::size_t kBandPixels = std::size_t{1} << 20;

void require(bool holds, const char* name, const std::string& found, const char* allowed) {
    if (holds) return;
    throw Error(ExitCode::usage, std::string(name) + ": found " + found + ", allowed: " + allowed);
}

void require_between(int value, int least, int most, const char* name) {
    const std::string allowed = std::to_string(least) + " to " + std::to_string(most);
    require(value >= least && value <= most, name, std::to_string(value), allowed.c_str());
}

void check_plan(const SurfaceRecordsPlan& plan, const RenderSettings& settings) {
    require_between(plan.pilot_spp, 1, 4096, "pilot_spp");
    require_between(plan.edge_spp, 0, 65536, "edge_spp");
    require_between(plan.cell, 1, 256, "cell");
    require_between(plan.levels, 0, 8, "levels");
    require_between(plan.record_paths, 1, 1 << 20, "record_paths");
    require_between(plan.refined_record_paths, 1, 1 << 20, "refined_record_paths");
    require(plan.fit_sigma > 0, "fit_sigma", std::to_string(plan.fit_sigma), "more than 0");
    require(plan.refine_tau > 0, "refine_tau", std::to_string(plan.refine_tau), "more than 0");
    for (const PlaneInfo& info : all_planes()) {
        const bool is_mean = kMeanPlanes.has(info.plane);
        require(!is_mean || !settings.planes.has(info.plane), "planes", std::string(info.name),
                "all but the means of first hits (with the method surface_records)");
    }
    require(settings.light_sampling == LightSampling::nee, "light_sampling", "none",
            "nee (with the method surface_records)");
}

/// One band of rows, from first samples to pixels.
class Band {
  public:
    struct Context {
        const RecordTracer& tracer;
        const TraceKernel& kernel;
        const RenderSettings& settings;
        const SurfaceRecordsPlan& plan;
        PixelClusters& clusters;  ///< with room for the rows
    };

    /// rows: to be made; sampled: those, and around them what their records are fitted to.
    Band(const Context& context, RowRange rows, RowRange sampled)
        : context_(context),
          tracer_(context.tracer),
          rows_(rows),
          clusters_(context.clusters),
          exceptions_(static_cast<std::size_t>(rows.end - rows.begin)) {
        clusters_.begin(sampled);
    }

    void run(StagedRender& out, const std::function<void()>& checkpoint) {
        const auto timed = [&](double& seconds, const auto& stage) {
            const Stopwatch watch;
            stage();
            seconds += watch.seconds();
            checkpoint();
        };
        RenderStatistics& statistics = out.render.statistics;
        Frame& frame = out.render.frame;
        timed(out.times.pilot_s, [&] { trace_pilot(frame, statistics); });
        timed(out.times.records_s, [&] { gather(statistics); });
        timed(out.times.fit_s, [&] { fit_records(map_, context_.plan, tracer_.threads); });
        timed(out.times.needs_s, [&] {
            needy_ = find_needy_pixels({tracer_, clusters_, map_, context_.plan}, rows_);
        });
        timed(out.times.samples_s, [&] { add_samples(statistics); });
        timed(out.times.resolve_s, [&] { resolve(frame, statistics); });
        for (const auto& row : needy_) out.counts.needy_pixels += row.size();
        for (const RecordLevel& level : map_.levels) out.counts.records += level.records.size();
    }

  private:
    template <class Body>
    void for_each_row(RowRange rows, const Body& body) const {
        for_each_block(static_cast<std::size_t>(rows.end - rows.begin), 1, tracer_.threads,
                       [&](BlockRange block) { body(rows.begin + static_cast<int>(block.begin)); });
    }

    void trace_pilot(Frame& frame, RenderStatistics& statistics) {
        const RenderSettings& settings = context_.settings;
        const bool wanted = common(settings.planes, kFirstHitPlanes) != Planes{};
        const bool centre = settings.first_hit == FirstHit::centre;
        std::atomic<std::uint64_t> rays = 0;
        for_each_row(clusters_.rows(), [&](int y) {
            const bool store = wanted && y >= rows_.begin && y < rows_.end;
            std::vector<FirstHitRecord> hits(store ? static_cast<std::size_t>(clusters_.width())
                                                   : 0);
            rays += clusters_.trace_row(tracer_, y, context_.plan.pilot_spp,
                                        store && !centre ? hits.data() : nullptr);
            if (store && centre) rays += trace_centres(y, hits);
            for (std::size_t x = 0; x < hits.size(); ++x)
                store_first_hit(hits[x], {static_cast<int>(x), y}, frame);
        });
        statistics.rays += rays;
        statistics.samples += static_cast<std::uint64_t>(clusters_.width()) *
                              static_cast<std::uint64_t>(rows_.end - rows_.begin) *
                              static_cast<std::uint64_t>(context_.plan.pilot_spp);
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

    /// Whether there is light that records stand for.
    [[nodiscard]] bool has_records() const {
        const TraceTask& task = tracer_.task;
        return task.max_depth > 1 || (task.max_depth == 1 && task.has_background);
    }

    void gather(RenderStatistics& statistics) {
        if (!has_records()) return;
        RecordWork work = gather_records(tracer_, clusters_, context_.plan);
        map_ = std::move(work.map);
        statistics.rays += work.rays;
        statistics.samples += work.paths;
        statistics.dropped_samples += work.dropped;
    }

    void add_samples(RenderStatistics& statistics) {
        std::atomic<std::uint64_t> rays = 0, samples = 0;
        for_each_row(rows_, [&](int y) {
            for (const NeedyPixel& pixel : needy_[row(y)]) {
                const auto pilot = static_cast<std::uint32_t>(context_.plan.pilot_spp);
                ClusterList list = clusters_.clusters(pixel.x, y);
                if (pixel.samples <= pilot && !list.crowded) continue;
                const int before = list.count;
                rays += tracer_.kernel.add_samples(
                    tracer_.task,
                    {pixel.x, y, pilot, pixel.samples, known_surface(pixel, list),
                     (pixel.needs & kNeedsShadow) != 0},
                    list);
                if (list.crowded) {
                    rays += trace_paths(pixel, y);
                    samples += crowded_samples(pixel);
                    continue;
                }
                samples += pixel.samples - pilot;
                for (int k = before; k < list.count; ++k)
                    rays += adopt(list.clusters[k], {pixel.x, y}, k);
                clusters_.store(pixel.x, y, list);
            }
        });
        statistics.rays += rays;
        statistics.samples += samples;
    }

    /// What is known of a crowded pixel is not all: it needs more samples than its clusters say.
    [[nodiscard]] std::uint32_t crowded_samples(const NeedyPixel& pixel) const {
        constexpr std::uint32_t kMore = 8;
        return std::max(pixel.samples, kMore * static_cast<std::uint32_t>(context_.plan.edge_spp));
    }

    /// A crowded pixel by plain paths.
    std::uint64_t trace_paths(const NeedyPixel& pixel, int y) {
        const std::uint32_t paths = crowded_samples(pixel);
        std::uint64_t rays = 0;
        PixelAccumulator sums(VarianceOf::nothing);
        SampleBlock block;
        for (std::uint32_t at = 0; at < paths; at += kBlockSamples) {
            const int count = std::min(kBlockSamples, static_cast<int>(paths - at));
            rays += context_.kernel.trace_samples(tracer_.task, {pixel.x, y, at, count}, block, {});
            sums.add(block, count);
        }
        std::array<ExactSum::Digits, kMostSums> digits;
        sums.sums(digits);
        exceptions_[row(y)].crowded.push_back({pixel.x, pixel_values(digits, VarianceOf::nothing)});
        return rays;
    }

    /// The quad or sphere that fills a pixel and all around it; else -1.
    [[nodiscard]] std::int32_t known_surface(const NeedyPixel& pixel,
                                             const ClusterList& list) const {
        const Cluster& cluster = list.clusters[0];
        const auto surface = static_cast<std::uint32_t>(cluster.surface);
        const bool simple =
            surface < tracer_.task.first_triangle || surface >= tracer_.task.first_sphere;
        const bool alone =
            (pixel.needs & kNeedsCoverage) == 0 && list.count == 1 && cluster.mirrors == 0;
        return alone && cluster.object >= 0 && simple ? cluster.surface : -1;
    }

    /// Gathers light for a surface that the first samples missed, if no record is near.
    std::uint64_t adopt(const Cluster& cluster, Pixel at, int number) {
        const ClusterMeans means = means_of(cluster);
        const bool reflects = means.albedo.x + means.albedo.y + means.albedo.z > 0;
        if (!has_records() || cluster.object < 0 || !reflects) return 0;
        Orphan orphan{at.x, number, {}};
        if (record_light(map_, {at.x, at.y, cluster.object, means.position, means.normal},
                         orphan.light)) {
            return 0;
        }
        RecordLight light;
        const std::uint64_t rays =
            tracer_.kernel.gather(tracer_.task,
                                  {at.x, at.y, cluster.first_sample,
                                   static_cast<std::uint32_t>(context_.plan.refined_record_paths)},
                                  light);
        for (std::size_t c = 0; c < 3; ++c) {
            orphan.light[c] = light.indirect[c];
            orphan.light[c + 3] = light.background[c];
        }
        exceptions_[row(at.y)].orphans.push_back(orphan);
        return rays;
    }

    void resolve(Frame& frame, RenderStatistics& statistics) const {
        std::atomic<std::uint64_t> non_finite = 0;
        for_each_row(rows_, [&](int y) {
            non_finite +=
                resolve_row({tracer_.task, clusters_, map_}, y, exceptions_[row(y)], frame);
        });
        statistics.non_finite_pixels += non_finite;
    }

    [[nodiscard]] std::size_t row(int y) const { return static_cast<std::size_t>(y - rows_.begin); }

    Context context_;
    const RecordTracer& tracer_;
    RowRange rows_;
    PixelClusters& clusters_;
    RecordMap map_;
    NeedyRows needy_;
    std::vector<RowExceptions> exceptions_;
};

/// What a frame can hold of the planes asked for.
Planes planes_to_make(const RenderSettings& settings) {
    Planes planes{Plane::radiance};
    for (const PlaneInfo& info : all_planes()) {
        if (info.plane != Plane::variance && settings.planes.has(info.plane))
            planes.add(info.plane);
    }
    return planes;
}

/// Rows of a band, whole cells of them.
int band_rows(Extent size, int cell) {
    const auto width = static_cast<std::size_t>(size.width);
    const int rows = static_cast<int>(std::max<std::size_t>(kBandPixels / width, 1));
    const int cells = std::max((rows + cell - 1) / cell, 16);
    return cells * cell;
}

}  // namespace

StagedRender render_in_stages(const Scene& scene, const RenderSettings& settings,
                              const SurfaceRecordsPlan& plan, const Progress& progress) {
    check_settings(settings);
    check_plan(plan, settings);
    const TraceKernel& kernel = kernel_for(settings.simd_width);
    const Extent size = reduced(settings.size, settings.reduction);
    StagedRender out{{make_frame(size, planes_to_make(settings)), {}}, {}, {}};
    RenderStatistics& statistics = out.render.statistics;
    statistics.threads = settings.threads > 0 ? settings.threads : default_thread_count();
    statistics.simd_width = kernel.width;
    if (scene.pattern != Pattern::none) {
        fill_pattern(out.render.frame, size);
        return out;
    }
    const Stopwatch scene_watch;
    const FlatScene flat = flatten(scene);
    const TraceTask task = render_task(scene, flat, settings);
    const RecordTracer tracer{task, *kernel.records, settings.threads};
    // Fits reach two cells around those that a pixel is blended from, which are one away.
    const int margin = 3 * plan.cell;
    const int rows = band_rows(size, plan.cell);
    out.counts.band_rows = rows;
    PixelClusters clusters(size.width, std::min(rows + 2 * margin, size.height),
                           static_cast<int>(task.light_count));
    statistics.scene_s = scene_watch.seconds();
    const Stopwatch trace_watch;
    int steps = 0;
    const int all_steps = 6 * ((size.height + rows - 1) / rows);
    const auto checkpoint = [&] {
        ++steps;
        if (progress && !progress(static_cast<double>(steps) / all_steps))
            throw Error(ExitCode::interrupted, "interrupted");
    };
    for (int top = 0; top < size.height; top += rows) {
        ++out.counts.bands;
        const RowRange made{top, std::min(top + rows, size.height)};
        const RowRange sampled{std::max(top - margin, 0), std::min(made.end + margin, size.height)};
        Band({tracer, kernel, settings, plan, clusters}, made, sampled).run(out, checkpoint);
    }
    statistics.trace_s = trace_watch.seconds();
    return out;
}

Render render_surface_records(const Scene& scene, const RenderSettings& settings,
                              const SurfaceRecordsPlan& plan, const Progress& progress) {
    return render_in_stages(scene, settings, plan, progress).render;
}

SurfaceRecordsPlan surface_records_plan(int spp) {
    // Of plain paths at 2, 4, 8, ... samples per pixel.
    constexpr SurfaceRecordsPlan kPlans[] = {
        {1, 16, 16, 0, 64, 64, 1.0, 0.15},      {2, 32, 8, 0, 64, 64, 1.0, 0.15},
        {4, 64, 8, 0, 256, 128, 1.0, 0.15},     {8, 128, 8, 0, 512, 256, 0.85, 0.15},
        {16, 256, 4, 1, 512, 256, 1.0, 0.15},   {16, 512, 4, 1, 1024, 512, 1.0, 0.15},
        {32, 1024, 4, 2, 2048, 1024, 1.0, 0.2},
    };
    const int step = static_cast<int>(std::floor(std::log2(std::max(spp, 2)))) - 1;
    constexpr int kLast = static_cast<int>(std::size(kPlans)) - 1;
    return kPlans[std::clamp(step, 0, kLast)];
}

}  // namespace vecino
