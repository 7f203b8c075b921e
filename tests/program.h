// SPDX-License-Identifier: Apache-2.0
//
// The program as a script runs it, in a directory of its own.
#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <string>

#include "core/files.h"
#include "tests/temp_dir.h"

namespace vecino {

struct Outcome {
    int code = -1;
    std::string out, err;
};

/// A line for the shell.
inline Outcome run_line(const TempDir& dir, const std::string& line) {
    const std::string out = dir.path("stdout.txt");
    const std::string err = dir.path("stderr.txt");
    const std::string command =
        "cd '" + dir.path(".") + "' && " + line + " >'" + out + "' 2>'" + err + "' </dev/null";
    const int status = std::system(command.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_file(out), read_file(err)};
}

inline Outcome run_in(const TempDir& dir, const std::string& arguments) {
    return run_line(dir, "exec '" VECINO_PROGRAM "' " + arguments);
}

}  // namespace vecino
