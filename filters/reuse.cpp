// SPDX-License-Identifier: Apache-2.0
//
// Reuse of traced pixels: one whose hit lies near to a traced hit of its surface takes its colour.
// Pixels are visited from a coarse lattice to a fine one; all of a pass look at what earlier passes
// traced, so that the result does not depend on an order within it.
#include <algorithm>
#include <cmath>
#include <limits>

#include "filters/partial_frame.h"
#include "filters/plans.h"

namespace vecino {
namespace {

class Reuse {
  public:
    Reuse(const MethodRequest& request, const Progress& progress)
        : parameters_(request.parameters),
          reach_(static_cast<int>(std::ceil(parameters_.radius))),
          partial_(request, progress) {}

    MethodRender run() {
        int step = 1;
        while (step <= reach_) step *= 2;  // no two pixels of the first pass reach each other
        for (int h = step; h >= 1; h /= 2) pass(h, h == step);
        partial_.for_each([&](std::size_t pixel) {
            if (!partial_.is_traced(pixel)) take_colour(pixel);
        });
        return partial_.finish(nlohmann::json::object());
    }

  private:
    /// Visits those of a lattice that are not of the next coarser one.
    void pass(int h, bool is_first) {
        const Extent size = partial_.size();
        PixelList visited;
        for (int y = 0; y < size.height; y += h) {
            for (int x = 0; x < size.width; x += h) {
                const bool is_new = is_first || x % (2 * h) != 0 || y % (2 * h) != 0;
                if (is_new) visited.push_back(number(x, y));
            }
        }
        std::vector<std::uint8_t> is_left(partial_.area());
        partial_.for_each(visited, [&](std::size_t pixel) {
            is_left[pixel] = !partial_.guide().must_trace(pixel) && !near(pixel).empty() ? 0 : 1;
        });
        std::erase_if(visited, [&](std::uint32_t pixel) { return is_left[pixel] == 0; });
        partial_.trace(visited);
    }

    [[nodiscard]] std::uint32_t number(int x, int y) const {
        return static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(partial_.size().width) +
               static_cast<std::uint32_t>(x);
    }

    /// Traced pixels whose hits are in reach, of the same surface; distances in footprints.
    [[nodiscard]] std::vector<Source> near(std::size_t pixel) const {
        const Extent size = partial_.size();
        const auto [x, y] = pixel_at(pixel, size);
        const auto radius = static_cast<double>(parameters_.radius);
        std::vector<Source> found;
        for (int v = std::max(y - reach_, 0); v <= std::min(y + reach_, size.height - 1); ++v) {
            for (int u = std::max(x - reach_, 0); u <= std::min(x + reach_, size.width - 1); ++u) {
                const std::uint32_t other = number(u, v);
                if (!partial_.is_source(other)) continue;
                if (!partial_.guide().is_same_surface(pixel, other)) continue;
                const double distance = partial_.guide().distance(pixel, other);
                if (distance <= radius) found.push_back({other, distance});
            }
        }
        return found;
    }

    void take_colour(std::size_t pixel) {
        const std::vector<Source> found = near(pixel);
        Blend blend;
        if (parameters_.reused == Reused::mean)
            blend = partial_.blend(found, parameters_.weighting);
        // Hits at one place have no weights by distance.
        if (!(blend.weight() > 0) || !std::isfinite(blend.weight())) {
            const auto nearest = std::ranges::min_element(found, {}, &Source::distance);
            blend = Blend();
            blend.add(partial_.frame(), nearest->pixel, partial_.guide().hit(nearest->pixel), 1.0);
        }
        partial_.store(pixel, blend);
    }

    const MethodParameters& parameters_;
    int reach_;  ///< in pixels: what is near in space is near in the image
    PartialFrame partial_;
};

}  // namespace

MethodRender render_reuse(const MethodRequest& request, const Progress& progress) {
    return Reuse(request, progress).run();
}

}  // namespace vecino
