// SPDX-License-Identifier: Apache-2.0
//
// Adaptive tracing from coarse to fine: a pixel between traced ones of its surface is interpolated
// if they agree, and traced if not. Only traced pixels are interpolated from, so that errors do not
// creep; a phase reads what earlier ones left and nothing of its own.
#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>

#include "core/memory.h"
#include "filters/partial_frame.h"
#include "filters/plane_fit.h"
#include "filters/plans.h"

namespace vecino {
namespace {

constexpr int kSpreads = 4;  ///< parts of a pixel's samples whose spread tells its noise
// Of noise alone, 8 numbers spread over so many of their standard errors in 5 % of all cases
// (studentized range).
constexpr double kRangeErrors = 4.5;
// Where light is dim, it is compared against this share of what pixels have on average.
constexpr double kFloorShare = 0.05;
constexpr float kLeastAlbedo = 1e-3f;

/// Light that reaches the surface, and the variance of the pixel's mean.
struct Light {
    glm::dvec3 value{0.0}, variance{0.0};
};

/// From the spread of parts of consecutive samples: they cover the dimensions of a Sobol sequence
/// each, so that it overestimates the error of the whole a little (by some 2 dB), never the
/// reverse.
class SpreadOfParts {
  public:
    explicit SpreadOfParts(int samples) : samples_(samples) {}

    void read(const SampleBlock& block, int first, int count) {
        const int parts = std::min(kSpreads, samples_);
        for (int i = 0; i < count; ++i) {
            const auto part = static_cast<std::size_t>(std::int64_t{first + i} * parts / samples_);
            ++counts_[part];
            for (int c = 0; c < 3; ++c)
                sums_[part][c] += static_cast<double>(block.direct[c][i]) +
                                  static_cast<double>(block.indirect[c][i]);
        }
    }

    /// Of the mean of all; 0 for one sample, of which nothing is known.
    [[nodiscard]] glm::vec3 variance() const {
        const int parts = std::min(kSpreads, samples_);
        if (parts < 2) return glm::vec3(0.0f);
        glm::dvec3 mean(0.0), squares(0.0);
        for (std::size_t k = 0; k < static_cast<std::size_t>(parts); ++k)
            mean += sums_[k] / (static_cast<double>(counts_[k]) * parts);
        for (std::size_t k = 0; k < static_cast<std::size_t>(parts); ++k) {
            const glm::dvec3 deviation = sums_[k] / static_cast<double>(counts_[k]) - mean;
            squares += deviation * deviation;
        }
        return glm::vec3(squares / (static_cast<double>(parts) * (parts - 1)));
    }

  private:
    int samples_;
    std::array<glm::dvec3, kSpreads> sums_{};
    std::array<int, kSpreads> counts_{};
};

class Adaptive {
  public:
    Adaptive(const MethodRequest& request, const Progress& progress)
        : parameters_(request.parameters),
          spp_(request.settings.spp),
          partial_(request, progress),
          size_(partial_.size()),
          variance_(size_),
          calculated_(size_),
          explicit_(size_),
          ancestors_(partial_.area()) {}

    MethodRender run() {
        trace(coarse_pixels());
        measure_floor();
        for (int h = parameters_.coarse_step / 2; h >= 1; h /= 2) {
            refine(h, true);
            refine(h, false);
        }
        std::size_t must = 0;
        for (std::size_t i = 0; i < partial_.area(); ++i)
            must += partial_.guide().must_trace(i) ? 1 : 0;
        MethodRender result =
            partial_.finish({{"must_trace_share", share(must, partial_.area())},
                             {"corrected_share", share(corrected_, partial_.area())}});
        result.maps = {{"Calculated", std::move(calculated_)}, {"Explicit", std::move(explicit_)}};
        return result;
    }

  private:
    /// Traced pixels that an interpolated one comes from.
    using Ancestors = std::array<std::uint32_t, kMostPoints>;
    static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

    enum class Verdict : std::uint8_t { interpolated, disagreement, unsupported };

    /// The traced pixels that one is interpolated from, and where they are from there.
    struct Sources {
        std::size_t count = 0;
        std::array<std::uint32_t, kMostPoints> pixel;
        std::array<Pixel, kMostPoints> offset;
    };
    /// Of parents that are each traced, or stand for so many.
    static constexpr std::size_t kMostFound = 4 * kMostPoints;
    struct Found {
        std::size_t count = 0;
        std::array<std::uint64_t, kMostFound> keys;  ///< squared distance, then number
    };

    [[nodiscard]] std::uint32_t number(int x, int y) const {
        return static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(size_.width) +
               static_cast<std::uint32_t>(x);
    }

    /// A lattice, and the last row and column: every other pixel lies between some of these.
    [[nodiscard]] PixelList coarse_pixels() const {
        const int step = parameters_.coarse_step;
        PixelList pixels;
        for (int y = 0; y < size_.height; ++y) {
            for (int x = 0; x < size_.width; ++x) {
                const bool on_lattice = x % step == 0 && y % step == 0;
                if (on_lattice || x == size_.width - 1 || y == size_.height - 1)
                    pixels.push_back(number(x, y));
            }
        }
        return pixels;
    }

