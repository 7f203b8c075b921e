// SPDX-License-Identifier: Apache-2.0
//
// Metrics as JSON, as `compare --json` and results.jsonl hold them. A metric without a value is
// null, with "NAME_reason" where there is one to tell; one that was not asked for is left out.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "eval/metrics.h"

namespace vecino {

nlohmann::json metrics_json(const Metrics& metrics);

/// Nulls for none.
nlohmann::json metrics_json(const std::optional<Metrics>& metrics);

/// The metrics, "non_finite", and if there are regions "regions": {"emitter": {"pixels":, and the
/// metrics}, ...}.
nlohmann::json comparison_json(const Comparison& comparison);

/// test - reference, linear. Precondition: equal sizes.
Image difference(const Image& test, const Image& reference);

std::string size_mismatch_text(const std::string& a, Extent a_size, const std::string& b,
                               Extent b_size);

}  // namespace vecino
