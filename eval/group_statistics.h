// SPDX-License-Identifier: Apache-2.0
//
// Noise and bias of every group of a run, from the images of its seeds.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/run_directory.h"
#include "eval/seed_statistics.h"

namespace vecino {

/// By group. Kept in statistics.json: only groups whose rows changed are read again. A group with a
/// failed cell, or whose images or reference are gone, has none. Rows are those of results.jsonl.
std::map<std::string, SeedStatisticsByRegion> group_statistics(
    const RunDirectory& directory, const std::vector<nlohmann::json>& rows);

}  // namespace vecino
