// SPDX-License-Identifier: Apache-2.0
//
// What pixels that lie on one surface alone saw of a light, in planes for smoothing it.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "core/parallel.h"
#include "filters/pixel_needs.h"

namespace vecino {

constexpr int kFieldReach = 3;        ///< of the largest window, in pixels to each side
constexpr int kFieldChannels = 3;     ///< of light by picked emitters; else the first alone
constexpr int kNoField = -2;          ///< object of a pixel that has no value
constexpr float kSameSurface = 0.9f;  ///< cosine between normals

/// A row of them, with room around it.
struct FieldRow {
    std::vector<std::int32_t> object;
    std::vector<float> normal[3];
    std::vector<float> value;                    ///< that decides what is noise
    std::vector<float> channel[kFieldChannels];  ///< what is smoothed

    void resize(std::size_t size);
};

/// Of pixel x >= -kFieldReach in a FieldRow.
inline std::size_t field_index(int x) {
    return static_cast<std::size_t>(x) + std::size_t{kFieldReach};
}

/// What is put into the place of what a pixel saw.
struct Smoothed {
    int x;
    float channel[kFieldChannels];
};
using SmoothedRows = std::vector<std::vector<Smoothed>>;

/// A light, or all of them where each sample picks one.
class LightField {
  public:
    LightField(const PixelClusters& clusters, int light, bool picks)
        : clusters_(clusters), light_(light), picks_(picks) {}

    /// Values are shares in sight, from 0 to 1, or light over pi, hidden or seen,
    /// where emitters are picked.
    [[nodiscard]] bool picks() const { return picks_; }

    /// Row y; without values unless it is one of rows.
    void read(int y, RowRange rows, FieldRow& row) const;

    /// clusters: those that were read.
    void store(int y, const Smoothed& pixel, PixelClusters& clusters) const;

  private:
    void read_block(int x, int y, FieldRow& row) const;

    const PixelClusters& clusters_;
    int light_;
    bool picks_;
};

/// Needy pixels of rows, by row.
struct FieldPixels {
    RowRange rows;
    std::vector<std::vector<int>> x;
};

/// Those in half-shadow with so many samples at most. needy: of rows.
FieldPixels shadow_pixels(RowRange rows, const NeedyRows& needy,
                          int most_samples = std::numeric_limits<int>::max());

/// Rows around one that goes down: each is read once, or never.
template <class Row>
class RowWindow {
  public:
    RowWindow(int above, int below)
        : above_(above), below_(below), rows_(static_cast<std::size_t>(above + below + 1)) {}

    /// Reads what is missing of the rows around y, top down, by read(y, row). Precondition: y has
    /// not been farther down.
    template <class Read>
    void go_to(int y, const Read& read) {
        for (int k = std::max(next_, y - above_); k <= y + below_; ++k) read(k, (*this)[k]);
        next_ = y + below_ + 1;
    }

    /// One of those, by its y.
    Row& operator[](int y) {
        const int size = static_cast<int>(rows_.size());
        return rows_[static_cast<std::size_t>((y % size + size) % size)];
    }

  private:
    int above_, below_;
    int next_ = std::numeric_limits<int>::min();  ///< to be read
    std::vector<Row> rows_;                       ///< around and around
};

/// Goes down rows of pixels, in blocks side by side. make() returns what does so: its
/// next(y, pixels) says what becomes of a row's, of rows that have any.
template <class Make>
SmoothedRows go_down_rows(const FieldPixels& pixels, int threads, const Make& make) {
    constexpr std::size_t kRowsPerBlock = 32;
    SmoothedRows out(pixels.x.size());
    for_each_block(out.size(), kRowsPerBlock, threads, [&](BlockRange block) {
        auto rows = make();
        for (std::size_t r = block.begin; r < block.end; ++r) {
            if (pixels.x[r].empty()) continue;
            out[r] = rows.next(pixels.rows.begin + static_cast<int>(r), pixels.x[r]);
        }
    });
    return out;
}

/// What becomes of the pixels of a light; may read clusters, and changes nothing.
using FieldSmoother = std::function<SmoothedRows(const LightField&, const FieldPixels&)>;

/// Smooths light by light.
void smooth_lights(const RecordTracer& tracer, const FieldPixels& pixels,
                   const FieldSmoother& smooth, PixelClusters& clusters);

}  // namespace vecino
