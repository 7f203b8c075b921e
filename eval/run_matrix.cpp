// SPDX-License-Identifier: Apache-2.0
#include "eval/run_matrix.h"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <map>
#include <memory>
#include <set>

#include "core/error.h"
#include "core/files.h"
#include "core/image_io.h"
#include "core/timing.h"
#include "eval/commands.h"
#include "eval/metrics_json.h"
#include "eval/progress.h"
#include "eval/reference_store.h"
#include "eval/run_directory.h"

namespace vecino {
namespace {

// A stage that takes longer than this averages its own noise, and is timed once.
constexpr double kRepeatBelow_s = 0.5;

std::string settings_key(const std::string& scene, const RenderSettings& settings) {
    Cell cell;
    cell.scene = scene;
    cell.settings = settings;
    return cell.parameters_json().dump();
}

/// A frame and the cells that read it.
struct FrameJob {
    std::vector<const Cell*> cells;
    RenderSettings settings;

    [[nodiscard]] double samples() const {
        return static_cast<double>(reduced(settings.size, settings.reduction).area()) *
               settings.spp;
    }
};

struct TimedFrame {
    Frame frame;
    RenderStatistics statistics;  ///< times are medians
};

class Runner {
  public:
    Runner(const Matrix& matrix, RunDirectory directory, const RunOptions& options)
        : matrix_(matrix), directory_(std::move(directory)), cells_(expand(matrix)) {
        const nlohmann::json versions = version_json();
        build_ = versions["build"].get<std::string>();
        run_ = {{"name", matrix.name}, {"config", matrix.document}, {"versions", versions}};
        require_same_matrix();
        for (const Cell& cell : cells_) load_scene_of(cell);
        old_rows_ = directory_.rows();
        plan_ = plan_run(cells_, options, [this](const Cell& cell) { return state_of(cell); });
    }

    RunSummary run() {
        RunSummary summary;
        keep_old_rows(summary);
        write_run();
        const std::vector<FrameJob> jobs = pending_jobs();
        total_samples_ = planned_samples(jobs);
        ProgressBar bar(matrix_.name);
        bar_ = &bar;
        try {
            for (const FrameJob& job : jobs) run_job(job);
        } catch (const Error& error) {
            if (error.code() != ExitCode::interrupted) throw;
            summary.was_interrupted = true;
        }
        write_results();
        write_run();
        count(summary);
        return summary;
    }

    RunEstimate estimate() {
        RunEstimate result;
        const std::vector<FrameJob> jobs = pending_jobs();
        for (const FrameJob& job : jobs) {
            for (const Cell* cell : job.cells) result.cells.push_back(cell->name);
        }
        result.samples = planned_samples(jobs);
        std::set<std::string> references;
        for (const FrameJob& job : jobs) {
            const Cell& first = *job.cells.front();
            result.time_s += job.samples() / rate(first.scene, job.settings);
            const RenderSettings reference = reference_settings(matrix_, first);
            if (!references.insert(settings_key(first.scene, reference)).second) continue;
            result.time_s += FrameJob{{}, reference}.samples() / rate(first.scene, reference);
        }
        return result;
    }

  private:
    // Another matrix's results would be lost when results.jsonl is written anew.
    void require_same_matrix() const {
        const std::string file = directory_.file("run.json");
        if (!std::filesystem::exists(file)) return;
        const nlohmann::json before = nlohmann::json::parse(read_file(file), nullptr, false);
        const std::string name = before.is_object() ? before.value("name", "") : "";
        if (name == matrix_.name) return;
        throw Error(ExitCode::usage, directory_.path() + ": found results of the matrix \"" + name +
                                         "\", allowed: \"" + matrix_.name +
                                         "\" or an empty directory");
    }

    void load_scene_of(const Cell& cell) {
        if (scenes_.contains(cell.scene)) return;
        scenes_.emplace(cell.scene, load_scene(cell.scene));
        scene_hashes_[cell.scene] = text_hash(read_file(cell.scene));
    }

    CellState state_of(const Cell& cell) const {
        const auto old = old_rows_.find(cell.name);
        if (old == old_rows_.end()) return CellState::missing;
        const nlohmann::json& row = old->second;
        const bool same_question =
            row.value("params", nlohmann::json()) == cell.parameters_json() &&
            row.value("reference", nlohmann::json()) == reference_json(cell);
        if (!same_question) return CellState::missing;
        if (row.value("status", "") != "ok") return CellState::failed;
        if (!std::filesystem::exists(directory_.file("cells/" + cell.name + "/image.exr")))
            return CellState::missing;
        const bool same_program = row.value("build", "") == build_ &&
                                  row.value("scene_hash", "") == scene_hashes_.at(cell.scene);
        return same_program ? CellState::finished : CellState::stale;
    }

