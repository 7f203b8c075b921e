// SPDX-License-Identifier: Apache-2.0

/// @file
/// What the method `surface_records` can be told on a command line or in a matrix.
#pragma once

#include <optional>

#include "filters/surface_records.h"

namespace vecino {

/// The values of a plan that are given; the others follow from spp.
struct SurfaceRecordsOptions {
    std::optional<int> pilot_spp;             ///< SurfaceRecordsPlan::pilot_spp
    std::optional<int> edge_spp;              ///< SurfaceRecordsPlan::edge_spp
    std::optional<int> cell;                  ///< SurfaceRecordsPlan::cell
    std::optional<int> levels;                ///< SurfaceRecordsPlan::levels
    std::optional<int> record_paths;          ///< SurfaceRecordsPlan::record_paths
    std::optional<int> refined_record_paths;  ///< SurfaceRecordsPlan::refined_record_paths
    std::optional<double> fit_sigma;          ///< SurfaceRecordsPlan::fit_sigma
    std::optional<double> refine_tau;         ///< SurfaceRecordsPlan::refine_tau
    std::optional<int> fit_order;             ///< SurfaceRecordsPlan::fit_order
    std::optional<EdgeLight> edge_light;      ///< SurfaceRecordsPlan::edge_light
};

/// The plan of surface_records_plan(spp), with what is given in its place.
SurfaceRecordsPlan plan_of(const SurfaceRecordsOptions& options, int spp);

}  // namespace vecino
