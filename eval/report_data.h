// SPDX-License-Identifier: Apache-2.0
//
// What a report tells, read from a run directory and put in order; no HTML here.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "eval/convergence.h"
#include "eval/failure_results.h"
#include "eval/reproduction.h"
#include "eval/summary.h"

namespace vecino {

/// How a method is marked, in charts and beside its name: shape and colour both differ.
struct MethodStyle {
    std::string method;
    std::string_view shape;  ///< a symbol of report.html
    int colour = 0;          ///< a colour of report.css; 0 is that of path tracing
};

/// What the matrix reproduces, and how far it does.
struct ReportReproduction {
    Reproduction specification;
    ReproductionResult result;
};

struct ReportData {
    std::string directory;                   ///< as it was given
    nlohmann::json run;                      ///< run.json; an empty object if it is not there yet
    std::vector<nlohmann::json> rows;        ///< the last one of each cell, in the file's order
    std::map<std::string, std::size_t> row;  ///< index into rows, by cell
    std::vector<GroupSummary> groups;
    std::optional<ReportReproduction> reproduction;  ///< none: the matrix claims nothing
    std::vector<ConvergenceCurve> convergence;       ///< of path tracing; may be empty
    Failures failures;                               ///< without cases if the matrix names none
    std::vector<std::string> scenes;                 ///< in the order of the groups
    std::vector<MethodStyle> methods;  ///< path tracing first, then schemes, then others
    std::vector<std::string> varying;  ///< parameters that tell groups apart
    int time_decimals = 3;             ///< so that the least time has three digits
    int relmse_decimals = 4;
    std::map<std::string, int> metric_decimals;  ///< of the metrics that some group has

    [[nodiscard]] const nlohmann::json& row_of(const std::string& cell) const {
        return rows[row.at(cell)];
    }
    [[nodiscard]] const MethodStyle& style_of(const std::string& method) const;
};

/// Throws Error(file) for a directory without results, or with rows that lack something.
ReportData read_report_data(const std::string& directory);

/// Writes the verdicts into the run directory, if there are any.
void write_reproduction(const ReportData& data);
void write_failures(const ReportData& data);

/// Indices of the reproduction's variants that a group belongs to, whatever its spp.
std::vector<std::size_t> variants_of(const ReportData& data, const GroupSummary& group);

/// The index of a group in data.groups.
std::size_t index_of(const ReportData& data, const GroupSummary& group);

/// "7", "512 × 512", "gaussian"; "–" where there is no such parameter.
std::string parameter_text(const nlohmann::json& params, const std::string& name);

/// What tells a group from others of its method: "reduction 2, window 7".
std::string parameters_text(const ReportData& data, const GroupSummary& group);

/// How the reference of a row was made: "spp 4096, light_sampling nee, ...".
std::string reference_text(const nlohmann::json& row);

/// The group's name without its scene.
std::string short_name(const GroupSummary& group);

/// Whether a metric in dB has no value because every image equals its reference.
bool is_identical(const ReportData& data, const GroupSummary& group, const std::string& metric);

}  // namespace vecino
