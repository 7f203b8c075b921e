// SPDX-License-Identifier: Apache-2.0
//
// References of a run: rendered once, shared by all cells that are held against them, kept in the
// run directory with the first hits that tell regions apart and the light's parts.
#pragma once

#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "core/frame.h"
#include "core/render.h"
#include "eval/regions.h"
#include "eval/run_directory.h"

namespace vecino {

struct StoredReference {
    Image image;
    RegionMap regions;  ///< empty where the reference has no planes to make it from
    std::string file;   ///< relative to the run directory, without extension
    /// Its own error, from how its two halves differ or from its variance
    /// (eval/reference_error.h). Null where it has neither.
    nlohmann::json error;
};

/// A reference as it is rendered: half of its samples with one seed, the rest with the next, so
/// that the difference tells the error of the whole.
struct ReferenceHalves {
    Frame first;
    Image second;              ///< radiance; empty for a reference of one sample
    Image direct, indirect;    ///< of the second half
    double second_weight = 0;  ///< its share of the samples
};

/// Renders both halves. Each is rendered by trace, which is given the half's settings.
ReferenceHalves reference_halves(const RenderSettings& settings,
                                 const std::function<Frame(const RenderSettings&)>& trace);

/// What a reference is rendered with: its regions' planes, and direct and indirect light.
Planes reference_planes();

class ReferenceStore {
  public:
    explicit ReferenceStore(const RunDirectory& directory) : directory_(directory) {}

    /// The reference that key describes in full (scene, its state, settings, program). Made by make
    /// unless memory or the directory has it; the mean of its halves.
    const StoredReference& get(const std::string& key, const std::string& scene,
                               const std::function<ReferenceHalves()>& make);

  private:
    const RunDirectory& directory_;
    std::map<std::string, StoredReference> references_;
};

/// 16 hexadecimal digits that tell texts apart.
std::string text_hash(const std::string& text);

}  // namespace vecino