    void trace(const PixelList& pixels) {
        if (pixels.empty()) return;
        ++pass_;
        std::vector<SpreadOfParts> spreads(pixels.size(), SpreadOfParts(spp_));
        const auto reader_of = [&](std::size_t pixel) {
            const auto at = std::ranges::lower_bound(pixels, pixel) - pixels.begin();
            SpreadOfParts& spread = spreads[static_cast<std::size_t>(at)];
            return BlockReader([&spread](const SampleBlock& block, int first, int count) {
                spread.read(block, first, count);
            });
        };
        partial_.trace(pixels, reader_of);
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            variance_.values()[pixels[i]] = spreads[i].variance();
            calculated_.values()[pixels[i]] = static_cast<float>(pass_);
            explicit_.values()[pixels[i]] = 1.0f;
        }
    }

    [[nodiscard]] Light light_of(std::size_t pixel) const {
        const Frame& frame = partial_.frame();
        const auto& albedo = partial_.guide().hit(pixel).albedo;
        Light light;
        for (int c = 0; c < 3; ++c) {
            const float sent = frame.direct.values()[pixel][c] + frame.indirect.values()[pixel][c];
            const float share = albedo[c] > kLeastAlbedo ? albedo[c] : 1.0f;
            light.value[c] = static_cast<double>(sent / share);
            light.variance[c] = static_cast<double>(variance_.values()[pixel][c] / (share * share));
        }
        return light;
    }

    void measure_floor() {
        double sum = 0, count = 0;
        for (std::size_t i = 0; i < partial_.area(); ++i) {
            if (!partial_.is_source(i) || partial_.guide().must_trace(i)) continue;
            const glm::dvec3 light = light_of(i).value;
            sum += (light.x + light.y + light.z) / 3;
            ++count;
        }
        floor_ = count > 0 ? kFloorShare * sum / count : 0;
    }

    /// Pixels at distance h from the lattice of step 2h: the middles of its cells, or of their
    /// sides.
    [[nodiscard]] PixelList candidates(int h, bool middles) const {
        PixelList pixels;
        for (int y = 0; y < size_.height; y += h) {
            for (int x = 0; x < size_.width; x += h) {
                const int odd = (x / h) % 2 + (y / h) % 2;
                if (odd != (middles ? 2 : 1)) continue;
                const std::uint32_t pixel = number(x, y);
                if (calculated_.values()[pixel] == 0) pixels.push_back(pixel);
            }
        }
        return pixels;
    }

    /// Traced pixels around a pixel, of its surface, nearest first: its parents, where each that
    /// was interpolated stands for those that it comes from.
    [[nodiscard]] Sources sources_of(std::size_t pixel, int h, bool middles) const {
        constexpr std::array<Pixel, 4> kDiagonal{{{-1, -1}, {1, -1}, {-1, 1}, {1, 1}}};
        constexpr std::array<Pixel, 4> kAxial{{{0, -1}, {-1, 0}, {1, 0}, {0, 1}}};
        const Pixel at = pixel_at(pixel, size_);
        Found found;
        for (const Pixel& to : middles ? kDiagonal : kAxial) {
            // Beyond the last row or column, which is traced, it takes the place of the parent.
            const int u = std::min(at.x + h * to.x, size_.width - 1);
            const int v = std::min(at.y + h * to.y, size_.height - 1);
            if (u >= 0 && v >= 0) add_sources(pixel, number(u, v), found);
        }
        const auto end = found.keys.begin() + static_cast<std::ptrdiff_t>(found.count);
        std::sort(found.keys.begin(), end);
        const auto unique_end = std::unique(found.keys.begin(), end);
        Sources sources;
        for (auto key = found.keys.begin(); key != unique_end; ++key) {
            if (sources.count == kMostPoints) break;
            sources.pixel[sources.count] = static_cast<std::uint32_t>(*key);
            const Pixel there = pixel_at(sources.pixel[sources.count], size_);
            sources.offset[sources.count++] = {there.x - at.x, there.y - at.y};
        }
        return sources;
    }

    void add_sources(std::size_t pixel, std::uint32_t parent, Found& found) const {
        const Pixel at = pixel_at(pixel, size_);
        const auto add = [&](std::uint32_t source) {
            if (!partial_.is_source(source) || !partial_.guide().is_same_surface(pixel, source))
                return;
            const Pixel there = pixel_at(source, size_);
            const std::int64_t x = there.x - at.x, y = there.y - at.y;
            found.keys[found.count++] = static_cast<std::uint64_t>(x * x + y * y) << 32 | source;
        };
        if (partial_.is_traced(parent)) return add(parent);
        for (const std::uint32_t source : ancestors_[parent]) {
            if (source != kNone) add(source);
        }
    }

    [[nodiscard]] bool agree(const Sources& sources) const {
        glm::dvec3 least(1e300), most(-1e300), mean(0.0), variance(0.0);
        const auto count = static_cast<double>(sources.count);
        for (std::size_t i = 0; i < sources.count; ++i) {
            const Light light = light_of(sources.pixel[i]);
            least = glm::min(least, light.value);
            most = glm::max(most, light.value);
            mean += light.value / count;
            variance += light.variance / count;
        }
        for (int c = 0; c < 3; ++c) {
            if (most[c] - least[c] > allowed_difference(mean[c], variance[c])) return false;
        }
        return true;
    }

