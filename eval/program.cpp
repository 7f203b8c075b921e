// SPDX-License-Identifier: Apache-2.0
//
// Parses, runs the chosen command, turns errors into one line and an exit code.
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "core/files.h"
#include "eval/commands.h"

namespace vecino {
namespace {

int exit_code(ExitCode code) {
    return static_cast<int>(code);
}

/// One line, whatever a file name holds.
int fail(ExitCode code, const std::string& message) {
    std::fprintf(stderr, "vecino: %s\n", one_line(message).c_str());
    return exit_code(code);
}

std::string first_line(const std::string& text) {
    return text.substr(0, text.find('\n'));
}

/// What was wrong. CLI11 calls a misspelt command a missing one.
std::string explain(CLI::App& app, const std::string& command, const CLI::ParseError& error) {
    std::string allowed;
    for (const CLI::App* each : app.get_subcommands({})) {
        if (command.starts_with('-') || command == each->get_name())
            return first_line(error.what());
        allowed += (allowed.empty() ? "" : ", ") + each->get_name();
    }
    return "found \"" + command + "\", allowed: " + allowed;
}

/// Results that go to a full disk are lost: that is no success.
void require_printed() {
    errno = 0;
    const bool printed = std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
    if (!printed) {
        const char* const known = errno != 0 ? std::strerror(errno) : nullptr;
        cannot_write("standard output", known != nullptr ? known : kWriteFailed);
    }
}

int parse_and_run(CLI::App& app, int argc, const char* const* argv, Action& chosen) {
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        throw Error(ExitCode::usage,
                    "command line: " + explain(app, argc > 1 ? argv[1] : "-", error) +
                        " (see vecino --help)");
    }
    return exit_code(chosen());
}

}  // namespace

int run_program(int argc, const char* const* argv) {
    CLI::App app("Small path-traced images, rebuilt large; and what that cost and got wrong.",
                 "vecino");
    app.set_version_flag("--version", version_text);
    app.require_subcommand(1);
    Action chosen;
    add_render_command(app, chosen);
    add_upsample_command(app, chosen);
    add_resize_command(app, chosen);
    add_merge_command(app, chosen);
    add_compare_command(app, chosen);
    add_run_command(app, chosen);
    add_report_command(app, chosen);
    add_check_command(app, chosen);
    add_accept_command(app, chosen);
    add_list_command(app, chosen);
    add_schema_command(app, chosen);
    add_bench_command(app, chosen);
    app.footer(
        "Exit codes: 0 pass; 2 a quality limit failed, a baseline is missing or cells of a run "
        "failed;\n"
        "3 sizes, channels or planes do not fit; 4 a file cannot be read or written; 5 non-finite "
        "pixels;\n"
        "64 bad usage or JSON content; 125 not done, as answered; 130 interrupted.");
    std::signal(SIGXFSZ, SIG_IGN);  // a file that grows too large is then a write that fails
    try {
        const int code = parse_and_run(app, argc, argv, chosen);
        require_printed();
        return code;
    } catch (const Error& error) {
        return fail(error.code(), error.what());
    } catch (const std::bad_alloc&) {
        return fail(ExitCode::file, "not enough memory");
    } catch (const std::exception& error) {
        return fail(ExitCode::file, error.what());
    }
}

}  // namespace vecino
