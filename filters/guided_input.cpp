// SPDX-License-Identifier: Apache-2.0
#include "filters/guided_input.h"

#include <limits>

namespace vecino {

double screen_weight(double distance, double reach) {
    const double t = distance / reach;
    const double s = std::max(1.0 - t * t, 0.0);
    return s * s;
}

std::vector<AxisWindow> axis_windows(int full, int low, int window) {
    const int radius = std::min(window / 2, low - 1);
    std::vector<AxisWindow> windows(static_cast<std::size_t>(full));
    for (int x = 0; x < full; ++x) {
        AxisWindow& each = windows[static_cast<std::size_t>(x)];
        const int centre = corresponding(x, full, low);
        const double place = (x + 0.5) * low / full;
        each.begin = std::max(centre - radius, 0);
        const int end = std::min(centre + radius + 1, low);
        for (int q = each.begin; q < end; ++q)
            each.weights.push_back(screen_weight(std::abs(place - (q + 0.5)), radius + 0.5));
    }
    return windows;
}

GuidedInput::GuidedInput(const GuidedTask& task)
    : low_(task.low),
      threads_(task.request.threads),
      view_(task.guide, task.low.size()),
      fine_(view_.size() == task.request.size
                ? SurfelGrid()
                : SurfelGrid::of_samples(view_, task.request.size, threads_)),
      surfels_(view_.size() == task.request.size ? SurfelGrid(view_, task.low.size(), threads_)
                                                 : SurfelGrid(fine_, task.low.size(), threads_)),
      reflected_(task.low.size()) {
    for (int y = 0; y < low_.size().height; ++y) {
        for (int x = 0; x < low_.size().width; ++x) {
            glm::dvec3& value = reflected_(x, y);
            value = glm::dvec3(low_.radiance(x, y)) - emission(x, y);
            if (is_finite(value)) continue;
            value = glm::dvec3(std::numeric_limits<double>::quiet_NaN());
            ++dropped_;
        }
    }
}

/// That of the frame's own samples where it is known; else what the guide shows in the pixel.
glm::dvec3 GuidedInput::emission(int x, int y) const {
    if (!view_.knows_emission()) return glm::dvec3(0.0);
    if (!low_.emission.empty()) return glm::dvec3(low_.emission(x, y));
    return mean_over(surfels_.at(x, y), [](const Surfel& q) { return q.emission; });
}

}  // namespace vecino
