// SPDX-License-Identifier: Apache-2.0
//
// Mistakes and what the program must say to them: one line on stderr, nothing on stdout, an exit
// code of its own, and every file as it was.
#pragma once

#include <span>
#include <string>

#include "tests/temp_dir.h"

namespace vecino::test {

struct Mistake {
    std::string name;     ///< what is wrong
    std::string line;     ///< arguments of the program, split at spaces; "..." is one
    int code;             ///< the exit code
    std::string message;  ///< the essential part of the error
};

/// Calls the program in this process with the directory as the current one, and checks what it
/// does.
void check_mistakes(const TempDir& dir, std::span<const Mistake> mistakes);

/// The same for a line that holds no mistake: it ends with 0.
void check_success(const TempDir& dir, const std::string& line);

}  // namespace vecino::test
