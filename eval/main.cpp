// SPDX-License-Identifier: Apache-2.0
//
// The program: parses, runs the chosen command, turns errors into one line and an exit code.
#include <cstdio>
#include <exception>
#include <new>

#include "eval/commands.h"

namespace {

int exit_code(vecino::ExitCode code) {
    return static_cast<int>(code);
}

std::string first_line(std::string text) {
    if (const std::size_t end = text.find('\n'); end != std::string::npos) text.resize(end);
    return text;
}

/// What was wrong, on one line. CLI11 calls a misspelt command a missing one.
std::string explain(CLI::App& app, const std::string& command, const CLI::ParseError& error) {
    std::string allowed;
    for (const CLI::App* each : app.get_subcommands({})) {
        if (command.starts_with('-') || command == each->get_name())
            return first_line(error.what());
        allowed += (allowed.empty() ? "" : ", ") + each->get_name();
    }
    return "found \"" + command + "\", allowed: " + allowed;
}

int parse_and_run(CLI::App& app, int argc, char** argv, vecino::Action& chosen) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        std::fprintf(stderr, "vecino: command line: %s (see vecino --help)\n",
                     explain(app, argc > 1 ? argv[1] : "-", error).c_str());
        return exit_code(vecino::ExitCode::usage);
    }
    return exit_code(chosen());
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Small path-traced images, rebuilt large; and what that cost and got wrong.",
                 "vecino");
    app.set_version_flag("--version", vecino::version_text);
    app.require_subcommand(1);
    vecino::Action chosen;
    vecino::add_render_command(app, chosen);
    vecino::add_upsample_command(app, chosen);
    vecino::add_compare_command(app, chosen);
    vecino::add_run_command(app, chosen);
    vecino::add_report_command(app, chosen);
    vecino::add_list_command(app, chosen);
    app.footer(
        "Exit codes: 0 pass; 2 a quality limit failed or cells of a run failed; 3 sizes, channels "
        "or planes do not fit;\n"
        "4 a file cannot be read or written; 5 non-finite pixels; 64 bad usage or JSON content; "
        "130 interrupted.");
    try {
        return parse_and_run(app, argc, argv, chosen);
    } catch (const vecino::Error& error) {
        std::fprintf(stderr, "vecino: %s\n", error.what());
        return exit_code(error.code());
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "vecino: not enough memory\n");
        return exit_code(vecino::ExitCode::file);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "vecino: %s\n", error.what());
        return exit_code(vecino::ExitCode::file);
    }
}
