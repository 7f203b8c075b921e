// SPDX-License-Identifier: Apache-2.0
//
// The subcommands of the program. Each adds itself to the parser; when it is the one on the command
// line it stores what to do in chosen, which run_program runs.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

#include "core/error.h"

namespace vecino {

using Action = std::function<ExitCode()>;

/// The whole program, which tests call as main does: returns the exit code.
int run_program(int argc, const char* const* argv);

void add_render_command(CLI::App& app, Action& chosen);
void add_upsample_command(CLI::App& app, Action& chosen);
void add_resize_command(CLI::App& app, Action& chosen);
void add_merge_command(CLI::App& app, Action& chosen);
void add_compare_command(CLI::App& app, Action& chosen);
void add_check_command(CLI::App& app, Action& chosen);
void add_accept_command(CLI::App& app, Action& chosen);
void add_run_command(CLI::App& app, Action& chosen);
void add_report_command(CLI::App& app, Action& chosen);
void add_list_command(CLI::App& app, Action& chosen);
void add_schema_command(CLI::App& app, Action& chosen);
void add_bench_command(CLI::App& app, Action& chosen);

/// The commit that the program was built from: made by commit.cmake; empty where it is unknown.
extern const std::string_view kCommit;

/// What --version prints: this program, its libraries, packet width and threads.
std::string version_text();

/// Libraries, machine and build, for run.json.
nlohmann::json version_json();

/// Now, as "2026-01-31T12:34:56Z".
std::string utc_time();

/// "12.3 dB" or "-" for none.
std::string number_text(double value, int digits);

/// A value that is there: an empty one is a shell variable that was not set.
inline CLI::Validator not_empty() {
    return {[](const std::string& text) { return text.empty() ? "found nothing" : ""; }, ""};
}

/// Adds a flag for a row of an option table; text is what was given on the command line.
template <class Row>
CLI::Option* add_table_option(CLI::App& command, const Row& row, std::string& text) {
    return command
        .add_option(std::string(row.flag), text,
                    std::string(row.summary) + " (" + std::string(row.allowed) + ")")
        ->type_name("")
        ->check(not_empty());
}

}  // namespace vecino
