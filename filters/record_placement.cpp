// SPDX-License-Identifier: Apache-2.0
#include "filters/record_placement.h"

#include <algorithm>
#include <glm/geometric.hpp>

#include "core/eight_lanes.h"
#include "core/parallel.h"

namespace vecino {
namespace {

constexpr std::size_t kMostRecords = 8;  ///< of one cell
constexpr float kSameSurface = 0.7f;     ///< cosine between normals of one side of a surface
constexpr int kLanes = 8;

/// Whether eight pixels of a block show a candidate's surface and nothing else; then the least
/// cosine between their normals and its own, too. lists: of these pixels.
VECINO_CLONES bool all_alike(const PilotBlock& block, const std::int32_t* lists, int from,
                             Candidate& held) {
    Masks8 object, list;
    Floats8 albedo[3], normal[3];
    load(block.object + from, object);
    load(lists, list);
    for (int c = 0; c < 3; ++c) {
        load(block.albedo[c] + from, albedo[c]);
        load(block.first_normal[c] + from, normal[c]);
    }
    const Floats8 cosine =
        normal[0] * held.normal.x + normal[1] * held.normal.y + normal[2] * held.normal.z;
    const Masks8 alike = (object == held.object) & (list < 0) & (cosine >= kSameSurface) &
                         (albedo[0] + albedo[1] + albedo[2] > 0.0f);
    std::int32_t all = -1;
    float least = held.least_cosine;
    for (int i = 0; i < kLanes; ++i) {
        all &= alike[i];
        least = cosine[i] < least ? cosine[i] : least;
    }
    if (all != 0) held.least_cosine = least;
    return all != 0;
}

/// Of one level.
class Placement {
  public:
    Placement(const PixelClusters& clusters, int cell) : clusters_(clusters), cell_(cell) {}

    void place(int column, int row, Candidates& out) {
        const RowRange rows = clusters_.rows();
        left_ = column * cell_;
        top_ = row * cell_;
        right_ = std::min(left_ + cell_, clusters_.width());
        first_ = out.size();
        // From the middle outwards: what is there is hardly ever replaced.
        for (int i = 0; i < cell_; ++i) {
            const int y = top_ + (cell_ - 1 + (i % 2 == 0 ? -i : i + 1)) / 2;
            if (y >= rows.begin && y < rows.end) consider_row(y, out);
        }
    }

  private:
    // What a surface is like right beside another holds for less than a cell.
    static constexpr float kBeside = 0.15f;

    void consider_row(int y, Candidates& out) const {
        for (int x = left_; x < right_;) {
            const int i = x % kPilotPixels;
            const bool eight = x + kLanes <= right_ && i + kLanes <= kPilotPixels;
            if (eight && first_ < out.size() &&
                all_alike(clusters_.block(x, y), clusters_.list_numbers(x, y), i, out[first_])) {
                improve({x, y}, out[first_]);
                x += kLanes;
                continue;
            }
            const int end = eight ? x + kLanes : std::min(x + kPilotPixels - i, right_);
            for (; x < end; ++x) consider(x, y, out);
        }
    }

    [[nodiscard]] float off_centre(int x, int y) const {
        const float half = 0.5f * static_cast<float>(cell_);
        const float dx = (static_cast<float>(x - left_) + 0.5f) / half - 1.0f;
        const float dy = (static_cast<float>(y - top_) + 0.5f) / half - 1.0f;
        return 0.25f * (dx * dx + dy * dy);
    }

    /// By pixels of its surface from one on.
    void improve(Pixel from, Candidate& held) const {
        for (int x = from.x; x < from.x + kLanes; ++x) {
            if (!(1.0f - off_centre(x, from.y) > held.score)) continue;
            const Candidate other = whole_pixel(x, from.y);
            if (other.score > held.score) replace(held, other);
        }
    }

