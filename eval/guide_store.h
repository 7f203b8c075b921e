// SPDX-License-Identifier: Apache-2.0
//
// The guides of a frame's cells: full-resolution first hits, traced once for each number of samples
// and shared. Every cell that reads one is charged for its time.
#pragma once

#include <map>

#include "core/render.h"

namespace vecino {

struct TracedGuide {
    Frame frame;
    double trace_s;  ///< median over repeats
};

class GuideStore {
  public:
    /// The scene must outlive it.
    GuideStore(const Scene& scene, const RenderSettings& settings, int repeat)
        : scene_(scene), settings_(settings), repeat_(repeat) {}

    /// With so many samples per pixel along each axis, through the centres of as many parts of it.
    /// Throws as render() does.
    const TracedGuide& get(int scale);

  private:
    const Scene& scene_;
    RenderSettings settings_;
    int repeat_;
    std::map<int, TracedGuide> guides_;
};

}  // namespace vecino
