// SPDX-License-Identifier: Apache-2.0
//
// Marks on pixels, a bit each: what is near which, for whole rows at a time.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

namespace vecino {

/// The marks of a row.
class MarkedPixels {
  public:
    explicit MarkedPixels(const std::uint64_t* words, std::size_t count)
        : words_(words), count_(count) {}

    [[nodiscard]] bool has(int x) const {
        const auto i = static_cast<std::size_t>(x);
        return (words_[i / 64] >> (i % 64) & 1) != 0;
    }

    /// Calls visit(x) for those that are marked, from left to right.
    template <class Visit>
    void visit(const Visit& visit) const {
        for (std::size_t k = 0; k < count_; ++k) {
            for (std::uint64_t word = words_[k]; word != 0; word &= word - 1)
                visit(static_cast<int>(64 * k) + std::countr_zero(word));
        }
    }

  private:
    const std::uint64_t* words_;
    std::size_t count_;
};

class MarkRows {
  public:
    /// None marked. Preconditions: width >= 1; of row and x below: that they are inside.
    MarkRows(std::size_t rows, int width);

    void set(std::size_t row, int x) {
        const auto i = static_cast<std::size_t>(x);
        words_[row * per_row_ + i / 64] |= std::uint64_t{1} << (i % 64);
    }

    [[nodiscard]] MarkedPixels row(std::size_t row) const {
        return MarkedPixels(words_.data() + row * per_row_, per_row_);
    }

    /// Those with a mark in the window of so many pixels to each side; what is outside has none.
    [[nodiscard]] MarkRows near(int reach) const;
    /// Those with nothing but marks in it; what is outside does not matter.
    [[nodiscard]] MarkRows within(int reach) const;

    friend MarkRows operator|(MarkRows a, const MarkRows& b);

  private:
    [[nodiscard]] MarkRows complement() const;
    void add_shifted(std::size_t row, int by, MarkRows& out) const;

    std::size_t rows_, per_row_;
    std::uint64_t last_;  ///< bits in use of a row's last word
    std::vector<std::uint64_t> words_;
};

}  // namespace vecino
