// SPDX-License-Identifier: Apache-2.0
//
// What the tracing kernels read: a scene flattened into plain arrays. The kernels are compiled once
// per packet width with different instruction sets, so this header holds plain data only: an inline
// function shared between those translation units could be linked in its widest form and crash on a
// smaller machine.
#pragma once

#include <cstdint>

namespace vecino {

class EmbreeScene;
class PacketLog;
struct RecordKernel;  // record_task.h

/// What shading knows of a surface: a planar quad, a triangle or a sphere.
enum SurfaceField {
    kShape = 0,     ///< flat: unit normal n and dot(n, p0); sphere: centre and radius
    kAlbedo = 4,    ///< 3 numbers
    kOffset = 7,    ///< by which rays leave the surface, so that they do not hit it again
    kEmission = 8,  ///< 3 numbers: radiance
    kLight = 11,    ///< the bits of its number among the emitters, or of -1
    kMirror = 12,   ///< the bits of -1 where it is one, else of 0
    kTexture = 13,  ///< the bits of its number among the placed textures, or of -1
    kSurfaceFields = 14
};

/// A table with a row per field and a column per surface: quads, triangles, spheres. Rows are
/// padded, so that the first 32 columns can always be read.
struct SurfaceTable {
    const float* fields;
    std::uint32_t stride;
    std::uint32_t count;
    const std::int32_t* object_id;  ///< by surface
};

enum class LightKind : std::int32_t { parallelogram, rectangle, triangle, sphere };

/// An emitter, as next-event estimation sees it. Numbers only: kernels gather them by their places.
struct LightRecord {
    float origin[3];  ///< a corner, or the sphere's centre
    float edge1[3];
    float edge2[3];
    float normal[3];  ///< unit; the side that emits
    float radiance[3];
    float area;
    float radius;
    float offset_world;
    float inverse_length[2];  ///< of the edges
    LightKind kind;
    // Chosen by power alone:
    float selection_probability;
    float selection_cdf;  ///< sum of the probabilities up to and including this light
    // Chosen by contribution:
    std::uint32_t trail;  ///< its way down the tree: bit k says which child to take at depth k
};

/// What a node of the tree over emitters knows of those below it.
enum LightNodeField {
    kLightNodeCenter = 0,   ///< 3 numbers: of the sphere around them
    kLightNodeRadius2 = 3,  ///< its squared radius
    kLightNodeAxis = 4,     ///< 3 numbers: of the cone that holds their normals
    kLightNodeCosine = 7,   ///< of the angle between the cone's axis and its side
    kLightNodeSine = 8,
    kLightNodePower = 9,  ///< emitted along the normal: luminance times area
    kLightNodeNext = 10,  ///< bits of the second child's number (the first is the next node), or,
                          ///< of one emitter's node, of the complement of its number
    kLightNodeFields = 11
};

/// A table with a row per field and a column per node, the root first. Padded like SurfaceTable.
struct LightTree {
    const float* fields;
    std::uint32_t stride;
    std::uint32_t count;
};

/// Shading normals at the corners of a triangle.
struct VertexNormals {
    float corner[3][3];
};

/// A texture's image as it lies on a flat surface: uv is a linear function of the position.
struct PlacedTexture {
    const float* texels;  ///< linear RGB, row by row, the top row first
    std::int32_t width, height;
    float origin[3];       ///< a corner of the surface
    float gradient[2][3];  ///< of u and of v
    float at_origin[2];    ///< u and v there
};

struct TraceTask {
    const EmbreeScene* embree;
    SurfaceTable surfaces;
    const VertexNormals* vertex_normals;  ///< one per triangle, or null when no mesh has normals
    const PlacedTexture* textures;        ///< or null when no surface has one
    bool has_mirrors;
    const LightRecord* lights;
    std::uint32_t light_count;
    LightTree light_tree;
    std::uint32_t first_triangle, first_sphere;  ///< of the surfaces
    bool has_triangles, has_spheres;

    float background[3];
    bool has_background;

    // The ray through uv is camera_origin + t (forward + (2u - 1) right + (1 - 2v) up).
    float camera_origin[3];
    float camera_forward[3];
    float camera_right[3];
    float camera_up[3];
    std::int32_t width, height;

    std::int32_t max_depth;
    bool next_event_estimation;
    bool by_contribution;  ///< emitters are chosen through the tree, else by their power
    bool by_solid_angle;   ///< points on rectangles are uniform over it, else over their area
    bool control_variate;  ///< of rectangles: exact light less what is hidden
    /// Light that bounces find by chance is weighed in, of emitters whose points are uniform over
    /// their area: triangles and parallelograms; rectangles too, where neither of the above is on.
    /// At a path's last surface, whose bounce is traced for this alone, only near emitters.
    bool multiple_importance;
    bool sobol;
    bool shares_samples;  ///< all pixels have the random numbers of the first one
    /// 1, or kStreams: Sobol samples are dealt to that many independent scramblings, sample i to i
    /// % streams. Their spread is the only sound estimate of the variance, at the price of about 2
    /// dB: each stratifies a quarter.
    std::uint32_t streams;
    std::uint32_t seed;

    PacketLog* packet_log;  ///< null in renders; a benchmark keeps every packet here
};

constexpr int kBlockSamples = 64;  ///< samples summed together; see accumulate.h
constexpr int kStreams = 4;        ///< independent scramblings behind the variance of Sobol samples

/// Radiance of up to 64 samples of one pixel, split by bounces. Unused samples are 0.
struct SampleBlock {
    alignas(64) float emission[3][kBlockSamples];
    alignas(64) float direct[3][kBlockSamples];
    alignas(64) float indirect[3][kBlockSamples];
};

struct FirstHitRecord {
    float position_world[3];
    float normal_world[3];
    float albedo[3];
    float emission[3];  ///< written by trace_centres alone; the background of a miss
    float distance_world;
    std::int32_t object_id;
};

/// Samples [first_sample, first_sample + count) of one pixel; count <= kBlockSamples.
struct SampleRange {
    std::int32_t x, y;
    std::uint32_t first_sample;
    std::int32_t count;
};

/// Sums over samples of what their primary rays hit; a miss adds zeros.
struct GuideSums {
    float albedo[3];
    float normal_world[3];  ///< shading normals, facing the camera
};

/// What is kept of the primary rays of a range of samples; null: nothing.
struct PrimaryHits {
    FirstHitRecord* first;  ///< of the range's first sample
    GuideSums* sums;        ///< which it is added to
};

/// A tracer for one packet width.
struct TraceKernel {
    int width;
    /// Fills block, and what is kept of primary rays. Returns rays traced.
    std::uint64_t (*trace_samples)(const TraceTask&, const SampleRange&, SampleBlock&,
                                   const PrimaryHits&);
    /// The first hits of rays through the centres of pixels (x .. x + count - 1, y); count <=
    /// kBlockSamples.
    std::uint64_t (*trace_centres)(const TraceTask&, const SampleRange&, FirstHitRecord*);
    const RecordKernel* records;  ///< of the method surface_records
};

/// The kernel for a width, or null if this build or this machine lacks it.
const TraceKernel* find_trace_kernel(int width);

}  // namespace vecino
