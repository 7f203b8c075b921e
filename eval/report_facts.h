// SPDX-License-Identifier: Apache-2.0
//
// What a report says of the run as a whole, in words; no markup here.
#pragma once

#include <string>
#include <vector>

#include "eval/report_data.h"

namespace vecino {

struct Fact {
    std::string name, value;
};

/// When, where, with what and how much.
std::vector<Fact> run_facts(const ReportData& data);

/// A JSON value as a reader wants it: texts without quotes.
std::string text_of(const nlohmann::json& value);

std::size_t failed_rows(const ReportData& data);

}  // namespace vecino
