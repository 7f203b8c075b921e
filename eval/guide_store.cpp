// SPDX-License-Identifier: Apache-2.0
#include "eval/guide_store.h"

#include "core/first_hits.h"
#include "core/timing.h"
#include "filters/guide.h"

namespace vecino {

const TracedGuide& GuideStore::get(int scale) {
    const auto known = guides_.find(scale);
    if (known != guides_.end()) return known->second;
    RenderSettings settings = settings_;
    settings.size = {settings_.size.width * scale, settings_.size.height * scale};
    settings.camera_shift *= static_cast<float>(scale);  // in pixels of that size
    // Where positions are known, distances say nothing more.
    settings.planes = {Plane::position, Plane::normal, Plane::albedo, Plane::emission, Plane::id};
    TracedGuide guide{};
    std::vector<double> times;
    for (int i = 0; i < repeat_; ++i) {
        Render traced = trace_first_hits(scene_, settings);
        times.push_back(traced.statistics.trace_s);
        guide.frame = std::move(traced.frame);
    }
    guide.trace_s = median(times);
    return guides_.emplace(scale, std::move(guide)).first->second;
}

}  // namespace vecino
