// SPDX-License-Identifier: Apache-2.0
//
// Interleaving, in both of its meanings: of pixels (a lattice is traced, the rest interpolated) and
// of samples (Keller and Heidrich, "Interleaved Sampling", 2001).
#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

#include "core/error.h"
#include "filters/partial_frame.h"
#include "filters/plans.h"

namespace vecino {
namespace {

std::uint32_t number_of(Pixel at, Extent size) {
    return static_cast<std::uint32_t>(at.y) * static_cast<std::uint32_t>(size.width) +
           static_cast<std::uint32_t>(at.x);
}

// ---------------------------------------------------------------- pixels

class Lattice {
  public:
    Lattice(const MethodRequest& request, const Progress& progress)
        : parameters_(request.parameters), partial_(request, progress) {}

    MethodRender run() {
        PixelList mask;
        for (std::uint32_t i = 0; i < partial_.area(); ++i) {
            if (has(pixel_at(i, partial_.size()))) mask.push_back(i);
        }
        partial_.trace(mask);
        std::vector<std::uint8_t> is_alone(partial_.area());
        partial_.for_each([&](std::size_t pixel) {
            if (!partial_.is_traced(pixel)) is_alone[pixel] = interpolate(pixel) ? 0 : 1;
        });
        PixelList alone;
        for (std::uint32_t i = 0; i < is_alone.size(); ++i) {
            if (is_alone[i] != 0) alone.push_back(i);
        }
        partial_.trace(alone);
        return partial_.finish({{"fallback_pixels", alone.size()}});
    }

  private:
    [[nodiscard]] bool has(Pixel at) const {
        const int step = parameters_.step;
        if (at.x % step != 0 || at.y % step != 0) return false;
        return parameters_.mask == LatticeMask::square || (at.x / step + at.y / step) % 2 == 0;
    }

    [[nodiscard]] bool counts(std::size_t pixel, std::size_t source) const {
        if (parameters_.kernel == LatticeKernel::distance3d_normal)
            return partial_.is_finite(source) && partial_.guide().has_like_normal(pixel, source);
        return partial_.is_source(source) && partial_.guide().is_same_surface(pixel, source);
    }

    /// Traced pixels within a step on either side that the kernel lets through.
    [[nodiscard]] std::vector<Source> sources_of(std::size_t pixel) const {
        const int step = parameters_.step;
        const Extent size = partial_.size();
        const Pixel at = pixel_at(pixel, size);
        const auto first = [step](int centre) {
            return (std::max(centre - step, 0) + step - 1) / step * step;
        };
        std::vector<Source> sources;
        for (int y = first(at.y); y <= std::min(at.y + step, size.height - 1); y += step) {
            for (int x = first(at.x); x <= std::min(at.x + step, size.width - 1); x += step) {
                const std::uint32_t source = number_of({x, y}, size);
                if (!has({x, y}) || !counts(pixel, source)) continue;
                sources.push_back({source, partial_.guide().distance(pixel, source)});
            }
        }
        return sources;
    }

    /// Returns false where nothing around it is like it; so it is where it shows two surfaces.
    bool interpolate(std::size_t pixel) {
        const bool by_surface = parameters_.kernel == LatticeKernel::surface;
        if (by_surface && partial_.guide().is_edge(pixel)) return false;
        const Blend blend = partial_.blend(sources_of(pixel), parameters_.weighting);
        if (!(blend.weight() > 0) || !std::isfinite(blend.weight())) return false;
        if (by_surface) {
            partial_.store(pixel, blend);
        } else {
            partial_.store(pixel, blend.values(std::nullopt));
        }
        return true;
    }

    const MethodParameters& parameters_;
    PartialFrame partial_;
};

// ---------------------------------------------------------------- samples

class Subsequences {
  public:
    Subsequences(const MethodRequest& request, const Progress& progress)
        : step_(request.parameters.step),
          samples_(request.settings.spp / (step_ * step_)),
          partial_(request, progress) {
        partial_.tracer().share_samples();
    }

    MethodRender run() {
        const auto first = [this](Pixel at) {
            return (at.y % step_ * step_ + at.x % step_) * samples_;
        };
        partial_.begin_samples_at(first);
        partial_.trace_all([&](PixelTrace& pixel) {
            const int begin = first(pixel.at());
            pixel.trace({begin, begin + samples_});
        });
        const Frame traced = partial_.frame();
        std::atomic<std::size_t> edges = 0;
        partial_.for_each([&](std::size_t pixel) {
            if (!put_together(pixel, traced)) ++edges;
        });
        return partial_.finish(
            {{"samples_per_pixel", samples_}, {"unfiltered_share", share(edges, partial_.area())}});
    }

  private:
    /// The mean over the box of what is of the pixel's surface. An edge keeps its own samples,
    /// which alone tell how much of it each surface covers.
    bool put_together(std::size_t pixel, const Frame& traced) {
        if (!partial_.is_source(pixel)) return false;
        const Extent size = partial_.size();
        const auto [x, y] = pixel_at(pixel, size);
        const int left = x - step_ / 2;
        const int top = y - step_ / 2;
        Blend blend;
        for (int v = std::max(top, 0); v < std::min(top + step_, size.height); ++v) {
            for (int u = std::max(left, 0); u < std::min(left + step_, size.width); ++u) {
                const std::uint32_t source = number_of({u, v}, size);
                if (!partial_.is_source(source)) continue;
                if (!partial_.guide().is_same_surface(pixel, source)) continue;
                blend.add(traced, source, partial_.guide().hit(source), 1.0);
            }
        }
        partial_.filter(pixel, blend);
        return true;
    }

    int step_;
    int samples_;  ///< of each pixel
    PartialFrame partial_;
};

void require_samples(const MethodRequest& request) {
    const int least = request.parameters.step * request.parameters.step;
    if (request.settings.spp >= least) return;
    throw Error(ExitCode::usage, "spp: found " + std::to_string(request.settings.spp) +
                                     ", allowed with a subsequence for each of " +
                                     std::to_string(least) + " pixels: " + std::to_string(least) +
                                     " or more");
}

}  // namespace

MethodRender render_interleaved(const MethodRequest& request, const Progress& progress) {
    if (request.parameters.interleaving == Interleaving::lattice)
        return Lattice(request, progress).run();
    require_samples(request);
    return Subsequences(request, progress).run();
}

}  // namespace vecino