    // A row stays until a new one takes its place: an interruption loses nothing.
    void keep_old_rows(RunSummary& summary) {
        for (const PlannedCell& planned : plan_) {
            if (planned.state == CellState::missing) continue;
            rows_[planned.cell->name] = old_rows_.at(planned.cell->name);
            if (planned.run) continue;
            ++summary.kept;
            summary.stale += planned.state == CellState::stale ? 1 : 0;
        }
    }

    void count(RunSummary& summary) const {
        summary.cells = cells_.size();
        summary.done = done_cells_;
        summary.missing = cells_.size() - rows_.size();
        for (const auto& [name, row] : rows_) summary.failed += row["status"] != "ok" ? 1 : 0;
    }

    /// What is to do, by frame, in the order of the cells.
    std::vector<FrameJob> pending_jobs() const {
        std::vector<FrameJob> jobs;
        std::map<std::string, std::size_t> by_key;
        for (const PlannedCell& planned : plan_) {
            if (!planned.run) continue;
            const Cell& cell = *planned.cell;
            const auto [entry, is_new] =
                by_key.try_emplace(settings_key(cell.scene, cell.settings), jobs.size());
            if (is_new) jobs.push_back({{}, cell.settings});
            FrameJob& job = jobs[entry->second];
            if (is_new) job.settings.planes = {Plane::radiance};
            add_planes(cell, job.settings.planes);
            job.cells.push_back(&cell);
        }
        return jobs;
    }

    /// Samples per second, from a short render of the same kind.
    double rate(const std::string& scene, RenderSettings settings) {
        settings.size = {64, 64};
        settings.reduction = 1;
        settings.spp = 64;
        const std::string key = settings_key(scene, settings);
        const auto known = rates_.find(key);
        if (known != rates_.end()) return known->second;
        const RenderStatistics s = render(scenes_.at(scene), settings).statistics;
        const double measured = static_cast<double>(s.samples) / std::max(s.trace_s, 1e-6);
        return rates_.emplace(key, measured).first->second;
    }

    // Only what some scheme reads is traced and kept.
    static void add_planes(const Cell& cell, Planes& planes) {
        if (cell.scheme == nullptr) return;
        for (const PlaneInfo& info : all_planes()) {
            if (cell.scheme->needs.has(info.plane)) planes.add(info.plane);
        }
        if (cell.scheme->needs.has(Plane::position)) planes.add(Plane::id);
    }

    double planned_samples(const std::vector<FrameJob>& jobs) const {
        double total = 0;
        std::set<std::string> references;
        for (const FrameJob& job : jobs) {
            total += job.samples();
            const RenderSettings reference = reference_settings(matrix_, *job.cells.front());
            const std::string key = settings_key(job.cells.front()->scene, reference);
            if (references.insert(key).second) total += FrameJob{{}, reference}.samples();
        }
        return total;
    }

    Render render_with_progress(const std::string& scene, const RenderSettings& settings,
                                const std::string& label) {
        bar_->label(matrix_.name + ": " + label);
        const double samples = FrameJob{{}, settings}.samples();
        Render result = render(scenes_.at(scene), settings, [&](double done) {
            return bar_->update((done_samples_ + done * samples) / total_samples_);
        });
        done_samples_ += samples;
        return result;
    }

    nlohmann::json reference_json(const Cell& cell) const {
        const RenderSettings s = reference_settings(matrix_, cell);
        return nlohmann::json::parse(settings_key(cell.scene, s));
    }

    const StoredReference& reference_of(const Cell& cell) {
        RenderSettings settings = reference_settings(matrix_, cell);
        const std::string key =
            settings_key(cell.scene, settings) + scene_hashes_.at(cell.scene) + build_;
        return references_.get(key, stem(cell.scene), [&] {
            settings.planes = {Plane::radiance};
            return render_with_progress(cell.scene, settings, stem(cell.scene) + " reference")
                .frame.radiance;
        });
    }

    TimedFrame trace(const FrameJob& job) {
        const Cell& first = *job.cells.front();
        const std::string label = first.name;
        std::vector<double> scene_s;
        std::vector<double> trace_s;
        Render result;
        for (int i = 0; i < matrix_.repeat; ++i) {
            result = i == 0 ? render_with_progress(first.scene, job.settings, label)
                            : render(scenes_.at(first.scene), job.settings);
            scene_s.push_back(result.statistics.scene_s);
            trace_s.push_back(result.statistics.trace_s);
            if (result.statistics.trace_s > kRepeatBelow_s) break;
        }
        result.statistics.scene_s = median(scene_s);
        result.statistics.trace_s = median(trace_s);
        return {std::move(result.frame), result.statistics};
    }

    void run_job(const FrameJob& job) {
        if (interrupted()) throw Error(ExitCode::interrupted, "interrupted");
        const StoredReference& reference = reference_of(*job.cells.front());
        const TimedFrame traced = trace(job);
        for (const Cell* cell : job.cells) run_cell(*cell, traced, reference);
    }

