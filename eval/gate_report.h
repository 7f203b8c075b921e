// SPDX-License-Identifier: Apache-2.0
//
// A gate's result in the forms that people and CI services read. Failures stand first, worst first.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "eval/gate.h"

namespace vecino {

/// "PASS: ..." or "FAIL: ...", one line.
std::string gate_headline(const GateResult& result);

/// For a terminal: every failure, the passes that came closest, what was not gated and why.
std::string gate_text(const GateResult& result);

/// For a pull request's comment or a job's summary: below 60,000 bytes, whatever the run.
std::string gate_markdown(const GateResult& result);

/// {"passed":, "matrix":, "comparisons":, "failed":, "not_gated":, "groups":, "identical":,
/// "verdicts": [{"outcome":, "rule":, "class":, "group":, "metric":, "value":, ...}]}
nlohmann::json gate_json(const GateResult& result);

/// JUnit XML: a test suite per class, a test case per verdict.
std::string gate_junit(const GateResult& result);

/// Lines that CTest hands on to CDash: every value as a number, and of the worst group that failed
/// the test, valid and difference image.
std::string gate_ctest(const GateResult& result, const GateRun& run);

/// The tags themselves.
std::string ctest_number(const std::string& name, double value);
std::string ctest_image(const std::string& name, const std::string& file);

}  // namespace vecino
