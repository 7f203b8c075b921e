// SPDX-License-Identifier: Apache-2.0

/// @file
/// The one exception type of vecino. It carries the program's exit code, so that a failure deep in
/// a library and the code a script sees are the same fact. A message is one line: where, what was
/// found, what is allowed.
#pragma once

#include <stdexcept>
#include <string>

namespace vecino {

/// Exit codes of the program. Where several apply: usage, then file, mismatch, non_finite, quality.
enum class ExitCode : int {
    ok = 0,             ///< success, and every limit holds
    quality = 2,        ///< a quality limit failed, or cells of a run failed
    mismatch = 3,       ///< sizes, channels or planes do not fit together
    file = 4,           ///< a file cannot be read, decoded or written
    non_finite = 5,     ///< NaN or infinity where a number is needed
    usage = 64,         ///< bad command line or bad JSON content
    skipped = 125,      ///< a test that cannot run here
    interrupted = 130,  ///< SIGINT or SIGTERM; state is kept
};

/// What functions of vecino throw when they cannot do what was asked. Where memory runs out it is
/// std::bad_alloc, and what Embree refuses is a plain std::runtime_error.
class Error : public std::runtime_error {
  public:
    /// The message is one line: where, what was found, what is allowed.
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    /// What kind of failure this is, and what the program exits with.
    [[nodiscard]] ExitCode code() const noexcept { return code_; }

  private:
    ExitCode code_;
};

}  // namespace vecino
