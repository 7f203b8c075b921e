// SPDX-License-Identifier: Apache-2.0
#include "eval/gate_run.h"

#include <algorithm>
#include <map>
#include <set>

#include "core/error.h"
#include "core/files.h"
#include "eval/budget.h"
#include "eval/failure_results.h"
#include "eval/frame_jobs.h"
#include "eval/matrix.h"
#include "eval/run_directory.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

Json without(Json object, std::initializer_list<const char*> keys) {
    for (const char* key : keys) object.erase(key);
    return object;
}

/// The place of a scene file says nothing about it, and a measured budget is measured anew by each
/// run directory.
Json comparable(const Json& params) {
    Json json = without(params, {"scene"});
    if (json.value("budget", "") == budget_name(Budget::equal_time)) json.erase("spp");
    return json;
}

Json question_of(const Json& row) {
    Json question = without(row.value("params", Json::object()), {"seed", "scene"});
    question["scene_hash"] = row.value("scene_hash", Json());
    if (const std::string hash = row.value("reference_hash", ""); !hash.empty())
        question["reference_hash"] = hash;
    // Size, depth and the rest are those of the cell.
    question["reference"] = without(row.value("reference", Json::object()),
                                    {"scene", "size", "max_depth", "reduction", "first_hit"});
    return question;
}

std::size_t non_finite_values(const Json& row) {
    const auto count = [&](const char* part, const char* key) -> std::size_t {
        const Json value = row.value(part, Json::object()).value(key, Json());
        const Json number = value.is_object() ? value.value("count", Json()) : value;
        return number.is_number_unsigned() ? number.get<std::size_t>() : 0;
    };
    const bool is_injected = row.value("params", Json::object()).contains("inject");
    return std::max(count("metrics", "non_finite"),
                    is_injected ? 0 : count("counts", "non_finite_pixels"));
}

class Reader {
  public:
    explicit Reader(const std::string& directory) {
        const RunDirectory run_directory = RunDirectory::open(directory);
        rows_ = run_directory.rows();
        const std::string file = run_directory.file("run.json");
        const Json run = parse_json_file(file);
        const JsonValue json(run, file);
        matrix_ = matrix_of(json.at("config").raw(), file);
        result_.directory = directory;
        result_.matrix = matrix_.name;
        result_.versions = json.at("versions").raw();
        result_.classes = read_gate_classes(JsonValue(matrix_.document, file));
        for (const Json& name : run.value("stale", Json::array()))
            if (name.is_string()) stale_.insert(name.get<std::string>());
        find_changed_scenes();
    }

    GateRun read() {
        for (const Cell& cell : expand(matrix_)) add(cell);
        return std::move(result_);
    }

  private:
    void find_changed_scenes() {
        std::map<std::string, std::set<Json>> hashes;
        for (const auto& [name, row] : rows_)
            hashes[row.value("scene", "")].insert(row.value("scene_hash", Json()));
        for (const auto& [scene, states] : hashes)
            if (states.size() > 1) changed_scenes_.insert(scene);
    }

    /// Why a row does not answer what the run last asked for; empty if it does.
    std::string staleness(const Cell& cell, const Json& row) const {
        const Json reference = reference_json(matrix_, cell);
        if (comparable(row.value("params", Json::object())) != comparable(cell.parameters_json()))
            return "other parameters";
        if (without(row.value("reference", Json::object()), {"scene"}) !=
            without(reference, {"scene"}))
            return "another reference";
        if (row.value("build", Json()) != result_.versions.value("build", Json()))
            return "another build than the run's last";
        if (stale_.contains(cell.name))
            return "made by another build or packet width, or from other files than there are now";
        if (changed_scenes_.contains(row.value("scene", "")))
            return "the scene file changed between its cells";
        return "";
    }

    std::optional<CellFault> fault_of(const Cell& cell) const {
        const auto found = rows_.find(cell.name);
        if (found == rows_.end()) return CellFault{cell.name, CellFaultKind::missing, "no result"};
        const Json& row = found->second;
        if (const std::size_t count = non_finite_values(row); count > 0) {
            return CellFault{cell.name, CellFaultKind::non_finite,
                             std::to_string(count) + " values are not finite"};
        }
        if (is_expected_refusal(row, matrix_.failures)) return staleness_of(cell, row);
        if (row.value("status", "") != "ok" || !row.value("metrics", Json()).is_object())
            return CellFault{cell.name, CellFaultKind::failed, row.value("reason", "no metrics")};
        return staleness_of(cell, row);
    }

    std::optional<CellFault> staleness_of(const Cell& cell, const Json& row) const {
        const std::string stale = staleness(cell, row);
        if (stale.empty()) return std::nullopt;
        return CellFault{cell.name, CellFaultKind::stale, stale};
    }

    void add(const Cell& cell) {
        const auto [entry, is_new] = index_.try_emplace(cell.group, result_.groups.size());
        if (is_new) {
            result_.groups.push_back({});
            result_.groups.back().name = cell.group;
            result_.groups.back().params = cell.parameters_json();
        }
        RunGroup& group = result_.groups[entry->second];
        if (auto fault = fault_of(cell)) {
            group.faults.push_back(std::move(*fault));
            return;
        }
        const Json& row = rows_.at(cell.name);
        if (is_expected_refusal(row, matrix_.failures)) return group.refused.push_back(row);
        if (group.rows.empty()) group.question = question_of(row);
        group.rows.push_back(row);
    }

    std::map<std::string, Json> rows_;
    Matrix matrix_;
    GateRun result_;
    std::set<std::string> stale_;  ///< cells, by the run itself
    std::set<std::string> changed_scenes_;
    std::map<std::string, std::size_t> index_;
};

}  // namespace

std::optional<std::vector<double>> RunGroup::errors(const GateMetric& metric) const {
    std::vector<double> errors;
    for (const Json& row : rows) {
        const auto error = error_in(metric, row["metrics"]);
        if (!error) return std::nullopt;
        errors.push_back(*error);
    }
    if (errors.empty()) return std::nullopt;
    return errors;
}

std::vector<double> RunGroup::times_s() const {
    std::vector<double> times;
    for (const Json& row : rows) {
        const Json time = row.value("time_s", Json::object()).value("total", Json());
        if (time.is_number() && time.get<double>() > 0) times.push_back(time.get<double>());
    }
    return times;
}

std::string RunGroup::host() const {
    if (rows.empty()) return "";
    const Json threads = rows.front().value("threads", Json(1));
    return rows.front().value("host", "unknown CPU") + ", threads: " + threads.dump();
}

const RunGroup* GateRun::find(const std::string& group) const {
    const auto found = std::ranges::find(groups, group, &RunGroup::name);
    return found == groups.end() ? nullptr : &*found;
}

GateRun read_gate_run(const std::string& directory) {
    return Reader(directory).read();
}

bool same_question(const Json& a, const Json& b) {
    return comparable(a) == comparable(b);
}

}  // namespace vecino