    [[nodiscard]] double allowed_difference(double light, double variance) const {
        return static_cast<double>(parameters_.tolerance) * (std::abs(light) + floor_) +
               kRangeErrors * std::sqrt(variance);
    }

    /// Interpolates a pixel if what surrounds it agrees. If that does not, guessed is what
    /// interpolation would have made of it.
    Verdict judge(std::size_t pixel, int h, bool middles, glm::vec3& guessed) {
        if (partial_.guide().must_trace(pixel)) return Verdict::unsupported;
        const Sources sources = sources_of(pixel, h, middles);
        const std::span offsets(sources.offset.data(), sources.count);
        if (sources.count < 3 || !surrounds_origin(offsets)) return Verdict::unsupported;
        std::array<double, kMostPoints> weights;
        weights_at_origin(offsets, std::span(weights).first(sources.count));
        Blend blend;
        for (std::size_t i = 0; i < sources.count; ++i) {
            const std::uint32_t source = sources.pixel[i];
            blend.add(partial_.frame(), source, partial_.guide().hit(source), weights[i]);
        }
        const auto& albedo = partial_.guide().hit(pixel).albedo;
        const PixelValues values = blend.values(glm::vec3(albedo[0], albedo[1], albedo[2]));
        guessed = values.direct + values.indirect;
        if (!agree(sources)) return Verdict::disagreement;
        partial_.store(pixel, values);
        calculated_.values()[pixel] = static_cast<float>(pass_ + 1);
        ancestors_[pixel].fill(kNone);
        std::copy_n(sources.pixel.begin(), sources.count, ancestors_[pixel].begin());
        return Verdict::interpolated;
    }

    void refine(int h, bool middles) {
        const PixelList pixels = candidates(h, middles);
        std::vector<Verdict> verdicts(pixels.size());
        std::vector<glm::vec3> guesses(pixels.size());
        PixelList all(pixels.size());
        for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
        partial_.for_each(
            all, [&](std::size_t i) { verdicts[i] = judge(pixels[i], h, middles, guesses[i]); });
        PixelList to_trace;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            if (verdicts[i] != Verdict::interpolated) to_trace.push_back(pixels[i]);
        }
        trace(to_trace);
        if (!parameters_.correction) return;
        PixelList off;
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            if (verdicts[i] == Verdict::disagreement && is_off(pixels[i], guesses[i]))
                off.push_back(pixels[i]);
        }
        trace(interpolated_near(off, h));
    }

    /// Interpolated pixels near to some at which interpolation would have been wrong.
    [[nodiscard]] PixelList interpolated_near(const PixelList& pixels, int h) {
        std::vector<std::uint8_t> is_near(partial_.area());
        for (const std::uint32_t pixel : pixels) {
            const auto [x, y] = pixel_at(pixel, size_);
            for (int v = std::max(y - h, 0); v <= std::min(y + h, size_.height - 1); ++v) {
                for (int u = std::max(x - h, 0); u <= std::min(x + h, size_.width - 1); ++u)
                    is_near[number(u, v)] = 1;
            }
        }
        PixelList found;
        for (std::uint32_t i = 0; i < is_near.size(); ++i) {
            const bool is_interpolated = calculated_.values()[i] != 0 && !partial_.is_traced(i);
            if (is_near[i] != 0 && is_interpolated) found.push_back(i);
        }
        corrected_ += found.size();
        return found;
    }

    /// Whether a traced pixel is not what interpolation made of it.
    [[nodiscard]] bool is_off(std::size_t pixel, const glm::vec3& guess) const {
        const Light light = light_of(pixel);
        const auto& albedo = partial_.guide().hit(pixel).albedo;
        for (int c = 0; c < 3; ++c) {
            const float share = albedo[c] > kLeastAlbedo ? albedo[c] : 1.0f;
            const auto guessed = static_cast<double>(guess[c] / share);
            const double error = std::abs(light.value[c] - guessed);
            if (error > allowed_difference(light.value[c], light.variance[c])) return true;
        }
        return false;
    }

    const MethodParameters& parameters_;
    int spp_;
    PartialFrame partial_;
    Extent size_;
    Image variance_;  ///< of the light that traced pixels reflect
    Grid<float> calculated_, explicit_;
    std::vector<Ancestors> ancestors_;
    double floor_ = 0;
    int pass_ = 0;
    std::size_t corrected_ = 0;
};

}  // namespace

MethodRender render_adaptive(const MethodRequest& request, const Progress& progress) {
    const Extent size = reduced(request.settings.size, request.settings.reduction);
    constexpr std::size_t kBytesPerPixel = 160;  // what it keeps beside frame and first hits
    require_memory(size.area() * kBytesPerPixel, "adaptive render of " + size_text(size));
    return Adaptive(request, progress).run();
}

}  // namespace vecino
