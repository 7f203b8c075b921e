// SPDX-License-Identifier: Apache-2.0
//
// Any frame, any row of the table of schemes, any values of its options, as bytes say.
#pragma once

#include "filters/schemes.h"
#include "tests/fuzz/bytes.h"

namespace vecino::fuzz {

struct SchemeInput {
    const Scheme* scheme;
    Frame low;
    Frame guide;  ///< as a file may hold it, not checked; empty for schemes without one
    ReconstructionRequest request;  ///< its guide is not set
};

SchemeInput scheme_input(Bytes bytes);

/// A value that a JSON Schema of an option allows: what a table's row reads, so that options to
/// come are tried too.
nlohmann::json allowed_value(const nlohmann::json& schema, Bytes& bytes);

}  // namespace vecino::fuzz
