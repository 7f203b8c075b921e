// SPDX-License-Identifier: Apache-2.0
//
// Irradiance is smooth where a surface is, whatever its albedo, so that is what is interpolated:
//   radiance = emission + modulation * E, with modulation and emission from the guide.
// Every surfel of the low-resolution frame gets a polynomial of E in coordinates of its tangent
// plane, fitted to the surfels around it that are of its surface; a pixel of the result blends the
// polynomials of the four low-resolution pixels around it, each evaluated at the pixel's own first
// hit. Fits per low-resolution surfel, not per pixel, cost a quarter at half the size.
#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>
#include <limits>

#include "filters/guided.h"
#include "filters/guided_input.h"
#include "filters/polynomial.h"

namespace vecino {
namespace {

constexpr int kNormalPower = 16;

/// Coordinates on a surface around a surfel, in low-resolution pixels.
class SurfaceFrame {
  public:
    SurfaceFrame() = default;
    explicit SurfaceFrame(const Surfel& origin) : position_(origin.position), place_(origin.place) {
        if (origin.inverse_footprint == 0 || origin.normal == glm::vec3(0.0f)) return;
        // Duff et al., "Building an Orthonormal Basis, Revisited", 2017.
        const glm::vec3 n = origin.normal;
        const float sign = std::copysign(1.0f, n.z);
        const float a = -1.0f / (sign + n.z);
        const float b = n.x * n.y * a;
        tangent_ = glm::vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
        bitangent_ = glm::vec3(b, sign + n.y * n.y * a, -n.y);
        scale_ = origin.inverse_footprint;
    }

    /// On the tangent plane; in the image where positions are not known.
    [[nodiscard]] glm::dvec2 of(const Surfel& surfel) const {
        if (scale_ == 0) return glm::dvec2(surfel.place) - glm::dvec2(place_);
        const glm::dvec3 d =
            (glm::dvec3(surfel.position) - glm::dvec3(position_)) * static_cast<double>(scale_);
        return {glm::dot(d, glm::dvec3(tangent_)), glm::dot(d, glm::dvec3(bitangent_))};
    }

  private:
    glm::vec3 position_{0.0f}, tangent_{0.0f}, bitangent_{0.0f};
    glm::vec2 place_{0.0f};
    float scale_ = 0;
};

/// Least and largest values, with room for what lies beyond the outermost samples.
struct Bounds {
    glm::dvec3 least{0.0}, most{0.0};

    [[nodiscard]] bool hold(const glm::dvec3& v) const {
        return glm::all(glm::greaterThanEqual(v, least)) && glm::all(glm::lessThanEqual(v, most));
    }
};

/// The irradiance around a surfel of the low-resolution frame.
struct Fit {
    SurfaceFrame frame;
    std::array<glm::vec3, kMostTerms> coefficients{};
    glm::vec3 least{0.0f}, most{0.0f};
    int order = -1;  ///< -1: there is no finite sample

    [[nodiscard]] glm::dvec3 at(const Surfel& surfel) const {
        const glm::dvec2 c = frame.of(surfel);
        const auto terms = terms_at(c.x, c.y);
        glm::dvec3 value(0.0);
        for (std::size_t i = 0; i < static_cast<std::size_t>(terms_of(order)); ++i)
            value += terms[i] * glm::dvec3(coefficients[i]);
        if (!is_finite(glm::vec3(value))) value = glm::dvec3(coefficients[0]);  // out of reach
        return glm::clamp(value, glm::dvec3(least), glm::dvec3(most));
    }
};

struct Sample {
    double quality;  ///< how surely it is of the surface, and of it alone
    double weight;   ///< that, by distance and by how well its irradiance is known
    glm::dvec2 at;
    glm::dvec3 value;
};

/// Irradiance of a pixel of the frame, and how far it can be relied on.
struct PixelIrradiance {
    glm::dvec3 value{0.0};
    double trust = 0;  ///< 0: not finite
};

/// A pixel of the result reaches one pixel farther than the polynomials that it blends.
int radius_of_fits(int window, Extent low) {
    const int reach = std::min(window / 2, std::max(low.width, low.height) - 1);
    return std::max(reach - 1, 0);
}

class GuidedFit {
  public:
    GuidedFit(const GuidedTask& task, const GuidedInput& input)
        : input_(input),
          window_(task.request.parameters.window),
          radius_(radius_of_fits(window_, input.low_size())),
          order_(task.request.parameters.order),
          size_(task.request.size),
          irradiance_(input.low_size()),
          fits_(input.surfels().count()) {
        const auto rows = static_cast<std::size_t>(input.low_size().height);
        const auto for_each_row = [&](auto visit) {
            for_each_block(rows, 1, input.threads(), [&](BlockRange block) {
                for (int x = 0; x < input_.low_size().width; ++x)
                    visit(x, static_cast<int>(block.begin));
            });
        };
        for_each_row([&](int x, int y) { irradiance_(x, y) = irradiance_of(x, y); });
        for_each_row([&](int x, int y) { fit_pixel(x, y); });
    }