    void run_cell(const Cell& cell, const TimedFrame& traced, const StoredReference& reference) {
        nlohmann::json row{{"cell", cell.name},
                           {"group", cell.group},
                           {"scene", stem(cell.scene)},
                           {"method", cell.method()},
                           {"seed", cell.settings.seed},
                           {"params", cell.parameters_json()},
                           {"samples_ratio", cell.samples_ratio},
                           {"reference", reference_json(cell)},
                           {"reference_file", reference.file},
                           {"scene_hash", scene_hashes_.at(cell.scene)},
                           {"build", build_},
                           {"host", run_["versions"]["cpu"]},
                           {"threads", traced.statistics.threads}};
        try {
            measure(cell, traced, reference.image, row);
        } catch (const Error& error) {
            row["status"] = "failed";
            row["reason"] = error.what();
        }
        directory_.append(row);
        rows_[cell.name] = row;
        ++done_cells_;
    }

    Reconstruction reconstruct_timed(const Cell& cell, const Frame& low, double& seconds) const {
        std::vector<double> times;
        Reconstruction result;
        for (int i = 0; i < matrix_.repeat; ++i) {
            const Stopwatch watch;
            result = reconstruct(low, *cell.scheme, {cell.settings.size, cell.parameters, 0});
            times.push_back(watch.seconds());
            if (times.back() > kRepeatBelow_s) break;
        }
        seconds = median(times);
        return result;
    }

    void measure(const Cell& cell, const TimedFrame& traced, const Image& reference,
                 nlohmann::json& row) const {
        const RenderStatistics& s = traced.statistics;
        double reconstruct_s = 0;
        Reconstruction built;
        if (cell.scheme == nullptr) {
            built.image = traced.frame.radiance;
        } else {
            built = reconstruct_timed(cell, traced.frame, reconstruct_s);
        }
        const Comparison comparison = compare(built.image, reference);
        const std::string folder = "cells/" + cell.name;
        const Stopwatch write_watch;
        save_image(built.image, directory_.file_in(folder, "image.exr"));
        const double write_s = write_watch.seconds();
        save_image(built.image, directory_.file_in(folder, "image.png"));
        save_image(difference(built.image, reference), directory_.file_in(folder, "error.exr"));
        row["metrics"] = comparison_json(comparison);
        row["time_s"] = {{"scene", s.scene_s},
                         {"trace", s.trace_s},
                         {"reconstruct", reconstruct_s},
                         {"write", write_s},
                         {"total", s.scene_s + s.trace_s + reconstruct_s + write_s}};
        row["counts"] = {{"samples", s.samples},
                         {"rays", s.rays},
                         {"dropped_samples", s.dropped_samples + built.dropped_samples},
                         {"fallback_pixels", built.fallback_pixels},
                         {"non_finite_pixels", built.non_finite_pixels}};
        const bool finite = comparison.non_finite.count == 0 && built.non_finite_pixels == 0;
        row["status"] = finite ? "ok" : "failed";
        if (!finite) row["reason"] = "non-finite pixels";
    }

    void write_results() const {
        std::vector<nlohmann::json> ordered;
        for (const Cell& cell : cells_) {
            const auto row = rows_.find(cell.name);
            if (row != rows_.end()) ordered.push_back(row->second);
        }
        directory_.write_results(ordered);
    }

    void write_run() {
        char date[32];
        const std::time_t now = std::time(nullptr);
        std::strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", std::gmtime(&now));
        run_["finished_utc"] = date;
        run_["command"] = "vecino run " + matrix_.file;
        run_["cells"] = cells_.size();
        directory_.write_run(run_);
    }

    const Matrix& matrix_;
    RunDirectory directory_;
    std::vector<Cell> cells_;
    std::map<std::string, Scene> scenes_;
    std::map<std::string, std::string> scene_hashes_;
    std::map<std::string, nlohmann::json> old_rows_;
    std::map<std::string, nlohmann::json> rows_;
    ReferenceStore references_{directory_};
    std::map<std::string, double> rates_;
    std::vector<PlannedCell> plan_;
    nlohmann::json run_;
    std::string build_;
    std::size_t done_cells_ = 0;
    ProgressBar* bar_ = nullptr;
    double total_samples_ = 0;
    double done_samples_ = 0;
};

}  // namespace

RunSummary run_matrix(const Matrix& matrix, const std::string& directory,
                      const RunOptions& options) {
    return Runner(matrix, RunDirectory::create(directory), options).run();
}

RunEstimate estimate_run(const Matrix& matrix, const std::string& directory,
                         const RunOptions& options) {
    return Runner(matrix, RunDirectory::peek(directory), options).estimate();
}

}  // namespace vecino
