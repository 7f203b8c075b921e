// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <filesystem>
#include <memory>

#include "core/files.h"
#include "eval/commands.h"
#include "eval/gate_failures.h"
#include "eval/gate_report.h"
#include "eval/run_directory.h"

namespace vecino {
namespace {

struct CheckArguments {
    std::string directory;
    std::string baseline;
    std::string junit;
    std::string markdown;
    bool json = false;
    bool ctest = false;
};

void write_if_asked(const std::string& path, const std::string& text) {
    if (!path.empty()) write_text_file(path, text);
}

GateResult result_of(const GateRun& run, const CheckArguments& arguments) {
    if (arguments.baseline.empty()) {
        const GateResult result = check_failures(run);
        if (!result.verdicts.empty()) return result;
        throw Error(ExitCode::usage,
                    "command line: found no --baseline, allowed: with it, or a run whose matrix "
                    "has \"failures\", which say what is expected");
    }
    if (!std::filesystem::exists(arguments.baseline)) {
        throw Error(ExitCode::quality,
                    arguments.baseline + ": there is no such baseline: vecino accept " +
                        arguments.directory + " --baseline " + arguments.baseline + " makes it");
    }
    GateResult result = check_run(run, read_baseline(arguments.baseline));
    add_failures(result, run);
    return result;
}

ExitCode run_check(const CheckArguments& arguments) {
    for (const std::string& path : {arguments.junit, arguments.markdown})
        if (!path.empty()) require_writable(path);
    const GateRun run = read_gate_run(arguments.directory);
    const GateResult result = result_of(run, arguments);
    write_if_asked(arguments.junit, gate_junit(result));
    write_if_asked(arguments.markdown, gate_markdown(result));
    const std::string text = arguments.json ? gate_json(result).dump() + "\n" : gate_text(result);
    std::printf("%s", text.c_str());
    if (arguments.ctest) std::printf("%s", gate_ctest(result, run).c_str());
    if (result.passed()) return ExitCode::ok;
    if (!result.has_non_finite() && !arguments.baseline.empty())
        std::fprintf(stderr, "if the change is meant: vecino accept %s --baseline %s\n",
                     arguments.directory.c_str(), arguments.baseline.c_str());
    return result.has_non_finite() ? ExitCode::non_finite : ExitCode::quality;
}

}  // namespace

void add_check_command(CLI::App& app, Action& chosen) {
    auto arguments = std::make_shared<CheckArguments>();
    CLI::App* const command = app.add_subcommand(
        "check",
        "hold a run against a baseline, or failures against what is expected: a gate for CI");
    command->add_option("DIR", arguments->directory, "run directory")
        ->required()
        ->check(not_empty());
    command
        ->add_option("--baseline", arguments->baseline,
                     "numbers that vecino accept wrote; without it a run of \"failures\" is held "
                     "against what their files expect")
        ->check(not_empty());
    CLI::Option* const json =
        command->add_flag("--json", arguments->json, "print one JSON object with every verdict");
    command->add_option("--junit", arguments->junit, "also write JUnit XML")->check(not_empty());
    command
        ->add_option("--markdown", arguments->markdown,
                     "also write a summary for a pull request's comment")
        ->check(not_empty());
    command
        ->add_flag("--ctest", arguments->ctest,
                   "also print measurements and images as CTest hands them to CDash")
        ->excludes(json);
    command->footer(
        "Exit codes: 0 pass; 2 a comparison failed, or a cell or baseline is missing; 5 non-finite "
        "pixels.\nTolerances: \"gates\" of the matrix (vecino schema matrix).");
    command->callback(
        [arguments, &chosen] { chosen = [arguments] { return run_check(*arguments); }; });
}

}  // namespace vecino
