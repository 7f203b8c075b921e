// SPDX-License-Identifier: Apache-2.0
//
// What `vecino report` writes for other programs: tables, .vti files, a Cinema database, mosaics.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/error.h"

namespace vecino {

/// As given on the command line.
struct ReportExports {
    bool vti = false;
    bool mosaic = false;
    std::string only = {};
    std::vector<std::string> crops = {}, metrics = {};
};

/// After the option --figure was added, which --mosaic excludes.
void add_export_options(CLI::App& report, ReportExports& exports);

/// Writes what the options and the extension of the output (.csv, .jsonl, .tex, .cdb) ask for. None
/// where they ask for none of these: the report itself is wanted. Throws Error(usage) for options
/// that do not go together.
std::optional<ExitCode> run_exports(const std::string& directory, const std::string& output,
                                    const ReportExports& exports);

}  // namespace vecino
