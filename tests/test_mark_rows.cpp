// SPDX-License-Identifier: Apache-2.0
#include "filters/mark_rows.h"

#include <algorithm>
#include <random>
#include <vector>

#include "tests/catch.h"

using namespace vecino;

namespace {

/// Whether a window has a pixel that is marked (or not, as wanted).
bool has_any(const std::vector<std::vector<bool>>& marks, int x, int y, int reach, bool wanted) {
    const int rows = static_cast<int>(marks.size()), width = static_cast<int>(marks[0].size());
    for (int r = std::max(y - reach, 0); r <= std::min(y + reach, rows - 1); ++r) {
        for (int c = std::max(x - reach, 0); c <= std::min(x + reach, width - 1); ++c) {
            if (marks[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)] == wanted)
                return true;
        }
    }
    return false;
}

}  // namespace

TEST_CASE("marks spread and shrink by windows, across words and at borders", "[surface_records]") {
    const int width = GENERATE(1, 2, 63, 64, 65, 130), rows = GENERATE(1, 3, 20);
    const int reach = GENERATE(0, 1, 6);
    const unsigned one_of = GENERATE(2u, 40u);
    INFO(width << "x" << rows << ", reach " << reach);
    std::mt19937 random(7);
    std::vector<std::vector<bool>> marks(static_cast<std::size_t>(rows),
                                         std::vector<bool>(static_cast<std::size_t>(width)));
    // Few marks for what is near them, few gaps for what is within them.
    MarkRows few(marks.size(), width), most(marks.size(), width);
    for (std::size_t y = 0; y < marks.size(); ++y) {
        for (int x = 0; x < width; ++x) {
            const bool marked = random() % one_of == 0;
            marks[y][static_cast<std::size_t>(x)] = marked;
            if (marked) {
                few.set(y, x);
            } else {
                most.set(y, x);
            }
        }
    }
    const MarkRows near = few.near(reach), within = most.within(reach), all = near | within;
    bool right = true;
    for (int y = 0; y < rows; ++y) {
        const auto r = static_cast<std::size_t>(y);
        std::vector<int> visited;
        all.row(r).visit([&](int x) { visited.push_back(x); });
        CHECK(std::ranges::is_sorted(visited));
        CHECK(static_cast<int>(visited.size()) == width);  // near a mark, or within the others
        for (int x = 0; x < width; ++x) {
            right &= near.row(r).has(x) == has_any(marks, x, y, reach, true);
            right &= within.row(r).has(x) == !has_any(marks, x, y, reach, true);
        }
    }
    CHECK(right);
}
