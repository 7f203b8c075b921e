// SPDX-License-Identifier: Apache-2.0
#include "filters/pixel_needs.h"

#include <algorithm>
#include <functional>
#include <utility>

#include "core/parallel.h"
#include "filters/mark_rows.h"

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

/// In pixels, around all half-shadow.
int reach_of(int pilot_spp) {
    if (pilot_spp >= 8) return 0;
    return pilot_spp >= 4 ? 1 : 2;
}

/// To each side of a pixel in the middle of a wide half-shadow. Neighbours that differ are both
/// marked; the fewer first samples, the farther a narrow one scatters.
constexpr int kWideOfFew = 6;
int wide_of(int pilot_spp) {
    return pilot_spp >= 4 ? 4 : kWideOfFew;
}

/// Beyond a wide half-shadow as far as is known.
constexpr int kFadesOut = 2;

/// Where samples pick one of many emitters, few of them find what hides one: around each that does.
constexpr int kMostScattered = 3;
static_assert(2 * kWideOfFew + kFadesOut + kMostScattered <= kNeedsReach);
int scattered_of(int pilot_spp) {
    if (pilot_spp >= 16) return 1;
    return pilot_spp >= 4 ? 2 : kMostScattered;
}

MarkRows marks_of(const NeedyRows& rows, int width, std::uint8_t needs) {
    MarkRows marks(rows.size(), width);
    for (std::size_t r = 0; r < rows.size(); ++r) {
        for (const NeedyPixel& pixel : rows[r]) {
            if ((pixel.needs & needs) != 0) marks.set(r, pixel.x);
        }
    }
    return marks;
}

/// Adds those that are marked and allowed, and says of all which are wide.
std::vector<NeedyPixel> with_marked(const std::vector<NeedyPixel>& row, const MarkedPixels& marked,
                                    const MarkedPixels& wide,
                                    const std::function<bool(int)>& allowed) {
    std::vector<NeedyPixel> out;
    auto own = row.begin();
    const auto take_own = [&] {
        out.push_back(*own++);
        if (wide.has(out.back().x)) out.back().needs |= kWideShadow;
    };
    marked.visit([&](int x) {
        while (own != row.end() && own->x < x) take_own();
        if (own != row.end() && own->x == x) {
            take_own();
        } else if (allowed(x)) {
            out.push_back({x, kNeedsShadow});
        }
    });
    while (own != row.end()) take_own();
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
    const int wide_reach = wide_of(pilot_spp);
    const RowRange around{std::max(rows.begin - kNeedsReach, clusters.rows().begin),
                          std::min(rows.end + kNeedsReach, clusters.rows().end)};
    const NeedyRows known = find_known(tracer, clusters, around);
    MarkRows shadow = marks_of(known, clusters.width(), kNeedsShadow);
    if (sums_lights(tracer.task)) shadow = shadow.near(scattered_of(pilot_spp));
    const MarkRows wide = shadow.within(wide_reach);
    const MarkRows marked = shadow.near(reach_of(pilot_spp)) | wide.near(wide_reach + kFadesOut);
    NeedyRows needy(static_cast<std::size_t>(rows.end - rows.begin));
    for_each_block(needy.size(), 16, tracer.threads, [&](BlockRange block) {
        for (std::size_t r = block.begin; r < block.end; ++r) {
            const int y = rows.begin + static_cast<int>(r);
            const auto k = static_cast<std::size_t>(y - around.begin);
            needy[r] = with_marked(known[k], marked.row(k), wide.row(k), [&](int x) {
                return clusters.block(x, y).object[x % kPilotPixels] >= 0;
            });
        }
    });
    return needy;
}

}  // namespace vecino
