// SPDX-License-Identifier: Apache-2.0
//
// A method's numeric parameters, each at about half and at one and a half times what it is: a
// method whose error hangs on them needs tuning by hand, scene by scene.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/option_row.h"
#include "eval/matrix.h"

namespace vecino {

/// A cell with one parameter changed.
struct PerturbedCell {
    double value = 0;  ///< of the parameter, on a scale on which it can be multiplied; above 0
    Cell cell;         ///< of the same name and frame
};

struct Perturbation {
    std::string parameter;    ///< name of its option
    PerturbedCell low, high;  ///< of different values
};

/// Of every numeric parameter that the cell's method reads, but for those that cannot be changed
/// so: an angle of 0. Whole numbers change by 1 at least, windows by 2; a minimal cosine is taken
/// as the angle that it allows, in degrees; at the end of its range a parameter stays where it is.
std::vector<Perturbation> perturbations(const Cell& cell);

/// Multiplies an option that is a number above 0; returns what it is then. None for others. Where
/// the product is not allowed, the option stays as it is.
template <class Parameters>
std::optional<double> scale_option(const OptionRow<Parameters>& row, Parameters& parameters,
                                   double factor) {
    const nlohmann::json now = row.get(parameters);
    if (!now.is_number() || !(now.get<double>() > 0)) return std::nullopt;
    const auto value = now.get<double>();
    nlohmann::json next = value * factor;
    if (now.is_number_integer()) {
        const double step = factor < 1 ? -1 : 1;
        next = std::llround(factor < 1 ? std::min(value * factor, value + step)
                                       : std::max(value * factor, value + step));
    }
    try {
        Parameters changed = parameters;
        row.set(changed, JsonValue(next, std::string(row.name)));
        parameters = changed;
    } catch (const Error&) {  // beyond the option's range
    }
    return row.get(parameters).template get<double>();
}

}  // namespace vecino
