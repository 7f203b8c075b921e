// SPDX-License-Identifier: Apache-2.0
#include "eval/run_matrix.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/files.h"
#include "core/timing.h"
#include "eval/cell_result.h"
#include "eval/cell_sources.h"
#include "eval/commands.h"
#include "eval/equal_time.h"
#include "eval/failure_results.h"
#include "eval/frame_jobs.h"
#include "eval/progress.h"
#include "eval/reference_error.h"
#include "eval/reference_store.h"
#include "eval/run_directory.h"
#include "eval/spent.h"

namespace vecino {
namespace {

std::string frame_key(const std::string& scene, const RenderSettings& settings) {
    return frame_json(scene, settings).dump();
}

double traced_samples(const RenderSettings& settings) {
    return FrameJob{{}, settings}.samples();
}

class Runner {
  public:
    Runner(const Matrix& matrix, RunDirectory directory, const RunOptions& options)
        : matrix_(matrix), directory_(std::move(directory)), cells_(expand(matrix)) {
        const nlohmann::json versions = version_json();
        build_ = versions["build"].get<std::string>();
        simd_width_ = options.simd_width > 0 ? options.simd_width : simd_widths().front();
        run_ = {{"name", matrix.name}, {"config", matrix.document}, {"versions", versions}};
        run_["versions"]["simd_width"] = simd_width_;
        before_ = spent_before(directory_, matrix.name);
        for (Cell& cell : cells_) {
            load_scene_of(cell);
            cell.settings.simd_width = simd_width_;
            if (cell.budget != Budget::equal_time) continue;
            if (const auto spp = equal_time_.spp(cell)) cell.settings.spp = *spp;
        }
        old_rows_ = directory_.rows();
        plan_ = plan_run(cells_, options, [this](const Cell& cell) { return state_of(cell); });
    }

    RunSummary run() {
        RunSummary summary;
        keep_old_rows(summary);
        write_run();
        measure_equal_times();
        const std::vector<FrameJob> jobs = frame_jobs(plan_);
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
        const std::vector<FrameJob> jobs = frame_jobs(plan_);
        for (const FrameJob& job : jobs) {
            for (const Cell* cell : job.cells) result.cells.push_back(cell->name);
        }
        result.samples = planned_samples(jobs);
        for (const auto& [scene, settings] : renders_of(jobs, matrix_))
            result.time_s += traced_samples(settings) / rate(scene, settings);
        return result;
    }

  private:
    void load_scene_of(const Cell& cell) {
        if (traces_scene(matrix_, cell)) {
            if (scenes_.contains(cell.scene)) return;
            const auto scene = scenes_.emplace(cell.scene, load_scene(cell.scene)).first;
            scene_hashes_[cell.scene] = scene_hash(cell.scene, scene->second);
        } else if (cell.image->reads("scene_file")) {
            scene_hashes_.try_emplace(cell.scene, text_hash(read_file(cell.scene)));
        } else {
            scene_hashes_.try_emplace(cell.scene);  // a name alone
        }
    }

    CellState state_of(const Cell& cell) const {
        const auto old = old_rows_.find(cell.name);
        if (old == old_rows_.end()) return CellState::missing;
        const nlohmann::json& row = old->second;
        const bool same_question =
            row.value("params", nlohmann::json()) == cell.parameters_json() &&
            row.value("reference", nlohmann::json()) == reference_json(matrix_, cell);
        if (!same_question) return CellState::missing;
        const bool same_program = is_of_this_program(row, cell);
        if (row.value("status", nlohmann::json()) != "ok")
            return same_program ? CellState::failed : CellState::failed_before;
        if (!std::filesystem::exists(directory_.file("cells/" + cell.name + "/image.exr")))
            return CellState::missing;
        for (const std::string& metric : matrix_.metrics)
            if (!row["metrics"].contains(metric)) return CellState::missing;
        if (matrix_.stability && !holds_stability(row, cell, *matrix_.stability))
            return CellState::missing;
        return same_program ? CellState::finished : CellState::stale;
    }

    /// And of the files that there are now.
    bool is_of_this_program(const nlohmann::json& row, const Cell& cell) const {
        return row.value("build", nlohmann::json()) == build_ &&
               row.value("simd_width", nlohmann::json()) == simd_width_ &&
               row.value("scene_hash", nlohmann::json()) == scene_hashes_.at(cell.scene) &&
               row.value("image_hash", "") == image_hash(matrix_, cell) &&
               row.value("reference_hash", "") == reference_hash(matrix_, cell);
    }

