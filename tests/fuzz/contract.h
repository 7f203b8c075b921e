// SPDX-License-Identifier: Apache-2.0
//
// What holds for every input, however broken: a call gives a result, or an Error that the program
// ends with as one line and a documented exit code. What breaks this aborts, so that a fuzzer keeps
// the input.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>

#include "core/error.h"

namespace vecino::fuzz {

[[noreturn]] inline void broken(const std::string& what) {
    std::fprintf(stderr, "contract broken: %s\n", what.c_str());
    std::abort();
}

inline void require(bool holds, const std::string& what) {
    if (!holds) broken(what);
}

/// A reader, a scheme or a render may end with these; the other exit codes are for commands.
inline bool is_documented(ExitCode code) {
    return code == ExitCode::mismatch || code == ExitCode::file || code == ExitCode::non_finite ||
           code == ExitCode::usage;
}

inline void require_one_line(const std::string& message) {
    constexpr std::size_t kLongest = 4000;  // paths and names stand in it, but no whole documents
    require(!message.empty(), "an error without words");
    require(message.size() <= kLongest, "an error of " + std::to_string(message.size()) + " bytes");
    const bool is_plain =
        std::ranges::none_of(message, [](unsigned char c) { return c < ' ' || c == 0x7F; });
    require(is_plain, "an error with line breaks or control characters: " + message);
}

/// Whether the call gave a result. Any other end than a documented one leaves through here.
template <class Call>
bool gives_result(Call&& call) {
    try {
        call();
        return true;
    } catch (const Error& error) {
        require(is_documented(error.code()),
                "exit code " + std::to_string(static_cast<int>(error.code())));
        require_one_line(error.what());
    } catch (const std::bad_alloc&) {
        // "not enough memory", exit code 4
    }
    return false;
}

}  // namespace vecino::fuzz
