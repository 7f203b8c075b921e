// SPDX-License-Identifier: Apache-2.0
#include "core/exact_sum.h"

#include <cmath>

namespace vecino {
namespace {

constexpr int kLowestExponent = -149;

/// What a 1 in each digit counts for.
constexpr std::array<double, ExactSum::kDigits> kScales = [] {
    std::array<double, ExactSum::kDigits> scales{};
    double scale = 0x1p-149;
    for (double& each : scales) {
        each = scale;
        scale *= 0x1p24;
    }
    return scales;
}();

}  // namespace

void ExactSum::add_rounded(double value) {
    value = std::min(value, 0x1p191);
    int exponent = 0;
    std::frexp(value, &exponent);  // value < 2^exponent
    const int shift = std::max(exponent - static_cast<int>(kDigitBits), kLowestExponent);
    const auto mantissa = static_cast<std::uint32_t>(std::lround(std::ldexp(value, -shift)));
    const bool carried = mantissa == kBase;  // one bit more than a mantissa has
    add(carried ? mantissa / 2 : mantissa,
        static_cast<std::uint32_t>(shift - kLowestExponent + (carried ? 1 : 0)), false);
}

void ExactSum::add_count(std::uint64_t count) {
    std::uint32_t shift = -kLowestExponent;
    for (; count > 0; count >>= kDigitBits, shift += kDigitBits) {
        add(static_cast<std::uint32_t>(count & (kBase - 1)), shift, false);
    }
}

void ExactSum::add(const Digits& digits) {
    for (std::size_t i = 0; i < kDigits; ++i) {
        if (digits[i] == 0.0f) continue;
        digits_[i] += static_cast<std::int64_t>(digits[i]);
        lowest_ = std::min(lowest_, i);
        end_ = std::max(end_, i + 1);
    }
}

ExactSum::Digits ExactSum::digits() const {
    Digits digits{};
    std::int64_t carry = 0;
    for (std::size_t i = lowest_; i < kDigits && (i < end_ || carry != 0); ++i) {
        const std::int64_t sum = digits_[i] + carry;
        const std::int64_t digit = ((sum + kBase / 2) & (kBase - 1)) - kBase / 2;
        digits[i] = static_cast<float>(digit);
        carry = (sum - digit) >> kDigitBits;
    }
    return digits;
}

double ExactSum::value(const Digits& digits) {
    std::size_t end = kDigits;
    while (end > 0 && digits[end - 1] == 0.0f) --end;
    if (end == 0) return 0;
    std::size_t lowest = 0;
    while (digits[lowest] == 0.0f) ++lowest;
    // From the top, so that each step but the first few rounds away less than an ulp's share.
    double value = 0;
    for (std::size_t i = end; i > lowest; --i) {
        value = value * static_cast<double>(kBase) + static_cast<double>(digits[i - 1]);
    }
    return value * kScales[lowest];
}

}  // namespace vecino
