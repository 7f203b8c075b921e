// SPDX-License-Identifier: Apache-2.0
//
// A method's numeric parameters, each at about half and at one and a half times what it is: a
// method whose error hangs on them needs tuning by hand, scene by scene.
#pragma once

#include <string>
#include <vector>

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
/// so: an angle of 0. Windows are odd, so that the values are the nearest that there are; a minimal
/// cosine is taken as the angle that it allows, in degrees.
std::vector<Perturbation> perturbations(const Cell& cell);

}  // namespace vecino
