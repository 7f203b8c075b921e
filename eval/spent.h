// SPDX-License-Identifier: Apache-2.0
//
// What a run took before this go of it.
#pragma once

#include <string>

#include "eval/run_directory.h"

namespace vecino {

/// What a run took, over all its goes.
struct Spent {
    double seconds = 0;
    double samples = 0;
};

/// Of the goes that the directory's run.json tells of; nothing where there is none. Throws
/// Error(usage) if they were of another matrix, whose results would be lost when results.jsonl is
/// written anew.
Spent spent_before(const RunDirectory& directory, const std::string& matrix);

}  // namespace vecino
