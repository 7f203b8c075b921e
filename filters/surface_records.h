// SPDX-License-Identifier: Apache-2.0

/// @file
/// The render method `surface_records`: exact coverage of pixels by surfaces, exact direct light
/// times what is in sight of it, and indirect light from few clean records that are interpolated on
/// their surfaces.
#pragma once

#include "core/render.h"

namespace vecino {

/// Where indirect light of pixels that several surfaces share comes from.
enum class EdgeLight {
    records,
    paths,  ///< of their own: contacts may be finer than records know of
};

/// How many samples go where.
struct SurfaceRecordsPlan {
    int pilot_spp = 8;       ///< first samples of every pixel; 1 to 4096
    int edge_spp = 128;      ///< mean of further samples where a pixel needs them; 0 to 65536
    int cell = 8;            ///< side of the cells that get a record per surface, pixels; 1 to 256
    int levels = 1;          ///< how often cells may be halved near contacts and on small objects
    int record_paths = 512;  ///< of each record; 1 to 2^20
    int refined_record_paths = 256;  ///< of each record in a halved cell; 1 to 2^20
    double fit_sigma = 0.85;         ///< width of the window of the fit, in cells; > 0
    double refine_tau = 0.15;        ///< cells are halved down to this share of the distance to
                                     ///< what is around them; > 0
    int fit_order = 2;               ///< of the polynomials between records, at most; 0 to 2
    EdgeLight edge_light = EdgeLight::records;  ///< of pixels that surfaces share

    /// Whether all values are equal.
    friend bool operator==(const SurfaceRecordsPlan&, const SurfaceRecordsPlan&) = default;
};

/// The plan that takes about as long as plain paths at so many samples per pixel.
SurfaceRecordsPlan surface_records_plan(int spp);

/// Renders by surface records. Of settings, spp plays no part: the plan stands for it. Planes:
/// all but variance, which is left out, and the means of first hits, which are an error;
/// sample_count counts primary rays. Scenes of a pattern are rendered as render() does. Throws as
/// render() does, and Error(usage) for a setting that is out of range or for light sampling other
/// than nee. Of up to 4 emitters each has its exact irradiance and shadow rays of its own; up to 32
/// are exact where nothing hides them, and what is hidden is found by picking one a sample; of
/// more, all is. Memory: that of the frame, and of a band of it of about two million pixels.
Render render_surface_records(const Scene& scene, const RenderSettings& settings,
                              const SurfaceRecordsPlan& plan, const Progress& progress = {});

}  // namespace vecino
