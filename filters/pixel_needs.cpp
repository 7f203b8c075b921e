// SPDX-License-Identifier: Apache-2.0
#include "filters/pixel_needs.h"

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

}  // namespace

NeedyRows find_needs(const RecordTracer& tracer, const PixelClusters& clusters, RowRange rows) {
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

}  // namespace vecino
