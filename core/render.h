// SPDX-License-Identifier: Apache-2.0

/// @file
/// Path tracing: from a scene to a frame. The result depends on the scene and the settings, never
/// on the number of threads or the order in which pixels are traced.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>

#include "core/frame.h"
#include "core/planes.h"
#include "core/scene.h"

/// All of the library: load_scene(), render(), reconstruct(), save_image(), and what they work on.
namespace vecino {

/// How a path finds light.
enum class LightSampling {
    none,  ///< a path finds a light only by chance (the thesis's path tracing)
    nee,   ///< next-event estimation: one shadow ray per surface
};

/// How next-event estimation picks points on a rectangular emitter. Spheres are sampled by the cone
/// they fill, all else by area.
enum class LightPoint {
    area,         ///< uniform over the surface
    solid_angle,  ///< uniform over the solid angle (Urena et al. 2013)
};

/// How next-event estimation chooses among emitters.
enum class LightChoice {
    power,         ///< in proportion to emitted power, wherever the surface is
    contribution,  ///< to a bound of what reaches the surface (Conty Estevez and Kulla 2018)
};

/// Whether light that a bounce finds by chance counts beside next-event estimation. It does so
/// close to emitters whose points are uniform over their area; at a path's last surface, whose
/// bounce is traced for this alone, only where that is close to all of the scene's emitters.
enum class MultipleImportance {
    none,     ///< next-event estimation stands for all light of emitters
    balance,  ///< both count, weighed by the balance heuristic (Veach and Guibas 1995)
};

/// What next-event estimation knows of a rectangular emitter beside one point on it.
enum class ControlVariate {
    none,
    irradiance,  ///< exact irradiance, less what of it is hidden: no noise where all is in sight
};

/// Where the random numbers of a path come from.
enum class Sampler {
    independent,  ///< hashes: pcg4d (Jarzynski and Olano, JCGT 2020)
    sobol,        ///< Owen-scrambled Sobol points (Burley, JCGT 2020)
};

/// Which ray of a pixel the planes of the first hit come from.
enum class FirstHit {
    first_sample,  ///< of the pixel's first, jittered, sample (the thesis's)
    centre,        ///< along the ray through the pixel centre
};

/// What decides a render beside its scene. The number of threads does not change a bit of it;
/// another simd_width may, by rounding.
struct RenderSettings {
    Extent size{512, 512};  ///< full resolution, sides 1 to 65536; fixes the camera's aspect ratio
    int reduction = 1;      ///< >= 1: the traced frame is reduced(size, reduction)
    int spp = 64;           ///< samples (paths) per traced pixel, >= 1
    int max_depth = 2;      ///< surface bounces that may carry light, 0 to 1000
    LightSampling light_sampling = LightSampling::nee;            ///< how a path finds light
    LightPoint light_point = LightPoint::solid_angle;             ///< of nee
    ControlVariate control_variate = ControlVariate::irradiance;  ///< of nee
    LightChoice light_choice = LightChoice::contribution;         ///< of nee
    MultipleImportance multiple_importance = MultipleImportance::balance;  ///< of nee
    Sampler sampler = Sampler::sobol;             ///< where random numbers come from
    FirstHit first_hit = FirstHit::first_sample;  ///< which ray the first-hit planes come from
    /// Of the image plane, in pixels of size, each from -65536 to 65536: pixel (x, y) shows what is
    /// at (x + dx, y + dy) without it. Patterns are seen by no camera.
    glm::vec2 camera_shift{0.0f};
    std::uint32_t seed = 1;         ///< any; renders of other seeds differ in noise
    Planes planes = Planes::all();  ///< beside radiance, which is always made
    int threads = 0;                ///< 1 to 1024; 0: all
    int simd_width = 0;  ///< samples traced side by side: 1, 4, 8 or 16; 0: the machine's widest
};

/// What a render took.
struct RenderStatistics {
    double scene_s = 0;                   ///< seconds for building the acceleration structure
    double trace_s = 0;                   ///< seconds for tracing
    std::uint64_t samples = 0;            ///< paths: traced pixels times spp
    std::uint64_t rays = 0;               ///< of all kinds, shadow rays included
    std::uint64_t dropped_samples = 0;    ///< samples that were not finite; they enter no mean
    std::uint64_t non_finite_pixels = 0;  ///< pixels whose mean is beyond the range of float
    int threads = 0;                      ///< that it ran on
    int simd_width = 0;                   ///< samples that were traced side by side
};

/// A frame, and what it took.
struct Render {
    Frame frame;                  ///< its size is reduced(size, reduction)
    RenderStatistics statistics;  ///< for people, not for results: times differ from run to run
};

/// Called now and then, from one thread at a time, with the share of the work done in [0, 1].
/// Returning false stops the render, which then throws Error(interrupted).
using Progress = std::function<bool(double done)>;

/// The packet widths that this build and this machine can trace with, widest first.
std::vector<int> simd_widths();

/// Traces a frame. The variance plane is made from 2 spp on; with the Sobol sampler it is estimated
/// from four independent scramblings, which changes the radiance too and makes it about 2 dB
/// noisier. No other plane changes another. Throws Error(usage) naming a setting that is out of
/// range, Error(file) if the machine lacks the memory: per traced pixel 12 bytes for each
/// three-channel and 4 for each one-channel plane asked for (108 for Planes::all()), nothing per
/// sample.
Render render(const Scene& scene, const RenderSettings& settings, const Progress& progress = {});

}  // namespace vecino
