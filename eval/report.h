// SPDX-License-Identifier: Apache-2.0
//
// From a run directory to one HTML file that opens from disk: the results table, speed against
// accuracy, images and error maps. Error maps of all cells share one range, and are written beside
// the cells' images.
#pragma once

#include <string>

#include "eval/report_data.h"

namespace vecino {

/// Writes the verdicts and the report; returns the report's path (output, or DIR/report.html when
/// that is empty). A name that ends in .md gets Markdown tables alone; any other one the page, and
/// the error maps of all cells are written too. Throws Error(file).
std::string write_report(const ReportData& data, const std::string& output = "");

/// Writes one picture to a .png or .bmp file: a mosaic figure of the run's matrix, or, for an empty
/// id, the chart of time against accuracy. Throws Error(usage), Error(file).
void write_report_picture(const ReportData& data, const std::string& output,
                          const std::string& figure);

}  // namespace vecino
