// SPDX-License-Identifier: Apache-2.0
#include "eval/external_command.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <optional>
#include <thread>

#include "core/error.h"
#include "core/timing.h"
#include "eval/progress.h"

namespace vecino {
namespace {

/// Stands for the status of a child whose end nobody told.
constexpr int kUnknownEnd = -1;

[[noreturn]] void fail(const ExternalCommand& command, const std::string& found) {
    throw Error(ExitCode::file, "command " + command.arguments.front() + ": " + found +
                                    ", allowed: exit code 0 (" + command.log + ")");
}

pid_t start(const ExternalCommand& command) {
    std::vector<char*> arguments;
    for (const std::string& argument : command.arguments)
        arguments.push_back(const_cast<char*>(argument.c_str()));  // posix_spawn only reads them
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, command.log.c_str(),
                                       O_WRONLY | O_CREAT | O_TRUNC, 0644);
    ::posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    if (!command.folder.empty())
        ::posix_spawn_file_actions_addchdir_np(&actions, command.folder.c_str());
    posix_spawnattr_t attributes;
    ::posix_spawnattr_init(&attributes);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
    ::posix_spawnattr_setpgroup(&attributes, 0);
    sigset_t ours;  // that the program ignores, and others need not
    ::sigemptyset(&ours);
    ::sigaddset(&ours, SIGXFSZ);
    ::posix_spawnattr_setsigdefault(&attributes, &ours);
    pid_t child = 0;
    const int error =
        ::posix_spawnp(&child, arguments[0], &actions, &attributes, arguments.data(), environ);
    ::posix_spawnattr_destroy(&attributes);
    ::posix_spawn_file_actions_destroy(&actions);
    if (error != 0) fail(command, std::string("found ") + std::strerror(error));
    return child;
}

/// Looks every now and then, in 1 % of the time that has passed, so that an interruption reaches
/// the child at once and the time is right to 1 %.
int wait_for(pid_t child, const Stopwatch& watch) {
    constexpr double kPatience_s = 5;
    int status = 0;
    std::optional<double> told_s;
    for (;;) {
        const pid_t ended = ::waitpid(child, &status, WNOHANG);
        if (ended == child) return status;
        if (ended < 0 && errno != EINTR) return kUnknownEnd;
        if (interrupted()) {  // its whole group: a script's renderer too
            if (!told_s) {
                told_s = watch.seconds();
                ::kill(-child, SIGTERM);
            } else if (watch.seconds() - *told_s > kPatience_s) {
                ::kill(-child, SIGKILL);
            }
        }
        const double pause_s = std::clamp(0.01 * watch.seconds(), 1e-4, 0.05);
        std::this_thread::sleep_for(std::chrono::duration<double>(pause_s));
    }
}

}  // namespace

double run_command(const ExternalCommand& command) {
    const Stopwatch watch;
    const int status = wait_for(start(command), watch);
    const double seconds = watch.seconds();
    if (interrupted()) throw Error(ExitCode::interrupted, "interrupted");
    if (status == kUnknownEnd) fail(command, "found that its end is not told: SIGCHLD is ignored");
    if (WIFSIGNALED(status))
        fail(command,
             std::string("found that it was ended by signal ") + std::to_string(WTERMSIG(status)));
    if (WEXITSTATUS(status) != 0)
        fail(command, "found exit code " + std::to_string(WEXITSTATUS(status)));
    return seconds;
}

}  // namespace vecino
