// SPDX-License-Identifier: Apache-2.0
//
// Looking at an error: its code and its exact words.
#pragma once

#include <stdexcept>
#include <string>

#include "core/error.h"

namespace vecino {

/// The vecino::Error that a call ends with; any other end fails the test.
template <class Call>
Error error_of(Call&& call) {
    try {
        call();
    } catch (const Error& error) {
        return error;
    }
    throw std::logic_error("no error was thrown");
}

}  // namespace vecino
