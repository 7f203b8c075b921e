// SPDX-License-Identifier: Apache-2.0
//
// What a run says of the failures of its matrix: a number and a verdict for every group of results
// on their scenes, measured on the images that the run keeps.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/failure.h"

namespace vecino {

struct FailureResult {
    std::string group;
    std::size_t failure = 0;  ///< index into Failures::cases
    std::string method;
    nlohmann::json params;        ///< of the first cell
    std::optional<double> value;  ///< mean over seeds; none: see reason
    SignatureValues by_seed;
    std::vector<std::optional<double>> also;  ///< means over seeds, as in the case
    std::string reason;                       ///< why there is no value
    FailureVerdict verdict = FailureVerdict::fails;
    std::vector<FailureVerdict> expected;  ///< any of these; empty: nothing was expected
    std::string why;                       ///< that was expected; may be empty

    /// Also where there is no value but by a refusal: nobody expects a measure that cannot be
    /// taken.
    [[nodiscard]] bool is_unexpected() const;
};

struct Failures {
    std::vector<FailureCase> cases;
    std::vector<FailureResult> results;  ///< in the order of the rows

    /// None if the group is of no failure's scene.
    [[nodiscard]] const FailureResult* find(const std::string& group) const;
};

/// Of a row of results.jsonl: whether its method refused the settings, and its scene's failure says
/// that it does. Such a cell is no fault of a run.
bool is_expected_refusal(const nlohmann::json& row, const std::vector<FailureCase>& failures);

/// Of a run directory's rows and the matrix that its run.json keeps. Without "failures" in the
/// matrix, nothing. A measure that cannot be taken is a result without value. Throws Error(usage)
/// for a matrix that is none.
Failures failure_results(const std::string& directory, const std::vector<nlohmann::json>& rows,
                         const JsonValue& matrix);

/// One row of the chart: a method with those of its parameters that it has several of.
struct FailureMethod {
    std::string label;  ///< "distance3d, inverse"
    std::string method;
    std::vector<std::vector<const FailureResult*>> by_case;  ///< as Failures::cases; worst first
};

/// Methods in the order of their first results.
std::vector<FailureMethod> failure_methods(const Failures& failures);

/// "f2 w7": what tells the results of a method on one scene apart.
std::string variant_text(const nlohmann::json& params);

/// A number with three digits; "∞".
std::string failure_number(const std::optional<double>& value);

/// For failures.json in the run directory, and for other programs.
nlohmann::json failures_json(const Failures& failures);

}  // namespace vecino
