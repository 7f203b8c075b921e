// SPDX-License-Identifier: Apache-2.0
//
// `vecino compare TEST REFERENCE --test unbiased`: files in, verdicts out.
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/unbiased.h"

namespace vecino {

/// Reads both files and tests them. Throws Error(mismatch) if one lacks the planes variance or
/// count, or has other sizes; Error(non_finite) if a mean or a variance is not finite.
std::vector<UnbiasedRule> compare_unbiased(const std::string& test, const std::string& reference);

/// {"holds":, "rules": [{"rule":, "tests":, "least_p":, "limit_p":, ...}, ...]}
nlohmann::json unbiased_json(const std::vector<UnbiasedRule>& rules);

/// A line per rule with its value and limit.
std::string unbiased_text(const std::vector<UnbiasedRule>& rules);

}  // namespace vecino
