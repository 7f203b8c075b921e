// SPDX-License-Identifier: Apache-2.0
//
// From a run directory to one HTML file that opens from disk: the results table, speed against
// accuracy, images and error maps. Error maps of all cells share one range, and are written beside
// the cells' images.
#pragma once

#include <string>

#include "eval/report_data.h"

namespace vecino {

/// Writes the error maps of all cells, the verdicts and the report; returns the report's path
/// (output, or DIR/report.html when that is empty). Throws Error(file).
std::string write_report(const ReportData& data, const std::string& output = "");

}  // namespace vecino
