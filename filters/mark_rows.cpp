// SPDX-License-Identifier: Apache-2.0
#include "filters/mark_rows.h"

#include <algorithm>

namespace vecino {

MarkRows::MarkRows(std::size_t rows, int width)
    : rows_(rows),
      per_row_((static_cast<std::size_t>(width) + 63) / 64),
      last_(~std::uint64_t{0} >> (64 * per_row_ - static_cast<std::size_t>(width))),
      words_(rows * per_row_) {}

/// Both ways; by: 1 to 63.
void MarkRows::add_shifted(std::size_t row, int by, MarkRows& out) const {
    const std::uint64_t* const from = words_.data() + row * per_row_;
    std::uint64_t* const to = out.words_.data() + row * per_row_;
    for (std::size_t k = 0; k < per_row_; ++k) {
        const std::uint64_t before = k > 0 ? from[k - 1] : 0;
        const std::uint64_t after = k + 1 < per_row_ ? from[k + 1] : 0;
        to[k] |= from[k] << by | before >> (64 - by) | from[k] >> by | after << (64 - by);
    }
    to[per_row_ - 1] &= last_;
}

MarkRows MarkRows::near(int reach) const {
    MarkRows across = *this;
    for (std::size_t row = 0; row < rows_; ++row) {
        for (int by = 1; by <= reach; ++by) add_shifted(row, by, across);
    }
    MarkRows out = across;
    for (std::size_t by = 1; by <= std::min(static_cast<std::size_t>(reach), rows_); ++by) {
        for (std::size_t i = by * per_row_; i < words_.size(); ++i) {
            out.words_[i] |= across.words_[i - by * per_row_];
            out.words_[i - by * per_row_] |= across.words_[i];
        }
    }
    return out;
}

MarkRows MarkRows::complement() const {
    MarkRows out = *this;
    for (std::size_t i = 0; i < words_.size(); ++i)
        out.words_[i] = ~words_[i] & ((i + 1) % per_row_ == 0 ? last_ : ~std::uint64_t{0});
    return out;
}

MarkRows MarkRows::within(int reach) const {
    return complement().near(reach).complement();
}

MarkRows operator|(MarkRows a, const MarkRows& b) {
    for (std::size_t i = 0; i < a.words_.size(); ++i) a.words_[i] |= b.words_[i];
    return a;
}

}  // namespace vecino
