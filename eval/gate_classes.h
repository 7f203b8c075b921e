// SPDX-License-Identifier: Apache-2.0
//
// Classes of cells and what a gate asks of each, from the key "gates" of a matrix:
//   {"class": "path tracing", "where": {"method": "path"},
//    "tolerance_db": {"psnr_float_db": 0.1, "edge.psnr_float_db": 0.3}, "k_sigma": 3,
//    "either_way": false, "time_tolerance_percent": 10}
// A cell is of the first class whose "where" it matches (in the words of a selection); a cell that
// no class names is of the class "default".
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "eval/gate_metrics.h"
#include "eval/selection.h"

namespace vecino {

struct GateClass {
    std::string name;
    Selection where;
    /// How many decibels the error may grow beyond what noise explains, by metric; metrics that do
    /// not stand here are not judged.
    std::vector<std::pair<GateMetric, double>> tolerance_db;
    /// What noise explains: as many standard errors as a normal distribution exceeds as rarely as
    /// it does this many sigma; more where few seeds say how large a standard error is.
    double k_sigma = 3;
    /// Whether an error may not fall either, as of methods that are specified to the letter: better
    /// than they should be is wrong, too.
    bool either_way = false;
    std::optional<double> time_tolerance;  ///< share by which time may grow; none: not gated
};

/// What cells are held to that no class names: the mean, the tail, the worst tile and edges.
GateClass default_gate_class();

/// Of a whole matrix; the default class comes last. Throws Error(usage).
std::vector<GateClass> read_gate_classes(const JsonValue& matrix);

/// The class of a cell with these params. Precondition: the last class matches everything.
const GateClass& class_of(const std::vector<GateClass>& classes, const nlohmann::json& params);

}  // namespace vecino
