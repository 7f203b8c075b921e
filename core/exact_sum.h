// SPDX-License-Identifier: Apache-2.0
//
// Sums without rounding, so that the order of their addends cannot matter. A sum is an integer
// multiple of 2^-149, the smallest float, held as 16 digits of 24 bits each: wide enough for 2^31
// of the largest floats. Its canonical digits, each in [-2^23, 2^23), are unique to its value and
// are floats themselves, so that files and planes can hold them.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace vecino {

class ExactSum {
  public:
    static constexpr std::size_t kDigits = 16;
    /// Integers; number i counts for 2^(24 i - 149).
    using Digits = std::array<float, kDigits>;

    /// Adds a finite number.
    void add(float value) {
        const auto bits = std::bit_cast<std::uint32_t>(value);
        const std::uint32_t exponent = (bits >> 23) & 0xFF;
        const std::uint32_t mantissa = (bits & 0x7FFFFF) | (exponent > 0 ? 0x800000u : 0u);
        add(mantissa, exponent > 0 ? exponent - 1 : 0, (bits >> 31) != 0);
    }

    /// Adds a number >= 0, rounded to 24 bits and to a multiple of 2^-149; what is above 2^191
    /// counts as 2^191.
    void add_rounded(double value);

    /// Adds an integer.
    void add_count(std::uint64_t count);

    /// Adds another sum.
    void add(const Digits& digits);

    /// Back to 0. Quicker than a new sum: most digits are 0 already.
    void clear() {
        for (std::size_t i = lowest_; i < end_; ++i) digits_[i] = 0;
        lowest_ = kDigits;
        end_ = 0;
    }

    /// The canonical digits. Precondition: fewer than 2^39 calls of add() so far.
    [[nodiscard]] Digits digits() const;

    /// The value behind canonical digits, to within an ulp. It depends on the value alone.
    static double value(const Digits& digits);

  private:
    static constexpr std::uint32_t kDigitBits = 24;
    static constexpr std::int64_t kBase = std::int64_t{1} << kDigitBits;

    /// Adds mantissa * 2^(shift - 149); the mantissa has at most 24 bits.
    void add(std::uint32_t mantissa, std::uint32_t shift, bool negative) {
        if (mantissa == 0) return;
        const std::size_t digit = shift / kDigitBits;
        const std::uint64_t wide = std::uint64_t{mantissa} << (shift % kDigitBits);
        const std::int64_t sign = negative ? -1 : 1;
        digits_[digit] += sign * static_cast<std::int64_t>(wide & (kBase - 1));
        digits_[digit + 1] += sign * static_cast<std::int64_t>(wide >> kDigitBits);
        lowest_ = std::min(lowest_, digit);
        end_ = std::max(end_, digit + 2);
    }

    std::array<std::int64_t, kDigits> digits_{};  // not canonical: carries are left for later
    std::size_t lowest_ = kDigits;                // all digits below are 0
    std::size_t end_ = 0;                         // all digits from here on are 0
};

}  // namespace vecino
