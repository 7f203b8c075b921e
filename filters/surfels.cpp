// SPDX-License-Identifier: Apache-2.0
#include "filters/surfels.h"

#include <limits>

#include "core/parallel.h"
#include "filters/guide.h"

namespace vecino {
namespace {

constexpr std::size_t kRowsPerBlock = 2;
constexpr double kLeastShare = 1e-9;  // of a pixel: less is rounding
constexpr float kLeastAlbedo = 0.01f;
constexpr int kPurityPower = 16;
constexpr std::size_t kMostSurfels = 8;  ///< in a pixel; the last one takes in what comes after

float largest(const glm::vec3& v) {
    return std::max({v.x, v.y, v.z});
}

/// Whether a guide pixel belongs to a surfel that another one began.
bool is_same_surface(const Surfel& surfel, const Surfel& pixel) {
    constexpr float kLeastCosine = 0.9f;
    constexpr float kMostFootprints = 0.5;
    if (surfel.kind != pixel.kind || surfel.id != pixel.id) return false;
    if (surfel.kind == SurfelKind::miss || surfel.kind == SurfelKind::broken) return true;
    if (surfel.normal != glm::vec3(0.0f) && !(glm::dot(surfel.normal, pixel.normal) > kLeastCosine))
        return false;
    return distance_from_plane(surfel, pixel) < kMostFootprints;
}

/// A surfel while guide pixels are added to it.
struct Gathered {
    Surfel first;
    glm::dvec3 position{0.0}, normal{0.0}, modulation{0.0}, emission{0.0};
    glm::dvec2 place{0.0}, inverse_slope{0.0};
    double inverse_distance = 0;
    double weight = 0;
    double slope_weight = 0;
    float inverse_footprint = 0;

    void add(const Surfel& pixel, double w) {
        position += w * glm::dvec3(pixel.position);
        normal += w * glm::dvec3(pixel.normal);
        modulation += w * glm::dvec3(pixel.modulation);
        emission += w * glm::dvec3(pixel.emission);
        place += w * glm::dvec2(pixel.place);
        weight += w;
        // Whichever pixel came first: the least footprint, the mean slope.
        inverse_footprint = std::max(inverse_footprint, pixel.inverse_footprint);
        inverse_distance += w * static_cast<double>(pixel.inverse_distance);
        if (pixel.inverse_slope == glm::vec2(0.0f)) return;
        inverse_slope += w * glm::dvec2(pixel.inverse_slope);
        slope_weight += w;
    }
    /// The mean. A single pixel stays as it is, to the bit.
    [[nodiscard]] Surfel surfel(double whole) const {
        Surfel result = first;
        result.coverage = static_cast<float>(weight / whole);
        result.purity = power_of(result.coverage, kPurityPower);
        result.position = glm::vec3(position / weight);
        result.modulation = glm::vec3(modulation / weight);
        result.emission = glm::vec3(emission / weight);
        result.place = glm::vec2(place / weight);
        const double length = glm::length(normal);
        if (length > 0) result.normal = glm::vec3(normal / length);
        result.inverse_footprint = inverse_footprint;
        result.inverse_distance = static_cast<float>(inverse_distance / weight);
        if (slope_weight > 0) result.inverse_slope = glm::vec2(inverse_slope / slope_weight);
        return result;
    }
};

/// The guide pixels that a pixel of a coarser grid overlaps along one axis.
struct Overlap {
    int begin, end;
    double low, high;  ///< borders, in guide pixels

    Overlap(int cell, int cells, int pixels)
        : begin(static_cast<int>(1LL * cell * pixels / cells)),
          end(static_cast<int>(((cell + 1LL) * pixels + cells - 1) / cells)),
          low(static_cast<double>(cell) * pixels / cells),
          high(static_cast<double>(cell + 1) * pixels / cells) {}

    [[nodiscard]] double share(int pixel) const {
        return std::min(high, pixel + 1.0) - std::max(low, static_cast<double>(pixel));
    }
};

/// Adds a part of a pixel to the surfel that it belongs to; complete() makes it the first of a new
/// one.
template <class Complete>
void gather(std::vector<Gathered>& found, const Surfel& part, double weight,
            const Complete& complete) {
    auto same = std::ranges::find_if(
        found, [&](const Gathered& each) { return is_same_surface(each.first, part); });
    if (same != found.end()) return same->add(part, weight);
    if (found.size() == kMostSurfels) return found.back().add(part, weight);
    Surfel first = part;
    complete(first);
    found.push_back({first});
    found.back().add(first, weight);
}

/// The pixels of a guide, as what low-resolution pixels are made of.
struct GuideSource {
    const GuideView& guide;