    // A row stays until a new one takes its place: an interruption loses nothing.
    void keep_old_rows(RunSummary& summary) {
        run_["stale"] = nlohmann::json::array();  // which a gate must not take for results of now
        for (const PlannedCell& planned : plan_) {
            if (planned.state == CellState::missing) continue;
            rows_[planned.cell->name] = old_rows_.at(planned.cell->name);
            if (planned.run) continue;
            ++summary.kept;
            if (planned.state == CellState::finished || planned.state == CellState::failed)
                continue;
            ++summary.stale;
            run_["stale"].push_back(planned.cell->name);
        }
    }

    // Before the first frame: all seeds of a group get the same, those that are kept too.
    void measure_equal_times() {
        std::set<std::string> with_kept;
        for (const PlannedCell& planned : plan_) {
            if (!planned.run && planned.state != CellState::missing)
                with_kept.insert(planned.cell->group);
        }
        for (const PlannedCell& planned : plan_) {
            const Cell& cell = *planned.cell;
            if (!planned.run || cell.budget != Budget::equal_time) continue;
            const std::string state = build_ + " " + scene_hashes_.at(cell.scene);
            const auto known = with_kept.contains(cell.group) ? equal_time_.spp(cell)
                                                              : equal_time_.spp(cell, state);
            if (known) continue;
            const auto like = equal_time_.spp_like(cell, state);
            equal_time_.put(cell, state,
                            like ? *like : measure_equal_time_spp(scenes_.at(cell.scene), cell));
        }
        for (Cell& cell : cells_) {
            if (cell.budget != Budget::equal_time) continue;
            if (const auto spp = equal_time_.spp(cell)) cell.settings.spp = *spp;
        }
    }

    void count(RunSummary& summary) const {
        summary.cells = cells_.size();
        summary.done = done_cells_;
        summary.missing = cells_.size() - rows_.size();
        for (const auto& [name, row] : rows_) {
            if (row["status"] == "ok") continue;
            ++(is_expected_refusal(row, matrix_.failures) ? summary.refused : summary.failed);
        }
    }

    /// Samples per second, from a short render of the same kind.
    double rate(const std::string& scene, RenderSettings settings) {
        settings.size = {64, 64};
        settings.reduction = 1;
        settings.spp = 64;
        settings.camera_shift = {};
        const std::string key = frame_key(scene, settings);
        const auto known = rates_.find(key);
        if (known != rates_.end()) return known->second;
        const RenderStatistics s = render(scenes_.at(scene), settings).statistics;
        const double measured = static_cast<double>(s.samples) / std::max(s.trace_s, 1e-6);
        return rates_.emplace(key, measured).first->second;
    }

    double planned_samples(const std::vector<FrameJob>& jobs) const {
        double total = 0;
        for (const PlannedRender& each : renders_of(jobs, matrix_))
            total += traced_samples(each.settings);
        return total;
    }

    /// Of a render that counts as path tracing with such settings does.
    template <class Trace>
    auto with_progress(const std::string& label, const RenderSettings& settings,
                       const Trace& trace) {
        bar_->label(matrix_.name + ": " + label);
        const double samples = traced_samples(settings);
        auto result = trace([&](double done) {
            return bar_->update((done_samples_ + done * samples) / total_samples_);
        });
        done_samples_ += samples;
        return result;
    }

    const StoredReference& reference_of(const Cell& cell) {
        if (matrix_.reference_source != nullptr) return reference_from_file(cell);
        RenderSettings settings = reference_settings(matrix_, cell);
        const std::string key = frame_key(cell.scene, settings) + scene_hashes_.at(cell.scene) +
                                build_ + " " + std::to_string(simd_width_);
        return references_.get(key, stem(cell.scene), [&] {
            settings.planes = reference_planes();
            settings.simd_width = simd_width_;
            return reference_halves(settings, [&](const RenderSettings& half) {
                return with_progress(stem(cell.scene) + " reference", half,
                                     [&](const Progress& progress) {
                                         return render(scenes_.at(cell.scene), half, progress);
                                     })
                    .frame;
            });
        });
    }

    const StoredReference& reference_from_file(const Cell& cell) {
        const std::string path = reference_path(matrix_, cell);
        const std::string key = reference_json(matrix_, cell).dump() + text_hash(read_file(path));
        return references_.get(key, stem(cell.scene), [&] {
            return ReferenceHalves{
                load_sourced_image(*matrix_.reference_source, path).frame, {}, {}, {}, 0};
        });
    }

