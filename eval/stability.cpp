// SPDX-License-Identifier: Apache-2.0
#include "eval/stability.h"

#include <charconv>
#include <cmath>

#include "eval/perturbation.h"
#include "eval/pixel_values.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

Json measured(const PerturbedCell& perturbed, const Image& reference,
              const std::function<Image(const Cell&)>& make) {
    return {{"value", perturbed.value}, {"mse", display_mse(make(perturbed.cell), reference)}};
}

}  // namespace

bool has_stability(const Cell& cell) {
    return cell.kind == CellKind::path || cell.kind == CellKind::scheme ||
           cell.kind == CellKind::method;
}

bool holds_stability(const Json& row, const Cell& cell, const StabilitySpec& spec) {
    if (!has_stability(cell)) return true;
    const Json held = row.value("stability", Json());
    if (!held.is_object() || held.contains("elasticity") < spec.elasticity) return false;
    const Json shimmer = held.value("shimmer", Json::array());
    std::vector<float> shifts;
    for (const Json& each : shimmer) shifts.push_back(each.value("shift", 0.0f));
    return shifts == spec.shifts;
}

Json shimmer_json(std::span<const ShiftedView> shifted, const StillView& still,
                  const std::function<Image(const ShiftedView&)>& make) {
    Json json = Json::array();
    for (const ShiftedView& view : shifted) {
        json.push_back({{"shift", view.shift},
                        {"change", display_mse(make(view), *still.image)},
                        {"reference_change", display_mse(*view.reference, *still.reference)}});
    }
    return json;
}

Json elasticity_json(const Cell& cell, const Image& reference,
                     const std::function<Image(const Cell&)>& make) {
    Json json = Json::object();
    for (const Perturbation& both : perturbations(cell)) {
        json[both.parameter] = {{"low", measured(both.low, reference, make)},
                                {"high", measured(both.high, reference, make)}};
    }
    return json;
}

std::string shifted_image_file(double shift) {
    char digits[32];
    char* const end =
        std::to_chars(std::begin(digits), std::end(digits), static_cast<float>(shift)).ptr;
    return "shift_" + std::string(digits, end) + ".exr";
}

std::optional<Shimmer> shimmer(std::span<const Image> images, std::span<const Image> shifted,
                               double shift, double reference_change) {
    if (images.empty() || !(reference_change > 0)) return std::nullopt;
    for (std::size_t i = 0; i < images.size(); ++i) require_comparable(shifted[i], images.front());
    const auto n = static_cast<double>(images.size());
    double squares = 0;          // sum over seeds of D_i^2
    double squares_of_sums = 0;  // (sum over seeds of D_i)^2: the former, and all pairs
    const std::size_t pixels = images.front().values().size();
    for (std::size_t p = 0; p < pixels; ++p) {
        glm::dvec3 sum(0.0);
        for (std::size_t i = 0; i < images.size(); ++i) {
            const glm::dvec3 change = glm::dvec3(display_value(shifted[i].values()[p])) -
                                      glm::dvec3(display_value(images[i].values()[p]));
            sum += change;
            squares += change.x * change.x + change.y * change.y + change.z * change.z;
        }
        squares_of_sums += sum.x * sum.x + sum.y * sum.y + sum.z * sum.z;
    }
    const double values = 3 * static_cast<double>(pixels);
    Shimmer result{shift, squares / (values * n * reference_change), {}};
    if (images.size() > 1) {
        result.without_noise =
            (squares_of_sums - squares) / (values * n * (n - 1) * reference_change);
    }
    return result;
}

double display_mse(const Image& a, const Image& b) {
    require_comparable(a, b);
    double sum = 0;
    for (std::size_t i = 0; i < a.values().size(); ++i) {
        const glm::dvec3 d =
            glm::dvec3(display_value(a.values()[i])) - glm::dvec3(display_value(b.values()[i]));
        sum += d.x * d.x + d.y * d.y + d.z * d.z;
    }
    return sum / (3 * static_cast<double>(a.values().size()));
}

}  // namespace vecino
