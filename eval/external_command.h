// SPDX-License-Identifier: Apache-2.0
//
// Running programs that make images.
#pragma once

#include <string>
#include <vector>

namespace vecino {

struct ExternalCommand {
    std::vector<std::string> arguments;  ///< the program first; no shell reads them
    std::string folder;                  ///< that it runs in; empty: this one
    std::string log;                     ///< file for all that it prints
};

/// Waits for its end and returns the wall-clock seconds. Throws Error(file) if it cannot be started
/// or does not exit with 0, Error(interrupted) if the user interrupted it.
double run_command(const ExternalCommand& command);

}  // namespace vecino
