// SPDX-License-Identifier: Apache-2.0
//
// A run as gates see it: every cell that its matrix asks for, by group, with what is wrong with it.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/gate_classes.h"
#include "eval/gate_metrics.h"

namespace vecino {

enum class CellFaultKind {
    missing,     ///< no row
    failed,      ///< tried, with a reason
    non_finite,  ///< a pixel is NaN or infinite
    stale,       ///< of another build, another scene file or other parameters than the run's last
};

struct CellFault {
    std::string cell;
    CellFaultKind kind = CellFaultKind::missing;
    std::string reason;
};

/// Cells that differ in their seed alone.
struct RunGroup {
    std::string name;
    nlohmann::json params;             ///< of the first cell, for selections
    nlohmann::json question;           ///< what must be the same for two results to be comparable
    std::vector<nlohmann::json> rows;  ///< of its sound cells
    std::vector<nlohmann::json> refused;  ///< of cells that their method refuses, as expected
    std::vector<CellFault> faults;

    /// Nothing to hold against a baseline: it is expected that no cell can be made.
    [[nodiscard]] bool is_refused() const { return rows.empty() && faults.empty(); }
    /// By seed. None unless every row has the metric: leaving one out would flatter the rest.
    [[nodiscard]] std::optional<std::vector<double>> errors(const GateMetric& metric) const;
    [[nodiscard]] std::vector<double> times_s() const;  ///< total, by seed
    [[nodiscard]] std::string host() const;             ///< "CPU, threads: 2"
};

struct GateRun {
    std::string directory;
    std::string matrix;       ///< its name
    nlohmann::json versions;  ///< of run.json
    std::vector<GateClass> classes;
    std::vector<RunGroup> groups;  ///< in the order of the matrix

    [[nodiscard]] const RunGroup* find(const std::string& group) const;
};

/// Throws Error(file) for a directory without results.jsonl or run.json, Error(usage) if the matrix
/// that run.json keeps is none.
GateRun read_gate_run(const std::string& directory);

/// Whether two questions are one, but for what a measured budget gave.
bool same_question(const nlohmann::json& a, const nlohmann::json& b);

}  // namespace vecino
