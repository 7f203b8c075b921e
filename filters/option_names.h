// SPDX-License-Identifier: Apache-2.0
//
// What the option tables of schemes and of render methods share.
#pragma once

#include <charconv>
#include <iterator>
#include <string>

#include "core/named_values.h"
#include "filters/schemes.h"

namespace vecino {

constexpr Named<Weighting> kWeightings[] = {
    {"proportional", Weighting::proportional},
    {"inverse", Weighting::inverse},
    {"gaussian", Weighting::gaussian},
};

/// A letter and a number, "c0.95": the fewest digits that read back as the same number.
inline std::string number_slug(const std::string& letter, float number) {
    char digits[32];
    const auto [end, error] = std::to_chars(std::begin(digits), std::end(digits), number);
    return letter + std::string(digits, end);
}

/// The number that is written as its shortest spelling: 0.95 and not 0.949999988.
inline double shortest(float number) {
    const std::string digits = number_slug("", number);
    double result = 0;
    std::from_chars(digits.data(), digits.data() + digits.size(), result);
    return result;
}

}  // namespace vecino
