// SPDX-License-Identifier: Apache-2.0
//
// Light between records: the fits of the four around a point, blended.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "filters/record_blocks.h"
#include "filters/records.h"

namespace vecino {
namespace {

class Blend {
  public:
    Blend(const RecordMap& map, const SurfacePoint& point) : map_(map), point_(point) {}

    bool run(RecordValue& light) {
        light = {};
        if (map_.levels.empty()) return false;
        const std::size_t level = finest_level(map_, point_.x, point_.y);
        if (!add_four(level) && !add_around()) return false;
        for (std::size_t c = 0; c < map_.channels; ++c)
            light[c] = std::max(sum_[c] / weight_, 0.0f);
        return true;
    }

  private:
    /// The four cells around the point's pixel.
    bool add_four(std::size_t level) {
        const float per_cell = 1.0f / static_cast<float>(map_.levels[level].cell());
        const float fx = (static_cast<float>(point_.x) + 0.5f) * per_cell - 0.5f;
        const float fy = (static_cast<float>(point_.y) + 0.5f) * per_cell - 0.5f;
        const int column = static_cast<int>(std::floor(fx)), row = static_cast<int>(std::floor(fy));
        const float u = fx - static_cast<float>(column), v = fy - static_cast<float>(row);
        for (int k = 0; k < 4; ++k) {
            const float weight = (k % 2 != 0 ? u : 1.0f - u) * (k / 2 != 0 ? v : 1.0f - v);
            add_cell(level, column + k % 2, row + k / 2, weight + 1e-4f);
        }
        return weight_ > 0;
    }

    /// For surfaces that the first samples missed: any record of theirs in the nine cells around.
    bool add_around() {
        const RecordLevel& level = map_.levels[0];
        const int column = point_.x / level.cell(), row = point_.y / level.cell();
        for (int k = 0; k < 9; ++k) add_cell(0, column + k % 3 - 1, row + k / 3 - 1, 1.0f);
        return weight_ > 0;
    }

    void add_cell(std::size_t level, int column, int row, float weight) {
        for (;; --level, column /= 2, row /= 2) {
            const RecordLevel& cells = map_.levels[level];
            if (column < 0 || row < 0 || !cells.is_inside(column, row)) return;
            if (cells.is_active(column, row)) {
                for (const Record& record : cells.at(column, row)) add_record(record, weight);
                return;
            }
            if (level == 0) return;
        }
    }

    void add_record(const Record& record, float weight) {
        if (record.object != point_.object) return;
        weight *= agreement(glm::dot(record.normal_world, point_.normal_world));
        if (!(weight > 0)) return;
        const glm::vec3 off = point_.position_world - record.position_world;
        const float u = glm::dot(off, record.u_axis), v = glm::dot(off, record.v_axis);
        for (std::size_t c = 0; c < map_.channels; ++c) {
            const auto& f = record.fit[c];
            const float value = f[0] + u * (f[1] + u * f[3] + v * f[4]) + v * (f[2] + v * f[5]);
            sum_[c] += weight * std::min(std::max(value, record.least[c]), record.most[c]);
        }
        weight_ += weight;
    }

    const RecordMap& map_;
    const SurfacePoint& point_;
    RecordValue sum_{};
    float weight_ = 0;
};

}  // namespace

bool record_light(const RecordMap& map, const SurfacePoint& point, RecordValue& light) {
    return Blend(map, point).run(light);
}

bool is_near_record(const RecordMap& map, const SurfacePoint& point) {
    if (map.levels.empty()) return false;
    const RecordLevel& level = map.levels[finest_level(map, point.x, point.y)];
    for (const Record& record : level.at(point.x / level.cell(), point.y / level.cell())) {
        if (record.object == point.object && glm::dot(record.normal_world, point.normal_world) > 0)
            return true;
    }
    RecordValue light;
    return record_light(map, point, light);
}

void rough_light(const RecordMap& map, const SurfacePoint& point, RecordValue& light) {
    constexpr float kSameSide = 0.7f;  // cosine between normals
    light = {};
    if (map.levels.empty()) return;
    const RecordLevel& level = map.levels[finest_level(map, point.x, point.y)];
    int count = 0;
    for (const Record& record : level.at(point.x / level.cell(), point.y / level.cell())) {
        if (record.object != point.object) continue;
        if (glm::dot(record.normal_world, point.normal_world) < kSameSide) continue;
        for (std::size_t c = 0; c < map.channels; ++c) light[c] += record.light[c];
        ++count;
    }
    for (float& value : light) value /= static_cast<float>(std::max(count, 1));
    if (count == 0) record_light(map, point, light);
}

}  // namespace vecino
