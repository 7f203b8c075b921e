// SPDX-License-Identifier: Apache-2.0
//
// The stages of the method surface_records, for those who want to know what each takes.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "filters/pixel_clusters.h"
#include "filters/surface_records.h"

namespace vecino {

class Pace;

constexpr double kPathWork = 3;  ///< of a whole path of a pixel, held against a sample of it

/// With so many samples or more a needy pixel gets packets of its own, as wide as they may be. With
/// fewer, pixels share packets.
constexpr int kOwnPacketSpp = 16;

// What a stage of surface_records costs before its first sample, in samples: measured at 512x512,
// and scene by scene much the same.
constexpr double kPilotStart = 3.5, kEdgeStart = 25, kRecordStart = 6;

/// What further samples of a needy pixel take, where there were so many first ones: in samples of
/// many.
constexpr double further_work(std::uint32_t samples, std::uint32_t first) {
    constexpr double kFewStart = 4;
    return samples - first + (samples < kOwnPacketSpp ? kFewStart : kEdgeStart);
}

/// What half-shadow takes to smooth, in samples of a needy pixel.
constexpr double kSmoothingWork = 2.5;

/// Seconds by stage.
struct StageTimes {
    double trials_s = 0;   ///< of a Pace
    double pilot_s = 0;    ///< first samples of all pixels
    double records_s = 0;  ///< light of records
    double fit_s = 0;      ///< polynomials around records
    double needs_s = 0;    ///< which pixels want more samples
    double samples_s = 0;  ///< those samples
    double resolve_s = 0;  ///< from clusters and records to pixels
};

/// What needy pixels and records there were.
struct StageCounts {
    std::uint64_t needy_pixels = 0;
    std::uint64_t records = 0;
    int bands = 0;
    int band_rows = 0;
};

/// Large frames are made in bands of rows.
struct BandRows {
    RowRange made;
    RowRange sampled;  ///< those, and around them what their records are fitted to
};

struct StagedRender {
    Render render;
    StageTimes times;
    StageCounts counts;
    SurfaceRecordsPlan plan;  ///< as it came to be
    /// Mean square in sRGB; of a frame of one band that a pace chose the plan for.
    std::optional<double> expected_error = std::nullopt;
};

/// How a frame is made: by a plan, or by one that a pace chooses in the course of it.
struct StagedRun {
    SurfaceRecordsPlan plan;
    Pace* pace = nullptr;
};

StagedRender render_in_stages(const Scene& scene, const RenderSettings& settings,
                              const StagedRun& run, const Progress& progress);

}  // namespace vecino
