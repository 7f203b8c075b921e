// SPDX-License-Identifier: Apache-2.0
#include "eval/budget.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/named_values.h"

namespace vecino {
namespace {

constexpr Named<Budget> kBudgets[] = {
    {"same_spp", Budget::same_spp},
    {"equal_samples", Budget::equal_samples},
    {"thesis_equal_time", Budget::thesis_equal_time},
    {"equal_time", Budget::equal_time},
};

constexpr double kThesisEqualTime = 48000.0 / 10000.0;

double factor(Budget budget, const FrameSizes& sizes) {
    switch (budget) {
        case Budget::thesis_equal_time:
            return kThesisEqualTime;
        case Budget::equal_samples:
        case Budget::equal_time:
            return static_cast<double>(sizes.full.area()) / static_cast<double>(sizes.low.area());
        case Budget::same_spp:
            break;
    }
    return 1.0;
}

}  // namespace

std::vector<std::string_view> budget_names() {
    std::vector<std::string_view> names;
    for (const Named<Budget>& row : kBudgets) names.push_back(row.name);
    return names;
}

std::string budget_name(Budget budget) {
    return name_of(kBudgets, budget);
}

Budget budget_of(const JsonValue& json) {
    return value_of(kBudgets, json);
}

int budgeted_spp(Budget budget, int spp, const FrameSizes& sizes) {
    const double budgeted = std::round(spp * factor(budget, sizes));
    return static_cast<int>(
        std::clamp(budgeted, 1.0, static_cast<double>(std::numeric_limits<int>::max())));
}

}  // namespace vecino
