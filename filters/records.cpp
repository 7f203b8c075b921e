// SPDX-License-Identifier: Apache-2.0
#include "filters/records.h"

#include <algorithm>
#include <atomic>
#include <glm/geometric.hpp>
#include <utility>

#include "core/color.h"
#include "core/parallel.h"
#include "core/timing.h"
#include "filters/record_placement.h"
#include "filters/surface_records_stages.h"

namespace vecino {

RecordLevel::RecordLevel(int cell, int width, RowRange rows)
    : cell_(cell),
      columns_((width + cell - 1) / cell),
      rows_{rows.begin / cell, (rows.end + cell - 1) / cell} {
    const std::size_t cells =
        static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_.end - rows_.begin);
    active.assign(cells, 0);
    first.assign(cells + 1, 0);
}

namespace {

constexpr float kLeastGrazing = 0.15f;  ///< beyond, footprints do not grow
// Cells are halved where normals turn by more than 14 degrees away from the record's.
constexpr float kCurved = 0.97f;

glm::vec3 vector(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

/// What a pixel is wide, per distance from the camera.
float pixel_width(const TraceTask& task) {
    return 2.0f * glm::length(vector(task.camera_up)) / static_cast<float>(task.height);
}

Record make_record(const TraceTask& task, const Candidate& candidate, int cell,
                   const RecordLight& light) {
    Record record{};
    record.object = light.object;
    record.position_world = vector(light.position);
    record.normal_world = vector(light.normal);
    record.x = static_cast<float>(candidate.seed.x) + 0.5f;
    record.y = static_cast<float>(candidate.seed.y) + 0.5f;
    record.footprint_world = light.distance * pixel_width(task) * static_cast<float>(cell);
    record.grazing_cosine = std::max(light.cosine, kLeastGrazing);
    record.nearness = light.inverse_distance;
    record.least_cosine = candidate.least_cosine;
    for (std::size_t c = 0; c < 3; ++c) {
        record.light[c] = light.indirect[c];
        record.light[c + 3] = light.background[c];
    }
    return record;
}

void gather_level(const RecordTracer& tracer, const Candidates& candidates, int paths,
                  RecordLevel& level, RecordWork& work) {
    constexpr std::size_t kRecordsPerBlock = 4;
    level.records.resize(candidates.size());
    std::atomic<std::uint64_t> rays = 0, dropped = 0;
    for_each_block(candidates.size(), kRecordsPerBlock, tracer.threads, [&](BlockRange block) {
        for (std::size_t i = block.begin; i < block.end; ++i) {
            const RecordSeed& seed = candidates[i].seed;
            RecordLight light;
            rays += tracer.kernel.gather(
                tracer.task, {seed.x, seed.y, seed.sample, static_cast<std::uint32_t>(paths)},
                light);
            dropped += light.dropped;
            level.records[i] = make_record(tracer.task, candidates[i], level.cell(), light);
        }
    });
    work.rays += rays;
    work.dropped += dropped;
    work.paths += candidates.size() * static_cast<std::uint64_t>(paths);
}

bool wants_halving(const Record& record, double tau) {
    const float reach = record.footprint_world / record.grazing_cosine;
    return record.least_cosine < kCurved || reach * record.nearness > static_cast<float>(tau);
}

/// The next level: of cells halved, those whose records ask for it. Empty if none does.
RecordLevel halve(const RecordLevel& level, int width, RowRange rows, double tau) {
    RecordLevel next(level.cell() / 2, width, rows);
    for (int row = level.rows().begin; row < level.rows().end; ++row) {
        for (int column = 0; column < level.columns(); ++column) {
            const auto records = level.at(column, row);
            if (std::ranges::none_of(records,
                                     [tau](const Record& r) { return wants_halving(r, tau); })) {
                continue;
            }
            for (int k = 0; k < 4; ++k) {
                const int c = 2 * column + k % 2, r = 2 * row + k / 2;
                if (next.is_inside(c, r)) next.active[next.index(c, r)] = 1;
            }
        }
    }
    return next;
}

/// Seconds for a path of some of the records, by all threads: what one thread takes alone says too
/// little of that.
double time_some(const RecordTracer& tracer, const Candidates& candidates, int paths,
                 const RecordLevel& level) {
    constexpr std::size_t kOneOf = 32, kAtLeast = 32;
    const std::size_t step = std::clamp(candidates.size() / kAtLeast, std::size_t{1}, kOneOf);
    Candidates some;
    for (std::size_t i = 0; i < candidates.size(); i += step) some.push_back(candidates[i]);
    RecordLevel scratch(level.cell(), level.cell(), {0, level.cell()});
    RecordWork work;
    const Stopwatch watch;
    gather_level(tracer, some, paths, scratch, work);
    return watch.seconds() /
           std::max(static_cast<double>(some.size()) * (paths + kRecordStart), 1.0);
}

/// Of a record's light where its pixel shows it, in sRGB, by the same with other paths; of what is
/// too bright to be shown none.
double shown_noise(const RecordInputs& inputs, const Record& record, const Record& other) {
    const Cluster cluster =
        inputs.clusters.first_cluster(static_cast<int>(record.x), static_cast<int>(record.y));
    if (cluster.object != record.object) return 0;  // an edge: it has noise of its own
    const ClusterMeans means = means_of(cluster);
    const glm::vec3 direct = direct_light(inputs.tracer.task, cluster);
    double sum = 0;
    for (int c = 0; c < 3; ++c) {
        const auto i = static_cast<std::size_t>(c);
        const float light = record.light[i] + record.light[i + 3];
        const float difference = light - other.light[i] - other.light[i + 3];
        const float shown = means.emission[c] + means.albedo[c] * (direct[c] + light);
        if (!(shown < 1)) continue;
        const float off = means.albedo[c] * srgb_slope(shown) * difference;
        sum += static_cast<double>(off * off) / 2;
    }
    return sum / 3;
}

}  // namespace

RecordWork gather_records(const RecordInputs& inputs, const SurfaceRecordsPlan& plan,
                          const CountRecords& count) {
    const auto& [tracer, clusters] = inputs;
    RecordWork work;
    work.map.channels = tracer.task.has_background ? kRecordChannels : 3;
    RecordLevel level(plan.cell, clusters.width(), clusters.rows());
    std::ranges::fill(level.active, std::uint8_t{1});
    for (int number = 0;; ++number) {
        const Candidates candidates = place_records(clusters, level, tracer.threads);
        const int& paths = number == 0 ? plan.record_paths : plan.refined_record_paths;
        if (count) count({number, candidates.size(), time_some(tracer, candidates, paths, level)});
        gather_level(tracer, candidates, paths, level, work);
        work.map.levels.push_back(std::move(level));
        const RecordLevel& made = work.map.levels.back();
        if (number == plan.levels || made.cell() % 2 != 0) return work;
        level = halve(made, clusters.width(), clusters.rows(), plan.refine_tau);
        if (std::ranges::none_of(level.active, [](std::uint8_t a) { return a != 0; })) return work;
    }
}

std::size_t count_records(const RecordInputs& inputs, int cell) {
    RecordLevel level(cell, inputs.clusters.width(), inputs.clusters.rows());
    std::ranges::fill(level.active, std::uint8_t{1});
    return place_records(inputs.clusters, level, inputs.tracer.threads).size();
}

RecordTrial try_records(const RecordInputs& inputs, int number) {
    constexpr std::uint32_t kOtherSeed = 0x9e3779b9u;
    constexpr std::size_t kCells = 48, kRun = 8, kApart = 5;  // neighbours, as records are made in
    constexpr int kPaths = 32;
    RecordLevel level(16, inputs.clusters.width(), inputs.clusters.rows());
    const std::size_t step = std::max(level.active.size() * kRun / kCells, kRun);
    const std::size_t first = kApart * kRun * static_cast<std::size_t>(number);
    double cells = 0;
    for (std::size_t i = 0; i < level.active.size(); ++i) {
        level.active[i] = (first + i) % step < kRun ? 1 : 0;
        cells += level.active[i];
    }
    const double one_of = static_cast<double>(level.active.size()) / std::max(cells, 1.0);
    const RecordTracer tracer{inputs.tracer.task, inputs.tracer.kernel, 1};
    const Candidates candidates = place_records(inputs.clusters, level, tracer.threads);
    double occupied = 0;
    for (std::size_t i = 0; i < level.active.size(); ++i)
        occupied += level.first[i + 1] > level.first[i] ? 1 : 0;
    TraceTask other_paths = inputs.tracer.task;
    other_paths.seed += kOtherSeed;
    RecordLevel others(level.cell(), level.cell(), {0, level.cell()});
    RecordWork work;
    const ThreadStopwatch watch;
    gather_level(tracer, candidates, kPaths, level, work);
    gather_level({other_paths, tracer.kernel, 1}, candidates, kPaths, others, work);
    const double seconds = watch.seconds() / 2;
    const auto records = std::max(static_cast<double>(candidates.size()), 1.0);
    glm::vec3 light(0.0f);
    std::vector<double> noise;
    for (std::size_t i = 0; i < level.records.size(); ++i) {
        const Record& record = level.records[i];
        for (std::size_t c = 0; c < 3; ++c)
            light[static_cast<int>(c)] += record.light[c] + record.light[c + 3];
        noise.push_back(shown_noise(inputs, record, others.records[i]));
    }
    return {static_cast<double>(candidates.size()) * one_of,
            seconds / (records * (kPaths + kRecordStart)),
            std::move(noise),
            kPaths,
            light / static_cast<float>(records),
            records / std::max(occupied, 1.0)};
}

}  // namespace vecino