    [[nodiscard]] Candidate whole_pixel(int x, int y) const {
        const PilotBlock& block = clusters_.block(x, y);
        const int i = x % kPilotPixels;
        const glm::vec3 normal(block.first_normal[0][i], block.first_normal[1][i],
                               block.first_normal[2][i]);
        const float beside = is_beside_other({x, y}, block.object[i]) ? kBeside : 0.0f;
        return {{x, y, 0}, block.object[i], normal, 1.0f, 1.0f - off_centre(x, y) - beside};
    }

    void consider(int x, int y, Candidates& out) const {
        const ClusterList* const list = clusters_.list(x, y);
        if (list == nullptr) {
            const PilotBlock& block = clusters_.block(x, y);
            const int i = x % kPilotPixels;
            const bool reflects = block.albedo[0][i] + block.albedo[1][i] + block.albedo[2][i] > 0;
            if (block.object[i] >= 0 && reflects) offer(whole_pixel(x, y), out);
            return;
        }
        float total = 0;
        for (int k = 0; k < list->count; ++k) total += list->clusters[k].count;
        for (int k = 0; k < list->count; ++k) {
            const Cluster& c = list->clusters[k];
            if (c.object < 0 || c.albedo[0] + c.albedo[1] + c.albedo[2] <= 0) continue;
            const glm::vec3 normal(c.first_normal[0], c.first_normal[1], c.first_normal[2]);
            offer({{x, y, c.first_sample},
                   c.object,
                   normal,
                   1.0f,
                   c.count / total - off_centre(x, y)},
                  out);
        }
    }

    [[nodiscard]] bool is_beside_other(Pixel at, std::int32_t object) const {
        // Of rows, those of the cell: more may not be there, in a band of them.
        const int top = std::max(top_, clusters_.rows().begin);
        const int bottom = std::min(top_ + cell_, clusters_.rows().end);
        const auto shows_other = [&](int x, int y) {
            if (x < 0 || x >= clusters_.width() || y < top || y >= bottom) return false;
            return clusters_.list(x, y) != nullptr ||
                   clusters_.block(x, y).object[x % kPilotPixels] != object;
        };
        return shows_other(at.x - 1, at.y) || shows_other(at.x + 1, at.y) ||
               shows_other(at.x, at.y - 1) || shows_other(at.x, at.y + 1);
    }

    void offer(const Candidate& candidate, Candidates& out) const {
        for (std::size_t i = first_; i < out.size(); ++i) {
            Candidate& held = out[i];
            const float cosine = glm::dot(held.normal, candidate.normal);
            if (held.object != candidate.object || cosine < kSameSurface) continue;
            held.least_cosine = std::min(held.least_cosine, cosine);
            if (candidate.score > held.score) replace(held, candidate);
            return;
        }
        if (out.size() - first_ < kMostRecords) out.push_back(candidate);
    }

    static void replace(Candidate& held, const Candidate& other) {
        const float least = held.least_cosine;
        held = other;
        held.least_cosine = least;
    }

    const PixelClusters& clusters_;
    int cell_;
    int left_ = 0, top_ = 0, right_ = 0;
    std::size_t first_ = 0;  ///< candidate of the cell
};

}  // namespace

Candidates place_records(const PixelClusters& clusters, RecordLevel& level, int threads) {
    const RowRange rows = level.rows();
    const auto count = static_cast<std::size_t>(rows.end - rows.begin);
    std::vector<Candidates> by_row(count);
    for_each_block(count, 1, threads, [&](BlockRange block) {
        Placement placement(clusters, level.cell());
        for (std::size_t r = block.begin; r < block.end; ++r) {
            const int row = rows.begin + static_cast<int>(r);
            for (int column = 0; column < level.columns(); ++column) {
                const std::size_t before = by_row[r].size();
                if (level.is_active(column, row)) placement.place(column, row, by_row[r]);
                level.first[level.index(column, row) + 1] =
                    static_cast<std::uint32_t>(by_row[r].size() - before);
            }
        }
    });
    for (std::size_t i = 1; i < level.first.size(); ++i) level.first[i] += level.first[i - 1];
    Candidates all;
    all.reserve(level.first.back());
    for (const Candidates& row : by_row) all.insert(all.end(), row.begin(), row.end());
    return all;
}

}  // namespace vecino
