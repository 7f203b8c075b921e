// SPDX-License-Identifier: Apache-2.0
#include "eval/name_pattern.h"

#include "core/error.h"

namespace vecino {
namespace {

std::regex compile(const std::string& only) {
    try {
        return std::regex(only);
    } catch (const std::regex_error&) {
        throw Error(ExitCode::usage, "command line: --only: found \"" + only +
                                         "\", allowed: an ECMAScript regular expression");
    }
}

}  // namespace

NamePattern::NamePattern(const std::string& only) : text_(only), pattern_(compile(only)) {}

void NamePattern::fail_without_match() const {
    throw Error(ExitCode::usage,
                "command line: --only: found \"" + text_ +
                    "\", allowed: an expression that matches a cell (see vecino list cells)");
}

}  // namespace vecino
