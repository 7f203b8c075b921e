// SPDX-License-Identifier: Apache-2.0
//
// What the kernels behind the method surface_records read and write: what the samples of a pixel
// saw, surface by surface, and the light that arrives at a surface by way of others. Plain data
// only, for the reason given in trace_task.h.
#pragma once

#include <cstdint>

#include "core/trace_task.h"

namespace vecino {

/// Up to so many emitters are looked at one by one, each with its exact irradiance and a shadow ray
/// of its own; with more, each sample picks one of them.
constexpr int kMostExactLights = 4;
/// Up to so many, samples add up what would come from all of them were nothing in between, exactly,
/// and only what is hidden of it is found by picking; with more, all is found so.
constexpr int kMostSummedLights = 32;

/// Surfaces told apart in one pixel.
constexpr int kMostClusters = 4;

/// Pixels whose first samples are traced side by side, in one row of the image.
constexpr int kPilotPixels = 16;

/// Surfaces other than the first that a row of pilot pixels may find.
constexpr int kMostSpills = 64;

/// The light of one emitter on a surface, over pi and per unit of its radiance, summed over
/// samples: exact where nothing hides it, and by points on it (all, and those in sight). Exact
/// times seen / open has no noise where all or nothing is in sight.
struct LightSums {
    float exact;
    float open;
    float seen;
};

/// Sums over the samples of one pixel that hit the same side of one surface.
struct Cluster {
    /// Stands for the object, and for the mirrors that it is seen through; negative: a miss.
    std::int32_t object;
    std::int32_t mirrors;                ///< so many mirrors lie between
    std::int32_t surface;                ///< of the first sample, in the table of surfaces
    std::uint32_t first_sample;          ///< the first sample that hit it
    float first_normal[3];               ///< what other samples' shading normals are held against
    float count;                         ///< samples
    float shadow_count;                  ///< samples whose light was looked at
    float position[3];                   ///< world
    float normal[3];                     ///< of shading, unit before they were summed
    float albedo[3];                     ///< times that of the mirrors
    float emission[3];                   ///< radiance sent to the camera
    LightSums lights[kMostExactLights];  ///< by emitter, unless each sample picks one; then:
    float unshadowed[3];                 ///< light over pi of all, as if nothing were in between
    float picked[3];                     ///< light over pi: what is hidden of it, or what is seen
    float picked_square;                 ///< of its luminance
};

/// What the samples of a pixel hit.
struct ClusterList {
    std::int32_t count;
    bool crowded;  ///< there were more surfaces than clusters: what is here is not all
    Cluster clusters[kMostClusters];
};

/// Sums over what the first samples of kPilotPixels pixels hit, each pixel's first surface only.
struct PilotBlock {
    alignas(64) std::int32_t object[kPilotPixels];
    std::int32_t surface[kPilotPixels];
    std::int32_t mirrors[kPilotPixels];
    float count[kPilotPixels];
    float shadow_count[kPilotPixels];
    float first_normal[3][kPilotPixels];
    float position[3][kPilotPixels];
    float normal[3][kPilotPixels];
    float albedo[3][kPilotPixels];
    float emission[3][kPilotPixels];
};

/// What goes with a PilotBlock: one for each emitter that is looked at on its own. Where each
/// sample picks one, the first holds the light over pi in red, green and blue, the second as
/// `exact` the square of its luminance, and the third the unshadowed light as the first does.
struct PilotLight {
    alignas(64) float exact[kPilotPixels];
    float open[kPilotPixels];
    float seen[kPilotPixels];
};

/// Further surfaces of pilot pixels.
struct PilotSpill {
    std::int32_t pixel[kMostSpills];  ///< in the block
    bool crowded[kPilotPixels];       ///< as of a ClusterList
    Cluster clusters[kMostSpills];
    std::int32_t count;
};

/// The first samples of pixels (x .. x + count - 1, y).
struct PilotRange {
    std::int32_t x, y;
    std::int32_t count;    ///< pixels, 1 to kPilotPixels
    std::int32_t samples;  ///< of each pixel, >= 1
};

/// Samples [begin, end) of one pixel.
struct PixelSamples {
    std::int32_t x, y;
    std::uint32_t begin, end;
    /// The surface that all of them hit, if it is known beforehand; else -1.
    std::int32_t known_surface;
    /// Whether light is looked at by all; else by those whose cluster is not clear about it.
    bool half_shadow;
};

/// Samples [begin, end) of pixels that are traced side by side.
struct FewSamples {
    std::int32_t count;  ///< pixels, 1 to kPilotPixels
    std::int32_t x[kPilotPixels];
    std::int32_t y[kPilotPixels];
    std::uint32_t begin;
    std::uint32_t end[kPilotPixels];
};

/// Paths from the surface that a sample of a pixel hits.
struct RecordRange {
    std::int32_t x, y;
    std::uint32_t sample;
    std::uint32_t paths;
};

/// Light over pi that arrives at a surface otherwise than straight from an emitter: means over
/// paths.
struct RecordLight {
    bool hit;             ///< false: the sample hit nothing, and the rest is 0
    std::int32_t object;  ///< as in a cluster
    float distance;       ///< from the camera, by way of mirrors
    float cosine;         ///< between the ray that hit it and its normal
    float position[3];
    float normal[3];         ///< of shading
    float background[3];     ///< straight from the background
    float indirect[3];       ///< by way of other surfaces
    float inverse_distance;  ///< mean of one over the distance to what the paths hit first
    std::uint32_t dropped;   ///< paths whose light was not finite; they enter no mean
};

/// Where first samples go.
struct PilotOutput {
    PilotBlock& block;
    PilotLight* lights;
    PilotSpill& spill;
    FirstHitRecord* first_hits;  ///< of the first sample of each pixel, or null
};

/// Kernels of one packet width. All return the number of rays traced.
struct RecordKernel {
    std::uint64_t (*trace_pilot)(const TraceTask&, const PilotRange&, const PilotOutput&);
    /// Adds samples to what is known of a pixel.
    std::uint64_t (*add_samples)(const TraceTask&, const PixelSamples&, ClusterList&);
    /// The same for pixels with fewer samples than a packet has room for. lists: by pixel, none of
    /// them empty.
    std::uint64_t (*add_few)(const TraceTask&, const FewSamples&, ClusterList* lists);
    std::uint64_t (*gather)(const TraceTask&, const RecordRange&, RecordLight&);
};

}  // namespace vecino
