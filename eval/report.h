// SPDX-License-Identifier: Apache-2.0
//
// From a run directory to one HTML file that opens from disk: the results table, speed against
// accuracy, images and error maps. Error maps of all cells share one range, and are written beside
// the cells' images.
#pragma once

#include <string>

#include "eval/report_data.h"
#include "eval/report_planes.h"

namespace vecino {

/// Writes the verdicts and the report; returns the report's path (output, or DIR/report.html when
/// that is empty). A name that ends in .md gets Markdown tables alone; any other one the page, and
/// the error maps of all cells are written too, and the float values of what it shows: into the
/// page, if they are to be embedded, else as scripts in DIR/planes. Throws Error(file), and
/// Error(usage) where more is to be embedded than a browser opens.
std::string write_report(const ReportData& data, const std::string& output = "",
                         std::optional<PlanePrecision> embedded = std::nullopt);

/// Writes one picture to a .png or .bmp file: a mosaic figure of the run's matrix, or, for an empty
/// id, the chart of time against accuracy. Throws Error(usage), Error(file).
void write_report_picture(const ReportData& data, const std::string& output,
                          const std::string& figure);

}  // namespace vecino
