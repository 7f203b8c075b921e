// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>

#include "core/files.h"
#include "eval/accept.h"
#include "eval/commands.h"

namespace vecino {
namespace {

struct AcceptArguments {
    std::string directory;
    std::string baseline;
    std::string only;
    bool yes = false;
};

/// Set by every CI service; "false" and nothing are not.
bool runs_under_ci() {
    const char* const ci = std::getenv("CI");
    return ci != nullptr && *ci != '\0' && std::string_view(ci) != "false";
}

/// A baseline that nobody looked at gates nothing.
bool may_write(const AcceptArguments& arguments, bool overwrites) {
    if (arguments.yes) return true;
    if (runs_under_ci())
        throw Error(ExitCode::usage,
                    "command line: found no --yes, allowed: with it; under CI (the environment "
                    "variable CI is set) nobody looks at what is accepted");
    if (!overwrites) return true;
    if (::isatty(STDIN_FILENO) == 0)
        throw Error(ExitCode::usage,
                    "command line: found no --yes, allowed: with it, or on a terminal, which is "
                    "asked; " +
                        arguments.baseline + " would be overwritten");
    std::fprintf(stderr, "overwrite %s? [y/N] ", arguments.baseline.c_str());
    std::string answer;
    std::getline(std::cin, answer);
    return answer == "y" || answer == "Y" || answer == "yes";
}

void require_no_faults(const AcceptPlan& plan, const std::string& directory) {
    if (plan.faults.empty()) return;
    for (const CellFault& fault : plan.faults)
        std::fprintf(stderr, "not acceptable: %s: %s\n", fault.cell.c_str(),
                     one_line(fault.reason).c_str());
    throw Error(ExitCode::quality, directory + ": found " + std::to_string(plan.faults.size()) +
                                       " cells that are missing, failed or stale, allowed: none");
}

ExitCode run_accept(const AcceptArguments& arguments) {
    const GateRun run = read_gate_run(arguments.directory);
    std::optional<Baseline> old;
    if (std::filesystem::exists(arguments.baseline)) old = read_baseline(arguments.baseline);
    const AcceptPlan plan = plan_accept(run, old, arguments.only);
    require_no_faults(plan, arguments.directory);
    std::printf("%s", plan.table.c_str());
    if (old && plan.changed == 0) {
        std::printf("nothing changed: %s stays as it is\n", arguments.baseline.c_str());
        return ExitCode::ok;
    }
    std::printf(
        "%zu of %zu groups changed (~ other numbers, ! worse than the old baseline allows, "
        "+ new, - gone)\n",
        plan.changed, plan.baseline.groups.size());
    std::fflush(stdout);
    if (!may_write(arguments, old.has_value())) {
        std::fprintf(stderr, "not accepted: %s stays as it is\n", arguments.baseline.c_str());
        return ExitCode::skipped;
    }
    write_baseline(arguments.baseline, plan.baseline);
    std::printf("baseline: %s\n", arguments.baseline.c_str());
    return ExitCode::ok;
}

}  // namespace

void add_accept_command(CLI::App& app, Action& chosen) {
    auto arguments = std::make_shared<AcceptArguments>();
    CLI::App* const command =
        app.add_subcommand("accept", "take the numbers of a run as a baseline, without a new run");
    command->add_option("DIR", arguments->directory, "run directory")
        ->required()
        ->check(not_empty());
    command->add_option("--baseline", arguments->baseline, "JSON file to make or to change")
        ->required()
        ->check(not_empty());
    command->add_option("--only", arguments->only,
                        "accept only groups whose name matches this regular expression");
    command->add_flag("--yes", arguments->yes,
                      "do not ask; needed under CI and without a terminal");
    command->footer(
        "Exit codes: 0 accepted, or nothing changed; 2 cells are missing, failed or stale; 64 "
        "needs --yes; 125 answered with no.");
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_accept(*arguments); }; });
}

}  // namespace vecino