    MethodRender render_view(const Cell& view, const std::string& label) {
        return with_progress(label, view.settings, [&](const Progress& progress) {
            return render_frame(view, scenes_.at(view.scene), progress);
        });
    }

    MethodRender trace(const FrameJob& job) {
        const Cell view = views_of(job, matrix_).front();
        std::vector<double> scene_s, trace_s, reconstruct_s;
        MethodRender result;
        for (int i = 0; i < matrix_.repeat; ++i) {
            result =
                i == 0 ? render_view(view, view.name) : render_frame(view, scenes_.at(view.scene));
            const RenderStatistics& s = result.render.statistics;
            scene_s.push_back(s.scene_s);
            trace_s.push_back(s.trace_s);
            reconstruct_s.push_back(result.reconstruct_s);
            if (s.trace_s + result.reconstruct_s > kRepeatBelow_s) break;
        }
        result.render.statistics.scene_s = median(scene_s);
        result.render.statistics.trace_s = median(trace_s);
        result.reconstruct_s = median(reconstruct_s);
        return result;
    }

    std::vector<ShiftedView> shifted_views(const FrameJob& job) {
        std::vector<ShiftedView> shifted;
        const std::vector<Cell> views = views_of(job, matrix_);
        for (std::size_t i = 1; i < views.size(); ++i) {
            const Image& reference = reference_of(views[i]).image;
            MethodRender moved = render_view(views[i], views[i].name + ", camera moved");
            shifted.push_back(
                {matrix_.stability->shifts[i - 1], std::move(moved.render.frame), &reference});
        }
        return shifted;
    }

    void run_job(const FrameJob& job) {
        if (interrupted()) throw Error(ExitCode::interrupted, "interrupted");
        static const StoredReference none;
        CellInput input{&matrix_, nullptr, &none};
        MethodRender traced;
        std::optional<GuideStore> guides;
        std::vector<ShiftedView> shifted;
        try {
            input.reference = &reference_of(*job.cells.front());
            if (job.traces) {
                traced = trace(job);
                input.traced = &traced;
                input.scene = &scenes_.at(job.cells.front()->scene);
                input.guides = &guides.emplace(*input.scene, job.settings, matrix_.repeat);
            }
            shifted = shifted_views(job);
        } catch (const Error& error) {
            if (!is_of_cell(error)) throw;
            return fail_job(job, *input.reference, error);
        }
        input.shifted = shifted;
        for (const Cell* cell : job.cells)
            add_row(*cell, *input.reference, cell_result(*cell, input, directory_));
    }

    /// Its cells alone: a reference that is gone or broken, or a method that refuses its settings.
    void fail_job(const FrameJob& job, const StoredReference& reference, const Error& error) {
        const bool has_reference = !reference.file.empty();
        for (const Cell* cell : job.cells)
            add_row(*cell, reference,
                    has_reference ? error_result(*cell, error) : failed_result(error.what()));
    }

    void add_row(const Cell& cell, const StoredReference& reference, const nlohmann::json& result) {
        nlohmann::json row{{"cell", cell.name},
                           {"group", cell.group},
                           {"against", cell.against},
                           {"scene", stem(cell.scene)},
                           {"method", cell.method()},
                           {"seed", cell.settings.seed},
                           {"params", cell.parameters_json()},
                           {"samples_ratio", cell.samples_ratio()},
                           {"reference", reference_json(matrix_, cell)},
                           {"reference_file", reference.file},
                           {"reference_error", reference.error},
                           {"scene_hash", scene_hashes_.at(cell.scene)},
                           {"image_hash", image_hash(matrix_, cell)},
                           {"reference_hash", reference_hash(matrix_, cell)},
                           {"build", build_},
                           {"simd_width", simd_width_},
                           {"host", run_["versions"]["cpu"]}};
        row.update(result);
        mark_limited(row);
        directory_.append(row);
        rows_[cell.name] = row;
        ++done_cells_;
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
        run_["finished_utc"] = utc_time();
        run_["command"] = "vecino run " + matrix_.file + " -o " + directory_.path();
        run_["cells"] = cells_.size();
        run_["seconds"] = before_.seconds + watch_.seconds();
        run_["samples"] = before_.samples + done_samples_;
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
    EqualTimeBudgets equal_time_{directory_.file("equal_time.json")};
    std::map<std::string, double> rates_;
    std::vector<PlannedCell> plan_;
    nlohmann::json run_;
    std::string build_;
    int simd_width_ = 0;
    Spent before_;
    Stopwatch watch_;
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
