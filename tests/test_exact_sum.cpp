// SPDX-License-Identifier: Apache-2.0
//
// Sums that do not depend on the order of their addends, over the whole range of float.
#include "core/exact_sum.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/catch.h"

using namespace vecino;

namespace {

ExactSum sum_of(const std::vector<float>& values) {
    ExactSum sum;
    for (const float value : values) sum.add(value);
    return sum;
}

double value_of(const std::vector<float>& values) {
    return ExactSum::value(sum_of(values).digits());
}

/// Floats of every magnitude and both signs.
std::vector<float> wild_floats(std::size_t count) {
    std::mt19937 random(7);
    std::vector<float> values;
    while (values.size() < count) {
        const float value = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
        if (std::isfinite(value)) values.push_back(value);
    }
    return values;
}

}  // namespace

TEST_CASE("a sum of one float is that float", "[exact_sum]") {
    for (const float value : wild_floats(2000)) {
        CHECK(value_of({value}) == static_cast<double>(value));
    }
    for (const float value :
         {0.0f, -0.0f, 1.0f, -1.0f, std::numeric_limits<float>::max(),
          std::numeric_limits<float>::lowest(), std::numeric_limits<float>::min(),
          std::numeric_limits<float>::denorm_min(), -std::numeric_limits<float>::denorm_min()}) {
        CHECK(value_of({value}) == static_cast<double>(value));
    }
}

TEST_CASE("the order of addends changes no digit of a sum", "[exact_sum]") {
    std::vector<float> values = wild_floats(500);
    const ExactSum::Digits digits = sum_of(values).digits();
    std::mt19937 random(1);
    for (int i = 0; i < 20; ++i) {
        std::ranges::shuffle(values, random);
        CHECK(sum_of(values).digits() == digits);
        // In two halves, joined by their digits, in either order.
        const auto middle = values.begin() + static_cast<std::ptrdiff_t>(random() % values.size());
        const auto left = sum_of({values.begin(), middle}).digits();
        ExactSum right = sum_of({middle, values.end()});
        right.add(left);
        CHECK(right.digits() == digits);
    }
}

TEST_CASE("a float that is added and taken away leaves no trace", "[exact_sum]") {
    const float huge = 3e38f;
    const float tiny = std::numeric_limits<float>::denorm_min();
    CHECK(value_of({tiny, huge, -huge}) == static_cast<double>(tiny));
    CHECK(value_of({huge, 1.0f, tiny, -huge, -1.0f}) == static_cast<double>(tiny));
    for (const float digit : sum_of({huge, -3.0f, -huge, 3.0f}).digits()) CHECK(digit == 0.0f);
}

TEST_CASE("sums go far beyond the largest float", "[exact_sum]") {
    ExactSum sum;
    for (int i = 0; i < 100000; ++i) sum.add(std::numeric_limits<float>::max());
    ExactSum doubled = sum;
    for (int i = 0; i < 16; ++i) doubled.add(doubled.digits());
    const double expected =
        65536.0 * 100000.0 * static_cast<double>(std::numeric_limits<float>::max());
    CHECK(ExactSum::value(doubled.digits()) == Approx(expected).epsilon(1e-15));
    doubled.add(-1.0f);
    ExactSum::Digits digits = doubled.digits();
    doubled.add(1.0f);
    CHECK(digits != doubled.digits());
}

TEST_CASE("digits are integers of 24 bits that floats hold exactly", "[exact_sum]") {
    for (const float digit : sum_of(wild_floats(1000)).digits()) {
        CHECK(std::trunc(digit) == digit);
        CHECK(digit >= -0x1p23f);
        CHECK(digit < 0x1p23f);
    }
}

TEST_CASE("counts are exact and squares are rounded to 24 bits", "[exact_sum]") {
    for (const std::uint64_t count : {0ull, 1ull, 64ull, (1ull << 31) - 1, (1ull << 52) + 1}) {
        ExactSum sum;
        sum.add_count(count);
        CHECK(ExactSum::value(sum.digits()) == static_cast<double>(count));
    }
    std::mt19937 random(3);
    std::uniform_real_distribution<double> exponents(-120, 190);
    for (int i = 0; i < 2000; ++i) {
        const double value = std::exp2(exponents(random));
        ExactSum sum;
        sum.add_rounded(value);
        CHECK(ExactSum::value(sum.digits()) == Approx(value).epsilon(0x1p-24));
    }
    const auto rounded = [](double value) {
        ExactSum sum;
        sum.add_rounded(value);
        return ExactSum::value(sum.digits());
    };
    CHECK(rounded(0x1p24 - 0.25) == 0x1p24);  // carries into one bit more
    CHECK(rounded(1e300) == 0x1p191);
    CHECK(rounded(1e-50) == 0.0);
    CHECK(rounded(0.0) == 0.0);
}
