// SPDX-License-Identifier: Apache-2.0
//
// From a run directory to one HTML file that opens from disk: the results table, speed against
// accuracy, images and error maps. Error maps of all cells share one range, and are written beside
// the cells' images.
#pragma once

#include <string>

namespace vecino {

/// Writes the error maps of all cells and the report; returns the report's path (output, or
/// DIR/report.html when that is empty). Throws Error(file) for a directory without results.
std::string write_report(const std::string& directory, const std::string& output = "");

}  // namespace vecino
