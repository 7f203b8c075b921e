// SPDX-License-Identifier: Apache-2.0
//
// Arithmetic of the method auto: from what a pilot found and what things cost to a schedule. No
// clock and no randomness in here.
#pragma once

#include <optional>
#include <vector>

#include "core/grid.h"
#include "filters/surface_records_stages.h"

namespace vecino {

/// Seconds for one of each.
struct CostRates {
    double path_sample_s;   ///< path tracing, of whole packets
    double first_sample_s;  ///< surface_records: of all pixels
    double pixel_s;         ///< needs and resolve of a pixel
    double edge_sample_s;
    double record_path_s;
    double record_s;  ///< the fit
};

/// Of a machine that takes 8.5 ns for a ray: for budgets that are given in samples, which must not
/// depend on the clock. rays_per_path: of path tracing.
CostRates nominal_rates(double rays_per_path);

/// Records of all halved cells, for each of the coarsest. Cells are halved where surfaces meet or
/// bend: the larger they are, the more of them. growth: of records, were all of them halved.
double refined_share(const SurfaceRecordsPlan& plan, double growth);

/// The bias of records in cells of so many pixels to a side, held against that of eight.
double bias_share(double cell);

/// Its errors fall with samples and paths to these powers: Sobol points.
constexpr double kEdgeSlope = 1.3, kRecordSlope = 1.25;

/// Of a machine that takes so many times as long for everything.
CostRates slower(const CostRates& rates, double times);

/// Errors are means of squared differences of sRGB-encoded values in [0,1], as of psnr_float_db.
struct PathErrors {
    double at_16_spp = 0;
    double slope = 1;  ///< up to 64 spp error falls as spp to the power of -slope; beyond, slower
};

/// Of needy pixels, what their noise is held against.
constexpr int kComparedEdgeSpp = 128;

/// What makes up the error of surface_records.
struct RecordErrors {
    double edge_noise = 0;    ///< by kComparedEdgeSpp samples of needy pixels
    double record_noise = 0;  ///< by records of 512 paths
    double bias_at_8 = 0;     ///< by cells of 8 pixels
    double unexplained = 0;   ///< against traced paths: none of these
};

/// Of a usual scene, for what cannot be measured.
constexpr RecordErrors kUsualErrors{0.25e-6, 0.8e-6, 1.2e-6, 0};

/// Of a usual frame: so many of its pixels are needy.
constexpr double kUsualNeedy = 0.06;

/// The noise of a plan's needy pixels, held against that of 128 samples each, and of its records,
/// held against that of 512 paths each.
double edge_noise_share(const SurfaceRecordsPlan& plan);
double record_noise_share(const SurfaceRecordsPlan& plan);

/// What samples of needy pixels take and leave, by their mean number: of this frame, where it is
/// known; rising.
struct EdgePoint {
    double edge_spp;
    double work;   ///< of a needy pixel on average, in samples, with what it begins with
    double error;  ///< of the frame
};
using EdgeCurve = std::vector<EdgePoint>;

struct PilotFindings {
    double pixels = 0;               ///< of the frame that is wanted
    int lanes = 16;                  ///< samples of a packet: path tracing takes as long for fewer
    double needy_pixels = 0;         ///< of it, extrapolated
    double records_at_8 = 0;         ///< with cells of 8 pixels
    double record_growth = 4;        ///< factor of records for cells of half the side
    bool has_records_method = true;  ///< surface_records can render with these settings
    std::optional<PathErrors> path;  ///< none: there was no time to find out
    std::optional<RecordErrors> records;
    EdgeCurve edges;  ///< empty: as of edge_noise
};

/// Which method with which numbers, and what is expected of it.
struct Schedule {
    bool is_path = true;
    int spp = 1;  ///< of path
    SurfaceRecordsPlan plan;
    double predicted_s = 0;
    std::optional<double> predicted_error;
};

/// Seconds that a plan takes.
double surface_records_cost(const PilotFindings& found, const CostRates& rates,
                            const SurfaceRecordsPlan& plan);

/// Predicted error of a plan; what was not measured is that of a usual scene.
double surface_records_error(const PilotFindings& found, const SurfaceRecordsPlan& plan);

/// The best that each method can do in so many seconds, at least its least.
Schedule plan_path(const PilotFindings& found, const CostRates& rates, double seconds);
Schedule plan_surface_records(const PilotFindings& found, const CostRates& rates, double seconds);

/// Whether path tracing alone leaves no error that could be seen: 72 dB. Then nothing is held
/// against it.
bool is_beyond_sight(const Schedule& path);

/// Both, and which of them is chosen: path tracing where it is expected to be 2 dB better.
struct Plans {
    Schedule path;
    std::optional<Schedule> records;  ///< none: the method cannot render this
    bool takes_path = true;
    const char* reason = "";

    [[nodiscard]] const Schedule& chosen() const { return takes_path ? path : *records; }
};
Plans choose_schedule(const PilotFindings& found, const CostRates& rates, double seconds);

}  // namespace vecino
