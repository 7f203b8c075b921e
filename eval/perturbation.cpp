// SPDX-License-Identifier: Apache-2.0
#include "eval/perturbation.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>

namespace vecino {
namespace {

constexpr double kLow = 0.5;
constexpr double kHigh = 1.5;
constexpr int kMostWindow = 9999;

int nearest_odd(double value) {
    return 2 * static_cast<int>(std::lround((value - 1) / 2)) + 1;
}

/// At least one step away, where there is one.
double scale_window(SchemeParameters& parameters, double factor) {
    const int now = parameters.window;
    const int scaled = nearest_odd(now * factor);
    const int moved = factor < 1 ? std::min(scaled, now - 2) : std::max(scaled, now + 2);
    parameters.window = std::clamp(moved, 1, kMostWindow);
    return parameters.window;
}

double scale_normal_cosine(SchemeParameters& parameters, double factor) {
    constexpr double kDegrees = 180 / std::numbers::pi;
    const auto cosine = static_cast<double>(parameters.min_normal_cosine);
    const double angle =
        std::min(180.0, factor * std::acos(std::clamp(cosine, -1.0, 1.0)) * kDegrees);
    parameters.min_normal_cosine = static_cast<float>(std::cos(angle / kDegrees));
    return angle;
}

double scale_order(SchemeParameters& parameters, double factor) {
    parameters.order = std::clamp(parameters.order + (factor < 1 ? -1 : 1), 0, 2);
    return parameters.order;
}

double scale_guide(SchemeParameters& parameters, double factor) {
    constexpr int kMost = 16;
    parameters.guide_scale = std::clamp(parameters.guide_scale + (factor < 1 ? -1 : 1), 1, kMost);
    return parameters.guide_scale;
}

/// Multiplies a parameter by about the factor; returns what it is then.
struct SchemeScale {
    std::string_view option;
    double (*scale)(SchemeParameters&, double factor);
};

constexpr SchemeScale kSchemeScales[] = {
    {"window", scale_window},
    {"min_normal_cosine", scale_normal_cosine},
    {"order", scale_order},
    {"guide_scale", scale_guide},
};

/// Both ends, by a function that multiplies the parameter and returns what it is then.
template <class Scale>
void add(const Cell& cell, std::string_view option, const Scale& scale,
         std::vector<Perturbation>& result) {
    const auto scaled = [&](double factor) {
        PerturbedCell changed{0, cell};
        changed.value = scale(changed.cell, factor);
        return changed;
    };
    Perturbation both{std::string(option), scaled(kLow), scaled(kHigh)};
    if (both.low.value > 0 && both.low.value < both.high.value) result.push_back(std::move(both));
}

}  // namespace

std::vector<Perturbation> perturbations(const Cell& cell) {
    std::vector<Perturbation> result;
    for (const SchemeScale& row : kSchemeScales) {
        if (cell.scheme == nullptr || !cell.scheme->reads(row.option)) continue;
        add(
            cell, row.option,
            [&](Cell& c, double factor) { return row.scale(c.parameters, factor); }, result);
    }
    for (const MethodOption& row : method_options()) {
        if (cell.render_method == nullptr || !cell.render_method->reads(row.name)) continue;
        add(
            cell, row.name,
            [&](Cell& c, double factor) {
                return scale_option(row, c.method_parameters, factor).value_or(0);
            },
            result);
    }
    return result;
}

}  // namespace vecino
