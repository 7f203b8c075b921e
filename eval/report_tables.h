// SPDX-License-Identifier: Apache-2.0
//
// A run's groups (cells that differ in their seed alone) as tables for other programs: what each
// holds is summary_json(), means with the bounds of their 95 % confidence intervals, and the least
// and the largest time over seeds.
#pragma once

#include <string>

#include "eval/report_data.h"

namespace vecino {

/// A line per group.
std::string summary_csv(const ReportData& data);

/// An object per group and line, with the names of its cells.
std::string summary_jsonl(const ReportData& data);

/// A table per scene for \input in a LaTeX document that uses the packages booktabs and, for a
/// table that is longer than a page, longtable. The best value of a column is bold.
std::string summary_latex(const ReportData& data);

/// Text as LaTeX sets it, whatever characters it holds.
std::string latex_text(const std::string& text);

}  // namespace vecino
