// SPDX-License-Identifier: Apache-2.0
#include "eval/frame_jobs.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "eval/render_options.h"
#include "eval/stability.h"

namespace vecino {
namespace {

/// Whether a frame of ours is traced for the cell.
bool reads_frame(const Cell& cell) {
    if (cell.kind == CellKind::image) return cell.image->reads_frame();
    return cell.kind != CellKind::blocky_ceiling;
}

/// Ceilings of one reference stand together: it is all that is traced for them. A measured budget
/// shares no frame with another, whatever stands for it until it is measured: estimates count both.
std::string job_key(const Cell& cell) {
    if (cell.kind == CellKind::image || cell.kind == CellKind::method) return cell.name;
    const std::string measured = cell.budget == Budget::equal_time ? " measured" : "";
    if (cell.kind != CellKind::blocky_ceiling)
        return frame_json(cell.scene, cell.settings).dump() + measured;
    nlohmann::json key = cell.parameters_json();
    key.erase("reduction");
    return key.dump();
}

/// Scene by scene, all frames of a seed before those of the next: whatever slows the machine down
/// for a while meets all groups alike, and their times by seed can be compared.
void take_seeds_in_turn(std::vector<FrameJob>& jobs) {
    std::map<std::string, std::size_t> scene_order;
    for (const FrameJob& job : jobs)
        scene_order.try_emplace(job.cells.front()->scene, scene_order.size());
    std::ranges::stable_sort(jobs, {}, [&](const FrameJob& job) {
        return std::pair(scene_order.at(job.cells.front()->scene), job.settings.seed);
    });
}

}  // namespace

double FrameJob::samples() const {
    if (!traces) return 0;
    return static_cast<double>(reduced(settings.size, settings.reduction).area()) * settings.spp;
}

std::vector<FrameJob> frame_jobs(const std::vector<PlannedCell>& plan) {
    std::vector<FrameJob> jobs;
    std::map<std::string, std::size_t> by_key;
    for (const PlannedCell& planned : plan) {
        if (!planned.run) continue;
        const Cell& cell = *planned.cell;
        const auto [entry, is_new] = by_key.try_emplace(job_key(cell), jobs.size());
        if (is_new) {
            jobs.push_back({{}, cell.settings, reads_frame(cell)});
            jobs.back().settings.planes = {};
        }
        FrameJob& job = jobs[entry->second];
        job.settings.planes.add(planes_read_by(cell));
        job.cells.push_back(&cell);
    }
    take_seeds_in_turn(jobs);
    return jobs;
}

std::vector<Cell> views_of(const FrameJob& job, const Matrix& matrix) {
    std::vector<Cell> views{*job.cells.front()};
    views.front().settings = job.settings;
    if (!matrix.stability || !has_stability(views.front())) return views;
    for (const float shift : matrix.stability->shifts) {
        views.push_back(views.front());
        views.back().settings.camera_shift += shift;
    }
    return views;
}

std::vector<PlannedRender> renders_of(const std::vector<FrameJob>& jobs, const Matrix& matrix) {
    std::vector<PlannedRender> renders;
    std::set<std::string> references;
    for (const FrameJob& job : jobs) {
        for (const Cell& view : views_of(job, matrix)) {
            if (job.traces) renders.push_back({view.scene, view.settings});
            if (matrix.reference_source != nullptr) continue;
            const RenderSettings reference = reference_settings(matrix, view);
            if (references.insert(frame_json(view.scene, reference).dump()).second)
                renders.push_back({view.scene, reference});
        }
    }
    return renders;
}

MethodRender render_frame(const Cell& cell, const Scene& scene, const Progress& progress) {
    const Method& method =
        cell.kind == CellKind::method ? *cell.render_method : all_methods().front();
    return render(method, {scene, cell.settings, cell.method_parameters}, progress);
}

Planes planes_read_by(const Cell& cell) {
    Planes planes{Plane::radiance};
    if (cell.kind == CellKind::image) planes.add(cell.image->planes);
    if (cell.scheme == nullptr) return planes;
    planes.add(cell.scheme->needs);
    planes.add(cell.scheme->may_read);
    if (cell.scheme->needs.has(Plane::position)) planes.add(Plane::id);  // tells misses apart
    return planes;
}

nlohmann::json frame_json(const std::string& scene, const RenderSettings& settings) {
    nlohmann::json json{{"scene", scene}};
    for (const RenderOption& row : render_options())
        if (is_told(row, settings)) json[std::string(row.name)] = row.get(settings);
    return json;
}

nlohmann::json reference_json(const Matrix& matrix, const Cell& cell) {
    if (matrix.reference_source != nullptr)
        return {{"scene", cell.scene}, {"source", matrix.reference_source->json}};
    return frame_json(cell.scene, reference_settings(matrix, cell));
}

}  // namespace vecino
