// SPDX-License-Identifier: Apache-2.0
//
// The row of the table of method options that auto reads.
#include <charconv>
#include <string>

#include "core/json_schema.h"
#include "filters/method_rows.h"

namespace vecino {
namespace {

constexpr NumberRange kSeconds{1e-3, 86400};

void set_budget(MethodParameters& parameters, const JsonValue& json) {
    parameters.planner.time_budget_s = json.number(kSeconds);
}

nlohmann::json get_budget(const MethodParameters& parameters) {
    const auto& seconds = parameters.planner.time_budget_s;
    return seconds ? nlohmann::json(*seconds) : nlohmann::json("spp");
}

std::string budget_slug(const MethodParameters& parameters) {
    const auto& seconds = parameters.planner.time_budget_s;
    if (!seconds) return "t_spp";
    char digits[32];  // the fewest that read back as the same number
    const auto [end, error] = std::to_chars(std::begin(digits), std::end(digits), *seconds);
    return "t" + std::string(digits, end);
}

nlohmann::json budget_schema() {
    return RealKind{kSeconds}.schema();
}

// clang-format off
const MethodOption kRows[] = {
    {"time_budget", "--time-budget", "seconds from 0.001 to 86400",
     "what tracing and reconstruction may take; without: what paths take for --spp",
     set_budget, get_budget, budget_slug, budget_schema},
};
// clang-format on

}  // namespace

std::span<const MethodOption> auto_rows() {
    return kRows;
}

}  // namespace vecino