    [[nodiscard]] Extent size() const { return guide.size(); }
    void gather_pixel(int x, int y, double weight, std::vector<Gathered>& found) const {
        Surfel sample = guide.sample(x, y);
        guide.fill_slopes(sample, x, y);
        gather(found, sample, weight, [](Surfel&) {});
    }
};

/// The same where a pixel has many: the first of a surface alone is asked for what its neighbours
/// tell.
struct FineGuideSource {
    const GuideView& guide;

    [[nodiscard]] Extent size() const { return guide.size(); }
    void gather_pixel(int x, int y, double weight, std::vector<Gathered>& found) const {
        gather(found, guide.sample(x, y), weight,
               [&](Surfel& first) { guide.fill_slopes(first, x, y); });
    }
};

/// The surfels of a finer grid.
struct GridSource {
    const SurfelGrid& grid;

    [[nodiscard]] Extent size() const { return grid.size(); }
    void gather_pixel(int x, int y, double weight, std::vector<Gathered>& found) const {
        for (const Surfel& part : grid.at(x, y))
            gather(found, part, weight * static_cast<double>(part.coverage), [](Surfel&) {});
    }
};

}  // namespace

GuideView::GuideView(const Frame& guide, Extent low)
    : guide_(guide),
      size_(guide_size(guide)),
      low_per_pixel_(static_cast<float>(low.width) / static_cast<float>(size_.width),
                     static_cast<float>(low.height) / static_cast<float>(size_.height)) {}

bool GuideView::is_inside(int x, int y) const {
    return x >= 0 && y >= 0 && x < size_.width && y < size_.height;
}

bool GuideView::is_miss(int x, int y) const {
    if (!guide_.object_id.empty()) return guide_.object_id(x, y) == kMiss;
    if (!guide_.normal_world.empty()) return guide_.normal_world(x, y) == glm::vec3(0.0f);
    return !guide_.distance_world.empty() && guide_.distance_world(x, y) == 0.0f;
}

/// To a neighbour on what may be the same surface; zeros where there is none.
glm::dvec3 GuideView::step_between(int x, int y, int dx, int dy) const {
    constexpr glm::dvec3 kNone(0.0);
    const int u = x + dx;
    const int v = y + dy;
    if (!is_inside(u, v) || is_miss(u, v)) return kNone;
    if (!guide_.object_id.empty() && guide_.object_id(x, y) != guide_.object_id(u, v)) return kNone;
    const glm::dvec3 step =
        glm::dvec3(guide_.position_world(u, v)) - glm::dvec3(guide_.position_world(x, y));
    return std::isfinite(step.x + step.y + step.z) ? step : kNone;
}

float GuideView::inverse_distance(int x, int y) const {
    const float distance = is_inside(x, y) ? guide_.distance_world(x, y) : 0.0f;
    return distance > 0 && std::isfinite(distance) ? 1.0f / distance : 0.0f;
}

namespace {

/// The shorter of two steps that are not 0: across an edge they are long.
glm::dvec3 shorter(const glm::dvec3& a, const glm::dvec3& b) {
    const double left = glm::dot(a, a);
    const double right = glm::dot(b, b);
    return right == 0 || (left > 0 && left <= right) ? a : b;
}

/// From the values before, at and after a pixel; 0 is none.
float slope(float last, float here, float next) {
    if (next == 0) return last == 0 ? 0.0f : here - last;
    if (last == 0) return next - here;
    return std::abs(next - here) <= std::abs(here - last) ? next - here : here - last;
}

}  // namespace

/// What neighbours tell: footprint, slope, and the normal if the guide has none.
void GuideView::fill_slopes(Surfel& surfel, int x, int y) const {
    if (surfel.kind == SurfelKind::miss || surfel.kind == SurfelKind::broken) return;
    if (guide_.position_world.empty()) {
        if (guide_.distance_world.empty()) return;
        surfel.inverse_slope = glm::vec2(slope(inverse_distance(x - 1, y), surfel.inverse_distance,
                                               inverse_distance(x + 1, y)),
                                         slope(inverse_distance(x, y - 1), surfel.inverse_distance,
                                               inverse_distance(x, y + 1))) /
                               low_per_pixel_;
        return;
    }
    const glm::dvec3 across = shorter(step_between(x, y, 1, 0), -step_between(x, y, -1, 0));
    const glm::dvec3 down = shorter(step_between(x, y, 0, 1), -step_between(x, y, 0, -1));
    const double wide = glm::length(across) / static_cast<double>(low_per_pixel_.x);
    const double high = glm::length(down) / static_cast<double>(low_per_pixel_.y);
    const double least = wide == 0 ? high : high == 0 ? wide : std::min(wide, high);
    const auto inverse = static_cast<float>(1.0 / least);
    if (least > 0 && std::isfinite(inverse)) surfel.inverse_footprint = inverse;
    if (!guide_.normal_world.empty()) return;
    const glm::dvec3 normal = glm::cross(across, down);
    const double length = glm::length(normal);
    if (length > 0) surfel.normal = glm::vec3(normal / length);
}

void GuideView::fill_geometry(Surfel& surfel, int x, int y) const {
    if (is_miss(x, y)) {
        surfel.kind = SurfelKind::miss;
        surfel.id = kMiss;
        return;
    }
    if (!guide_.object_id.empty()) surfel.id = guide_.object_id(x, y);
    if (!guide_.normal_world.empty()) surfel.normal = guide_.normal_world(x, y);
    if (!guide_.position_world.empty()) {
        surfel.position = guide_.position_world(x, y);
    } else if (!guide_.distance_world.empty()) {
        surfel.inverse_distance = inverse_distance(x, y);
    }
    if (is_finite(surfel.position) && is_finite(surfel.normal)) return;
    surfel = {.place = surfel.place, .id = kMiss, .kind = SurfelKind::broken};
}

void GuideView::fill_colour(Surfel& surfel, int x, int y) const {
    const bool is_surface = surfel.kind == SurfelKind::diffuse;
    if (knows_emission()) {
        const glm::vec3 emission = guide_.emission(x, y);
        if (is_finite(emission)) surfel.emission = emission;
        if (surfel.kind == SurfelKind::miss) surfel.modulation = glm::vec3(0.0f);
    }
    if (!is_surface || guide_.albedo.empty()) return;
    const glm::vec3 albedo = guide_.albedo(x, y);
    if (is_finite(albedo) && largest(albedo) >= kLeastAlbedo) {
        surfel.modulation = albedo;
    } else if (largest(surfel.emission) > 0) {
        surfel.kind = SurfelKind::emitter;
        surfel.modulation = glm::vec3(0.0f);
    } else {
        surfel.kind = SurfelKind::unknown;
    }
}

Surfel GuideView::sample(int x, int y) const {
    Surfel surfel;
    surfel.place = (glm::vec2(x, y) + 0.5f) * low_per_pixel_;
    fill_geometry(surfel, x, y);
    fill_colour(surfel, x, y);
    return surfel;
}

Surfel GuideView::pixel(int x, int y) const {
    Surfel surfel = sample(x, y);
    if (guide_.normal_world.empty()) fill_slopes(surfel, x, y);
    return surfel;
}

template <class Source>
void SurfelGrid::fill(const Source& source, int threads) {
    for_each_block(rows_.size(), kRowsPerBlock, threads, [&](BlockRange block) {
        std::vector<Gathered> found;
        for (std::size_t i = block.begin; i < block.end; ++i) {
            const Overlap rows(static_cast<int>(i), size_.height, source.size().height);
            Row& row = rows_[i];
            row.first.push_back(0);
            for (int cell = 0; cell < size_.width; ++cell) {
                const Overlap columns(cell, size_.width, source.size().width);
                found.clear();
                double whole = 0;
                for (int y = rows.begin; y < rows.end; ++y) {
                    for (int x = columns.begin; x < columns.end; ++x) {
                        const double weight = columns.share(x) * rows.share(y);
                        if (!(weight > kLeastShare)) continue;
                        source.gather_pixel(x, y, weight, found);
                        whole += weight;
                    }
                }
                for (const Gathered& each : found) row.surfels.push_back(each.surfel(whole));
                row.first.push_back(static_cast<std::uint32_t>(row.surfels.size()));
            }
        }
    });
    std::size_t before = 0;
    for (Row& row : rows_) {
        row.before = before;
        before += row.surfels.size();
    }
}

SurfelGrid::SurfelGrid(const GuideView& guide, Extent cells, int threads)
    : size_(cells), rows_(static_cast<std::size_t>(cells.height)) {
    fill(GuideSource{guide}, threads);
}

SurfelGrid SurfelGrid::of_samples(const GuideView& guide, Extent pixels, int threads) {
    SurfelGrid grid;
    grid.size_ = pixels;
    grid.rows_.resize(static_cast<std::size_t>(pixels.height));
    grid.fill(FineGuideSource{guide}, threads);
    return grid;
}

SurfelGrid::SurfelGrid(const SurfelGrid& fine, Extent cells, int threads)
    : size_(cells), rows_(static_cast<std::size_t>(cells.height)) {
    fill(GridSource{fine}, threads);
}

}  // namespace vecino
