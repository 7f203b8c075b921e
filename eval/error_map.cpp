// SPDX-License-Identifier: Apache-2.0
#include "eval/error_map.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "eval/colour_map.h"
#include "eval/pixel_values.h"

namespace vecino {
namespace {

float pixel_error(glm::vec3 test, glm::vec3 reference, ErrorKind kind) {
    if (!is_finite(test) || !is_finite(reference)) return std::numeric_limits<float>::quiet_NaN();
    const glm::dvec3 error = glm::dvec3(test) - glm::dvec3(reference);
    if (kind == ErrorKind::sign) return static_cast<float>((error.x + error.y + error.z) / 3);
    const double square_sum = error.x * error.x + error.y * error.y + error.z * error.z;
    return static_cast<float>(std::sqrt(square_sum / 3));
}

/// The least of 1, 2, 5 times a power of ten, from 0.001 on, that is not below the value.
float round_up(float value) {
    for (int exponent = -3; exponent < std::numeric_limits<float>::max_exponent10; ++exponent) {
        for (const double digit : {1.0, 2.0, 5.0}) {
            const auto candidate = static_cast<float>(digit * std::pow(10.0, exponent));
            if (candidate >= value) return candidate;
        }
    }
    return std::numeric_limits<float>::max();
}

void require_usable(float range) {
    if (std::isfinite(range) && range > 0) return;
    throw Error(ExitCode::usage, "error map: range is " + std::to_string(range) +
                                     ", allowed: a finite number above 0");
}

}  // namespace

Image display_image(const Image& linear) {
    Image display(linear.size());
    std::ranges::transform(linear.values(), display.values().begin(), [](const glm::vec3& value) {
        return is_finite(value) ? display_value(value) : value;
    });
    return display;
}

Grid<float> error_values(const Image& test, const Image& reference, ErrorKind kind) {
    require_comparable(test, reference);
    return display_error_values(display_image(test), display_image(reference), kind);
}

Grid<float> display_error_values(const Image& test, const Image& reference, ErrorKind kind) {
    require_comparable(test, reference);
    Grid<float> values(test.size());
    for (std::size_t i = 0; i < values.values().size(); ++i)
        values.values()[i] = pixel_error(test.values()[i], reference.values()[i], kind);
    return values;
}

float suggested_range(const Grid<float>& values) {
    std::vector<float> magnitudes;
    for (const float value : values.values())
        if (std::isfinite(value)) magnitudes.push_back(std::abs(value));
    return magnitudes.empty() ? round_up(0) : round_up(percentile_99(std::move(magnitudes)));
}

float shared_range(std::vector<float> suggested) {
    const auto middle = suggested.begin() + static_cast<std::ptrdiff_t>(suggested.size() / 2);
    std::ranges::nth_element(suggested, middle);
    return *middle;
}

Grid<glm::u8vec3> error_colours(const Grid<float>& values, const ErrorPictureStyle& style) {
    require_usable(style.range);
    const auto colour = style.kind == ErrorKind::sign ? diverging_colour : sequential_colour;
    Grid<glm::u8vec3> colours(values.size(), kNonFiniteColour);
    for (std::size_t i = 0; i < values.values().size(); ++i) {
        const float value = values.values()[i];
        if (std::isfinite(value)) colours.values()[i] = colour(value / style.range);
    }
    return colours;
}

}  // namespace vecino
