// SPDX-License-Identifier: Apache-2.0
#include "filters/pixel_needs.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "core/parallel.h"

namespace vecino {
namespace {

/// Goes down rows, comparing each with the one above it.
class NeedFinder {
  public:
    NeedFinder(const TraceTask& task, const PixelClusters& clusters, RowRange rows)
        : task_(task), clusters_(clusters) {
        look(rows.begin - 1, above_);
        look(rows.begin, own_);
        needs_.assign(width(), 0);
        std::vector<std::int32_t> unread(width(), 0);
        compare_rows(above_, own_, unread, needs_);
    }

    /// The next row's needy pixels.
    std::vector<NeedyPixel> next(int y) {
        compare_in_row(own_, needs_);
        look(y + 1, below_);
        std::vector<std::int32_t> of_below(width(), 0);
        compare_rows(own_, below_, needs_, of_below);
        std::vector<NeedyPixel> needy;
        for (std::size_t x = 0; x < needs_.size(); ++x) {
            if (needs_[x] != 0)
                needy.push_back({static_cast<int>(x), static_cast<std::uint8_t>(needs_[x])});
        }
        std::swap(own_, below_);
        needs_ = std::move(of_below);
        return needy;
    }

  private:
    [[nodiscard]] std::size_t width() const { return static_cast<std::size_t>(clusters_.width()); }
    void look(int y, LookRow& row) const { look_at_row(task_, clusters_, y, row); }

    const TraceTask& task_;
    const PixelClusters& clusters_;
    LookRow above_, own_, below_;
    std::vector<std::int32_t> needs_;
};

/// In pixels.
int reach_of(int pilot_spp) {
    if (pilot_spp >= 8) return 0;
    return pilot_spp >= 4 ? 1 : 2;
}

/// Marks pixels of a row within reach of those of it that lie in half-shadow.
void mark_around(const std::vector<NeedyPixel>& row, int reach, std::vector<std::uint8_t>& marks) {
    const int last = static_cast<int>(marks.size()) - 1;
    for (const NeedyPixel& pixel : row) {
        if ((pixel.needs & kNeedsShadow) == 0) continue;
        for (int x = std::max(pixel.x - reach, 0); x <= std::min(pixel.x + reach, last); ++x)
            marks[static_cast<std::size_t>(x)] = 1;
    }
}

/// Adds those that are marked and allowed.
std::vector<NeedyPixel> with_marked(const std::vector<NeedyPixel>& row,
                                    const std::vector<std::uint8_t>& marks,
                                    const std::function<bool(int)>& allowed) {
    std::vector<NeedyPixel> out;
    auto own = row.begin();
    for (int x = 0; x < static_cast<int>(marks.size()); ++x) {
        if (own != row.end() && own->x == x) {
            out.push_back(*own++);
        } else if (marks[static_cast<std::size_t>(x)] != 0 && allowed(x)) {
            out.push_back({x, kNeedsShadow});
        }
    }
    return out;
}

NeedyRows find_known(const RecordTracer& tracer, const PixelClusters& clusters, RowRange rows) {
    constexpr std::size_t kRowsPerBlock = 16;
    const auto count = static_cast<std::size_t>(rows.end - rows.begin);
    NeedyRows needy(count);
    for_each_block(count, kRowsPerBlock, tracer.threads, [&](BlockRange block) {
        const auto row = [&](std::size_t r) { return rows.begin + static_cast<int>(r); };
        NeedFinder finder(tracer.task, clusters, {row(block.begin), row(block.end)});
        for (std::size_t r = block.begin; r < block.end; ++r) needy[r] = finder.next(row(r));
    });
    return needy;
}

}  // namespace

NeedyRows find_needs(const RecordTracer& tracer, const PixelClusters& clusters, RowRange rows,
                     int pilot_spp) {
    const int reach = reach_of(pilot_spp);
    const RowRange around{std::max(rows.begin - reach, clusters.rows().begin),
                          std::min(rows.end + reach, clusters.rows().end)};
    NeedyRows known = find_known(tracer, clusters, around);
    if (reach == 0) return known;
    NeedyRows needy(static_cast<std::size_t>(rows.end - rows.begin));
    const auto count = static_cast<int>(known.size());
    for_each_block(needy.size(), 1, tracer.threads, [&](BlockRange block) {
        const int y = rows.begin + static_cast<int>(block.begin), r = y - around.begin;
        std::vector<std::uint8_t> marks(static_cast<std::size_t>(clusters.width()), 0);
        for (int n = std::max(r - reach, 0); n <= std::min(r + reach, count - 1); ++n)
            mark_around(known[static_cast<std::size_t>(n)], reach, marks);
        needy[block.begin] = with_marked(known[static_cast<std::size_t>(r)], marks, [&](int x) {
            return clusters.first_cluster(x, y).object >= 0;
        });
    });
    return needy;
}

}  // namespace vecino
