// SPDX-License-Identifier: Apache-2.0
#include "filters/record_blocks.h"

#include <algorithm>
#include <cmath>

#include "core/clones.h"

namespace vecino {
namespace {

constexpr std::size_t kMostNear = 32;  ///< records that one point is blended from

/// A record near points, and which corner of the square of four cells its cell is.
struct NearRecord {
    const Record* record;
    int corner;
};

struct NearRecords {
    NearRecord list[kMostNear];
    std::size_t count = 0;
};

/// Where points are within the square between the middles of four cells.
struct Places {
    alignas(64) float across[kPilotPixels];
    float down;
};

struct Sums {
    alignas(64) float light[kRecordChannels][kPilotPixels];
    alignas(64) float weight[kPilotPixels];
};

VECINO_INLINE void add_fit(const Record& record, const PointBlock& points, const float* weight,
                           const float* u, const float* v, std::size_t channel, Sums& sums) {
    (void)points;
    const auto& f = record.fit[channel];
    const float least = record.least[channel], most = record.most[channel];
    float* const to = sums.light[channel];
    for (int i = 0; i < kPilotPixels; ++i) {
        const float value =
            f[0] + u[i] * (f[1] + u[i] * f[3] + v[i] * f[4]) + v[i] * (f[2] + v[i] * f[5]);
        const float above = value > least ? value : least;
        to[i] += weight[i] * (above < most ? above : most);
    }
}

VECINO_CLONES void add_records(const NearRecords& near, const PointBlock& points,
                               const Places& places, std::size_t channels, Sums& sums) {
    for (std::size_t n = 0; n < near.count; ++n) {
        const Record& r = *near.list[n].record;
        const bool right = near.list[n].corner % 2 != 0, below = near.list[n].corner / 2 != 0;
        const float of_row = below ? places.down : 1.0f - places.down;
        alignas(64) float weight[kPilotPixels], u[kPilotPixels], v[kPilotPixels];
        for (int i = 0; i < kPilotPixels; ++i) {
            const float x = points.position_world[0][i] - r.position_world.x;
            const float y = points.position_world[1][i] - r.position_world.y;
            const float z = points.position_world[2][i] - r.position_world.z;
            u[i] = x * r.u_axis.x + y * r.u_axis.y + z * r.u_axis.z;
            v[i] = x * r.v_axis.x + y * r.v_axis.y + z * r.v_axis.z;
            const float cosine = points.normal_world[0][i] * r.normal_world.x +
                                 points.normal_world[1][i] * r.normal_world.y +
                                 points.normal_world[2][i] * r.normal_world.z;
            const float c = cosine > 0.0f ? cosine : 0.0f;
            const float c4 = c * c * c * c;
            const float of_column = right ? places.across[i] : 1.0f - places.across[i];
            weight[i] = (of_column * of_row + 1e-4f) * c4 * c4;
            sums.weight[i] += weight[i];
        }
        for (std::size_t c = 0; c < channels; ++c) add_fit(r, points, weight, u, v, c, sums);
    }
}

class BlockBlender {
  public:
    BlockBlender(const RecordMap& map, const PointBlock& points, LightBlock& out)
        : map_(map), points_(points), out_(out) {}

    void run() {
        bool pending[kPilotPixels];
        for (int i = 0; i < kPilotPixels; ++i) {
            pending[i] = i < points_.count && points_.wanted[i];
            out_.found[i] = false;
        }
        for (int i = 0; i < points_.count; ++i) {
            if (pending[i]) blend_like(i, pending);
        }
    }

  private:
    /// Between the middles of four cells of a level.
    struct Square {
        std::size_t level;
        int column, row;
        friend bool operator==(const Square&, const Square&) = default;
    };

    [[nodiscard]] Square square_of(int i) const {
        const std::size_t level = finest_level(map_, points_.x + i, points_.y);
        const int cell = map_.levels[level].cell();
        // Twice the place from the first middle on, in half pixels, rounded down.
        const int across = 2 * (points_.x + i) + 1 - cell, down = 2 * points_.y + 1 - cell;
        const int side = 2 * cell;
        return {level, (across + side) / side - 1, (down + side) / side - 1};
    }

    /// Points in the same square and on the same object as point i.
    void blend_like(int i, bool (&pending)[kPilotPixels]) {
        const Square square = square_of(i);
        const std::int32_t object = points_.object[i];
        bool mine[kPilotPixels]{};
        for (int k = i; k < points_.count; ++k) {
            if (!pending[k] || points_.object[k] != object || !(square_of(k) == square)) continue;
            mine[k] = true;
            pending[k] = false;
        }
        NearRecords near;
        for (int k = 0; k < 4; ++k)
            find_cell({square.level, square.column + k % 2, square.row + k / 2}, object, k, near);
        Sums sums{};
        add_records(near, points_, places_in(square), map_.channels, sums);
        for (int k = i; k < points_.count; ++k) {
            if (!mine[k] || !(sums.weight[k] > 0)) continue;
            out_.found[k] = true;
            for (std::size_t c = 0; c < map_.channels; ++c)
                out_.light[c][k] = std::max(sums.light[c][k] / sums.weight[k], 0.0f);
        }
    }

    [[nodiscard]] Places places_in(const Square& square) const {
        const auto cell = static_cast<float>(map_.levels[square.level].cell());
        Places places;
        for (int i = 0; i < kPilotPixels; ++i) {
            places.across[i] = (static_cast<float>(points_.x + i) + 0.5f) / cell - 0.5f -
                               static_cast<float>(square.column);
        }
        places.down =
            (static_cast<float>(points_.y) + 0.5f) / cell - 0.5f - static_cast<float>(square.row);
        return places;
    }

    /// The records of an object in a cell or, where it is not active, in the one it is a part of.
    void find_cell(Square cell, std::int32_t object, int corner, NearRecords& near) const {
        for (;; --cell.level, cell.column /= 2, cell.row /= 2) {
            const RecordLevel& cells = map_.levels[cell.level];
            if (cell.column < 0 || cell.row < 0 || !cells.is_inside(cell.column, cell.row)) return;
            if (cells.is_active(cell.column, cell.row)) {
                for (const Record& record : cells.at(cell.column, cell.row)) {
                    if (record.object == object && near.count < kMostNear)
                        near.list[near.count++] = {&record, corner};
                }
                return;
            }
            if (cell.level == 0) return;
        }
    }

    const RecordMap& map_;
    const PointBlock& points_;
    LightBlock& out_;
};

}  // namespace

std::size_t finest_level(const RecordMap& map, int x, int y) {
    std::size_t level = 0;
    while (level + 1 < map.levels.size()) {
        const RecordLevel& next = map.levels[level + 1];
        const int column = x / next.cell(), row = y / next.cell();
        if (!next.is_inside(column, row) || !next.is_active(column, row)) break;
        ++level;
    }
    return level;
}

void record_light(const RecordMap& map, const PointBlock& points, LightBlock& out) {
    if (map.levels.empty()) {
        std::ranges::fill(out.found, false);
        return;
    }
    BlockBlender(map, points, out).run();
}

}  // namespace vecino
