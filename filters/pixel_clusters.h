// SPDX-License-Identifier: Apache-2.0
//
// What the samples of an image's rows saw: one cluster per surface and pixel. Most pixels see one
// surface and take their place in blocks of planes; others have a list.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "core/frame_planes.h"
#include "core/grid.h"
#include "core/record_task.h"

namespace vecino {

/// What all stages trace with.
struct RecordTracer {
    const TraceTask& task;
    const RecordKernel& kernel;
    int threads;
};

/// Rows [begin, end) of an image.
struct RowRange {
    int begin = 0;
    int end = 0;
};

/// Whether each sample picks an emitter: there are too many to look at one by one.
inline bool picks_lights(const TraceTask& task) {
    return task.light_count > static_cast<std::uint32_t>(kMostExactLights);
}

/// Of those, whether what is picked is hidden light, taken off the exact unshadowed one.
inline bool sums_lights(const TraceTask& task) {
    return picks_lights(task) && task.light_count <= static_cast<std::uint32_t>(kMostSummedLights);
}

class PixelClusters {
  public:
    /// Room for so many rows of a scene with so many emitters; none yet.
    PixelClusters(int width, int most_rows, int lights);

    /// Forgets what there was and begins with other rows, at most as many as there is room for.
    void begin(RowRange rows);

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] RowRange rows() const { return rows_; }

    /// The first samples of a pixel's first surface. Precondition of all that take x and y: 0 <= x
    /// < width and y in rows.
    [[nodiscard]] const PilotBlock& block(int x, int y) const { return blocks_[block_index(x, y)]; }
    /// What goes with the block.
    [[nodiscard]] const PilotLight* lights(int x, int y) const {
        return lights_.get() + block_index(x, y) * light_planes_;
    }

    /// Null for a pixel whose samples all hit one surface and that has asked for no list.
    [[nodiscard]] const ClusterList* list(int x, int y) const {
        const std::int32_t index = *list_numbers(x, y);
        return index < 0 ? nullptr : &lists_[row(y)][static_cast<std::size_t>(index)];
    }
    /// Of the pixels of a row from one on: negative for those that have none.
    [[nodiscard]] const std::int32_t* list_numbers(int x, int y) const {
        return &list_index_[pixel_index(x, y)];
    }
    /// What all samples of a pixel saw.
    [[nodiscard]] ClusterList clusters(int x, int y) const;
    /// Gives a pixel its clusters. Threads may do so in different rows.
    void store(int x, int y, const ClusterList& list);
    /// The first surface of a pixel.
    [[nodiscard]] Cluster first_cluster(int x, int y) const;
    /// Changes what is known of it; surface, first sample and first normal stay.
    void store_first(int x, int y, const Cluster& cluster);

    /// Changes a sum of it: what is in sight of an emitter; or, where each sample picks one, light.
    void store_seen(int x, int y, int light, float seen) {
        light_at(x, y, static_cast<std::size_t>(light)).seen[x % kPilotPixels] = seen;
    }
    void store_picked(int x, int y, const float (&rgb)[3]) {
        PilotLight& light = light_at(x, y, 0);
        light.exact[x % kPilotPixels] = rgb[0];
        light.open[x % kPilotPixels] = rgb[1];
        light.seen[x % kPilotPixels] = rgb[2];
    }

    /// Calls visit(cluster) for each of a pixel's surfaces.
    template <class Visit>
    void visit(int x, int y, const Visit& visit) const {
        const ClusterList* const found = list(x, y);
        if (found == nullptr) return visit(first_cluster(x, y));
        for (int k = 0; k < found->count; ++k) visit(found->clusters[k]);
    }

    /// Traces the first samples of the pixels of a row; their first hits too, unless that is null.
    /// Returns rays. Threads may do so in different rows.
    std::uint64_t trace_row(const RecordTracer& tracer, int y, int samples,
                            FirstHitRecord* first_hits);

    /// Traces first samples of kPilotPixels pixels from (x, y) on, to see how long it takes.
    void try_samples(const RecordTracer& tracer, Pixel at, int samples) const;

  private:
    [[nodiscard]] std::size_t row(int y) const { return static_cast<std::size_t>(y - rows_.begin); }
    [[nodiscard]] std::size_t block_index(int x, int y) const {
        return row(y) * blocks_per_row_ + static_cast<std::size_t>(x / kPilotPixels);
    }
    [[nodiscard]] std::size_t pixel_index(int x, int y) const {
        return row(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
    }
    PilotLight& light_at(int x, int y, std::size_t light) {
        return lights_[block_index(x, y) * light_planes_ + light];
    }
    void take_spill(const PilotSpill& spill, int x, int y);
    ClusterList& make_list(int x, int y);

    int width_;
    RowRange rows_;
    std::size_t blocks_per_row_;
    bool picks_;                ///< whether each sample picks an emitter
    std::size_t light_planes_;  ///< PilotLight of a block
    std::unique_ptr<PilotBlock[]> blocks_;
    std::unique_ptr<PilotLight[]> lights_;
    std::vector<std::int32_t> list_index_;         ///< by pixel, into its row's lists; -1: none
    std::vector<std::vector<ClusterList>> lists_;  ///< by row
};

/// Means over the samples of a cluster.
struct ClusterMeans {
    glm::vec3 position, normal, albedo, emission;
};
ClusterMeans means_of(const Cluster& cluster);

/// Light over pi straight from emitters: exact light times the share of it in sight.
glm::vec3 direct_light(const TraceTask& task, const Cluster& cluster);

/// The share of the light of an emitter that is in sight; 1 where no sample could tell.
float share_in_sight(const LightSums& sums);

}  // namespace vecino
