// SPDX-License-Identifier: Apache-2.0
//
// Records: places on surfaces where the light that comes by way of others is known well. One for
// each surface in each cell of pixels; where light changes fast, cells are halved.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "filters/pixel_clusters.h"
#include "filters/surface_records.h"

namespace vecino {

/// Indirect light in red, green, blue, then the background's in the same.
constexpr std::size_t kRecordChannels = 6;
using RecordValue = std::array<float, kRecordChannels>;

/// 1, u, v, u^2, u v, v^2
constexpr std::size_t kFitTerms = 6;

struct Record {
    std::int32_t object;
    glm::vec3 position_world, normal_world;
    float x, y;                ///< where the image shows it, pixels
    float footprint_world;     ///< side of its cell, held against the view
    float grazing_cosine;      ///< between view and normal, at least 0.15
    float nearness;            ///< mean of one over the distance to what is around it
    float least_cosine;        ///< between its normal and others of its surface in the cell
    RecordValue light;         ///< over pi
    glm::vec3 u_axis, v_axis;  ///< tangents; times (position - position_world) they give u and v
    std::array<std::array<float, kFitTerms>, kRecordChannels> fit;
    RecordValue least, most;  ///< that the fit may say
};

/// Cells of one size. Those that are not active have no records.
class RecordLevel {
  public:
    /// rows: of pixels, a multiple of the cell's side or up to the end of the image.
    RecordLevel(int cell, int width, RowRange rows);

    [[nodiscard]] int cell() const { return cell_; }
    [[nodiscard]] int columns() const { return columns_; }
    /// Of all cell rows of the image, those that there are.
    [[nodiscard]] RowRange rows() const { return rows_; }
    [[nodiscard]] std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row - rows_.begin) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(column);
    }
    [[nodiscard]] bool is_inside(int column, int row) const {
        return column >= 0 && column < columns_ && row >= rows_.begin && row < rows_.end;
    }
    [[nodiscard]] std::span<const Record> at(int column, int row) const {
        const std::size_t i = index(column, row);
        return {records.data() + first[i], first[i + 1] - first[i]};
    }
    [[nodiscard]] bool is_active(int column, int row) const {
        return active[index(column, row)] != 0;
    }

    std::vector<std::uint8_t> active;  ///< by cell
    std::vector<std::uint32_t> first;  ///< by cell, of its records; one more at the end
    std::vector<Record> records;

  private:
    int cell_;
    int columns_;
    RowRange rows_;
};

/// Records of the rows of an image, coarsest level first.
struct RecordMap {
    std::vector<RecordLevel> levels;
    std::size_t channels = 3;  ///< 3 without a background, else kRecordChannels
};

struct RecordWork {
    RecordMap map;
    std::uint64_t rays = 0;
    std::uint64_t paths = 0;
    std::uint64_t dropped = 0;
};

/// What records are made of.
struct RecordInputs {
    const RecordTracer& tracer;
    const PixelClusters& clusters;
};

/// What is known of the records of a level before their light is gathered.
struct RecordCount {
    int level;
    std::size_t records;
    double path_s;  ///< of all threads together, by paths + kRecordStart: measured on some of them
};
using CountRecords = std::function<void(const RecordCount&)>;

/// Places records for all surfaces that clusters show and gathers their light. count, if there is
/// one, is called for each level and may change the paths of the plan.
RecordWork gather_records(const RecordInputs& inputs, const SurfaceRecordsPlan& plan,
                          const CountRecords& count);

/// How many records there would be, of cells of one size.
std::size_t count_records(const RecordInputs& inputs, int cell);

/// Records of a few cells, to see how long they take.
struct RecordTrial {
    double records_at_16 = 0;   ///< of all cells, were their sides 16 pixels; extrapolated
    double path_s = 0;          ///< of one thread, by paths + kRecordStart
    std::vector<double> noise;  ///< by record: square in sRGB of what its noise adds to pixels
    int paths = 0;              ///< of each
    glm::vec3 light{0.0f};      ///< that reaches them, over pi: their mean
    double surfaces = 0;        ///< of a cell that has any
};
RecordTrial try_records(const RecordInputs& inputs, int number);

/// Where a record is: what a sample of a pixel hits.
struct RecordSeed {
    int x, y;
    std::uint32_t sample;
};

/// How much light of a record says of a point whose normal is turned from its own: the cosine's
/// eighth power, 0 behind. At 30 degrees a third.
inline float agreement(float cosine) {
    const float c2 = cosine * cosine;
    const float c4 = c2 * c2;
    return cosine > 0 ? c4 * c4 : 0.0f;
}

/// Fits light around each record to second order, to records of the same surface nearby.
void fit_records(RecordMap& map, const SurfaceRecordsPlan& plan, int threads);

/// Where light is asked for.
struct SurfacePoint {
    int x, y;  ///< pixel
    std::int32_t object;
    glm::vec3 position_world, normal_world;
};

/// Light over pi at a point of a surface, blended from the fits around it. False, and zeros, where
/// no record is near.
bool record_light(const RecordMap& map, const SurfacePoint& point, RecordValue& light);

/// Whether a record is near.
bool is_near_record(const RecordMap& map, const SurfacePoint& point);

/// Light in a fraction of the time, as good as to say how much light there is about: the mean of
/// the records of the point's own cell. Where it has none, as record_light().
void rough_light(const RecordMap& map, const SurfacePoint& point, RecordValue& light);

}  // namespace vecino