    [[nodiscard]] std::array<std::size_t, 3> orders() const {
        std::array<std::size_t, 3> counts{};
        for (const Fit& fit : fits_) {
            if (fit.order >= 0) ++counts[static_cast<std::size_t>(fit.order)];
        }
        return counts;
    }

    glm::dvec3 operator()(const Surfel& p, int x, int y, GuidedOutcome& outcome) const;

  private:
    [[nodiscard]] PixelIrradiance irradiance_of(int x, int y) const;
    void fit_pixel(int x, int y);
    void collect(const Surfel& centre, int x, int y, std::vector<Sample>& samples) const;
    [[nodiscard]] Fit fit(const Surfel& centre, std::vector<Sample>& samples) const;
    void blend(const Surfel& p, int u, int v, double weight, glm::dvec4& sum) const;

    const GuidedInput& input_;
    int window_;
    int radius_;  ///< of the neighbourhood that a polynomial is fitted to
    int order_;
    Extent size_;
    Grid<PixelIrradiance> irradiance_;
    std::vector<Fit> fits_;
};

/// A channel in which nothing is reflected tells nothing; dark ones tell it with much noise.
PixelIrradiance GuidedFit::irradiance_of(int x, int y) const {
    constexpr double kLeast = 1e-6;
    const glm::dvec3& reflected = input_.reflected(x, y);
    if (!is_finite(reflected)) return {};
    const glm::dvec3 modulation =
        mean_over(input_.surfels().at(x, y), [](const Surfel& q) { return q.modulation; });
    PixelIrradiance result;
    for (int c = 0; c < 3; ++c)
        result.value[c] = modulation[c] > kLeast ? reflected[c] / modulation[c] : 0.0;
    const double darkest = std::min({modulation.x, modulation.y, modulation.z});
    result.trust = darkest * darkest + 1e-8;
    return result;
}

void GuidedFit::fit_pixel(int x, int y) {
    static thread_local std::vector<Sample> samples;
    std::size_t index = input_.surfels().index(x, y);
    for (const Surfel& centre : input_.surfels().at(x, y)) {
        samples.clear();
        collect(centre, x, y, samples);
        fits_[index++] = fit(centre, samples);
    }
}

void GuidedFit::collect(const Surfel& centre, int x, int y, std::vector<Sample>& samples) const {
    const Extent low = input_.low_size();
    const SurfaceFrame frame(centre);
    for (int v = std::max(y - radius_, 0); v <= std::min(y + radius_, low.height - 1); ++v) {
        for (int u = std::max(x - radius_, 0); u <= std::min(x + radius_, low.width - 1); ++u) {
            const PixelIrradiance& pixel = irradiance_(u, v);
            if (pixel.trust == 0) continue;
            const double near =
                screen_weight(u - x, radius_ + 1.0) * screen_weight(v - y, radius_ + 1.0);
            for (const Surfel& q : input_.surfels().at(u, v)) {
                const auto quality =
                    static_cast<double>(q.purity * likeness<kNormalPower>(centre, q));
                if (quality > kLeastWeight)
                    samples.push_back(
                        {quality, quality * near * pixel.trust, frame.of(q), pixel.value});
            }
        }
    }
}

Bounds bounds_of(const std::vector<Sample>& samples, double least_weight) {
    constexpr double kRoom = 0.3;
    Bounds bounds{glm::dvec3(std::numeric_limits<double>::max()),
                  glm::dvec3(std::numeric_limits<double>::lowest())};
    for (const Sample& sample : samples) {
        if (sample.weight < least_weight) continue;
        bounds.least = glm::min(bounds.least, sample.value);
        bounds.most = glm::max(bounds.most, sample.value);
    }
    const glm::dvec3 room = kRoom * (bounds.most - bounds.least);
    // Light is not negative: where no sample is, no value is.
    const glm::dvec3 floor = glm::min(bounds.least, glm::dvec3(0.0));
    return {glm::max(bounds.least - room, floor), bounds.most + room};
}

/// Drops samples of far less quality than the best: however light, one of them at the end of a row
/// would bend a polynomial that nothing else holds there. Returns the largest weight.
double keep_the_best(std::vector<Sample>& samples) {
    constexpr double kLeastQuality = 0.1;  // of the best
    double best = 0;
    for (const Sample& sample : samples) best = std::max(best, sample.quality);
    std::erase_if(samples, [&](const Sample& s) { return s.quality < kLeastQuality * best; });
    double largest = 0;
    for (const Sample& sample : samples) largest = std::max(largest, sample.weight);
    return largest;
}

Fit GuidedFit::fit(const Surfel& centre, std::vector<Sample>& samples) const {
    constexpr double kCounts = 0.01;  // of the largest weight
    Fit result;
    result.frame = SurfaceFrame(centre);
    if (samples.empty()) return result;
    const double largest = keep_the_best(samples);
    NormalEquations equations;
    int count = 0;
    for (const Sample& sample : samples) {
        equations.add(sample.weight / largest, sample.at.x, sample.at.y, sample.value);
        count += sample.weight >= kCounts * largest ? 1 : 0;
    }
    const Bounds bounds = bounds_of(samples, kCounts * largest);
    std::array<glm::dvec3, kMostTerms> coefficients{};
    for (int order = order_; order >= 0; --order) {
        const bool is_supported = order == 0 || count >= 2 * terms_of(order) + 1;
        if (!is_supported || !equations.solve(terms_of(order), coefficients)) continue;
        const bool is_sound = bounds.hold(coefficients[0]) &&
                              std::ranges::all_of(coefficients, [](const glm::dvec3& c) {
                                  return is_finite(glm::vec3(c));
                              });
        if (order > 0 && !is_sound) continue;
        result.order = order;
        break;
    }
    if (result.order < 0 || !is_finite(coefficients[0])) return result;
    for (std::size_t i = 0; i < coefficients.size(); ++i)
        result.coefficients[i] = glm::vec3(coefficients[i]);
    result.least = glm::vec3(bounds.least);
    result.most = glm::vec3(bounds.most);
    return result;
}

void GuidedFit::blend(const Surfel& p, int u, int v, double weight, glm::dvec4& sum) const {
    std::size_t index = input_.surfels().index(u, v);
    for (const Surfel& q : input_.surfels().at(u, v)) {
        const Fit& fit = fits_[index++];
        if (fit.order < 0) continue;
        const double w = weight * static_cast<double>(q.coverage * likeness<kNormalPower>(q, p));
        const glm::dvec4 weighted = w * glm::dvec4(fit.at(p), 1.0);
        if (w > 0 && std::isfinite(glm::dot(weighted, glm::dvec4(1.0)))) sum += weighted;
    }
}

glm::dvec3 GuidedFit::operator()(const Surfel& p, int x, int y, GuidedOutcome& outcome) const {
    const Extent low = input_.low_size();
    const double place_x = (x + 0.5) * low.width / size_.width - 0.5;
    const double place_y = (y + 0.5) * low.height / size_.height - 0.5;
    const int column = corresponding(x, size_.width, low.width);
    const int row = corresponding(y, size_.height, low.height);
    const glm::dvec3 emission(p.emission);
    glm::dvec4 sum(0.0);
    for (int v = std::max(row - 1, 0); v <= std::min(row + 1, low.height - 1); ++v) {
        for (int u = std::max(column - 1, 0); u <= std::min(column + 1, low.width - 1); ++u) {
            if (window_ == 1 && (u != column || v != row)) continue;
            const double weight = std::max(1.0 - std::abs(place_x - u), 0.0) *
                                  std::max(1.0 - std::abs(place_y - v), 0.0);
            if (weight > 0) blend(p, u, v, weight, sum);
        }
    }
    const glm::dvec3 modulation(p.modulation);
    if (sum.w > kLeastWeight) return emission + modulation * glm::dvec3(sum) / sum.w;
    outcome.fell_back = true;
    if (irradiance_(column, row).trust > 0)
        return emission + modulation * irradiance_(column, row).value;
    const auto mean = mean_around(column, row, low, window_, [&](int u, int v) {
        const PixelIrradiance& pixel = irradiance_(u, v);
        return pixel.trust > 0 ? pixel.value : glm::dvec3(std::numeric_limits<double>::quiet_NaN());
    });
    if (!mean) outcome.non_finite = true;
    return emission + modulation * mean.value_or(glm::dvec3(0.0));
}

}  // namespace

Reconstruction guided_fit(const GuidedTask& task) {
    const GuidedInput input(task);
    const GuidedFit fits(task, input);
    Reconstruction result = resolve_pixels(task, input, fits);
    result.fits_of_order = fits.orders();
    return result;
}

}  // namespace vecino
