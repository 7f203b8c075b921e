// SPDX-License-Identifier: Apache-2.0
#include "core/light_tree.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>

#include "core/color.h"

namespace vecino {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPi = std::numbers::pi;

/// Directions within an angle of an axis.
struct Cone {
    glm::dvec3 axis{0.0, 0.0, 1.0};
    double angle = kPi;
};

/// The smallest cone with one axis turned towards the other that holds both.
Cone join(const Cone& a, const Cone& b) {
    const double between = std::acos(std::clamp(glm::dot(a.axis, b.axis), -1.0, 1.0));
    if (between + b.angle <= a.angle) return a;
    if (between + a.angle <= b.angle) return b;
    const double angle = 0.5 * (a.angle + between + b.angle);
    const glm::dvec3 across = b.axis - a.axis * glm::dot(a.axis, b.axis);
    if (angle >= kPi || glm::length(across) < 1e-9) return {};
    const double turn = angle - a.angle;
    return {a.axis * std::cos(turn) + glm::normalize(across) * std::sin(turn), angle};
}

/// What a node knows of the emitters below it.
struct Bounds {
    glm::dvec3 low{kInfinity}, high{-kInfinity};
    Cone cone{{0.0, 0.0, 1.0}, -1.0};  ///< a negative angle: no emitter yet
    double power = 0;

    void add(const Bounds& other) {
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
        cone = cone.angle < 0 ? other.cone : join(cone, other.cone);
        power += other.power;
    }
    [[nodiscard]] glm::dvec3 center() const { return 0.5 * (low + high); }
    [[nodiscard]] double radius() const { return 0.5 * glm::length(high - low); }
};

glm::dvec3 vector(const float (&v)[3]) {
    return {v[0], v[1], v[2]};
}

Bounds bounds_of(const LightRecord& light) {
    Bounds bounds;
    const double radiance = luminance(light.radiance);
    const glm::dvec3 origin = vector(light.origin);
    if (light.kind == LightKind::sphere) {
        bounds.low = origin - static_cast<double>(light.radius);
        bounds.high = origin + static_cast<double>(light.radius);
        bounds.cone = {};
        // It looks like a disc: a quarter of its surface.
        bounds.power = 0.25 * radiance * static_cast<double>(light.area);
        return bounds;
    }
    const glm::dvec3 ends[] = {origin + vector(light.edge1), origin + vector(light.edge2),
                               origin + vector(light.edge1) + vector(light.edge2)};
    bounds.low = glm::min(origin, glm::min(ends[0], ends[1]));
    bounds.high = glm::max(origin, glm::max(ends[0], ends[1]));
    if (light.kind != LightKind::triangle) {
        bounds.low = glm::min(bounds.low, ends[2]);
        bounds.high = glm::max(bounds.high, ends[2]);
    }
    bounds.cone = {vector(light.normal), 0.0};
    bounds.power = radiance * static_cast<double>(light.area);
    return bounds;
}

/// How much light a node may send where it does not matter: power times the size of its directions
/// and its surface (the "surface area orientation heuristic").
double cost(const Bounds& bounds) {
    if (bounds.power <= 0) return 0;
    const double angle = bounds.cone.angle;
    const double reach = std::min(angle + kPi / 2, kPi);
    const double directions = 2 * kPi * (1 - std::cos(angle)) +
                              kPi / 2 *
                                  (2 * reach * std::sin(angle) - std::cos(angle - 2 * reach) -
                                   2 * angle * std::sin(angle) + std::cos(angle));
    const glm::dvec3 side = bounds.high - bounds.low;
    return bounds.power * directions * 2 *
           (side.x * side.y + side.y * side.z + side.z * side.x + 0.01 * glm::dot(side, side));
}

constexpr int kBuckets = 12;
constexpr int kMostDepth = 31;  ///< the bits of a trail

class Builder {
  public:
    explicit Builder(std::vector<LightRecord>& lights) : lights_(lights) {
        for (const LightRecord& light : lights) bounds_.push_back(bounds_of(light));
        const std::size_t nodes = 2 * lights.size() - 1;
        table_.count = static_cast<std::uint32_t>(nodes);
        table_.stride = table_.count + 32;  // so that the first 32 can always be read
        table_.fields.assign(std::size_t{table_.stride} * kLightNodeFields, 0.0f);
    }

    LightTreeTable run() {
        std::vector<std::uint32_t> all(lights_.size());
        std::iota(all.begin(), all.end(), 0u);
        add_node(all, 0, 0);
        return std::move(table_);
    }

  private:
    // Nodes are written depth first: a node's first child is the one after it.
    void add_node(std::span<std::uint32_t> lights, int depth, std::uint32_t trail) {
        Bounds bounds;
        for (const std::uint32_t light : lights) bounds.add(bounds_[light]);
        const std::uint32_t node = next_++;
        write(node, bounds);
        if (lights.size() == 1) {
            lights_[lights[0]].trail = trail;
            set(node, kLightNodeNext, std::bit_cast<float>(~lights[0]));
            return;
        }
        const std::size_t half = split(lights, bounds, depth);
        add_node(lights.first(half), depth + 1, trail);
        set(node, kLightNodeNext, std::bit_cast<float>(next_));
        add_node(lights.subspan(half), depth + 1, trail | (1u << depth));
    }

    /// Orders lights so that those of the first child come first; returns how many.
    std::size_t split(std::span<std::uint32_t> lights, const Bounds& bounds, int depth) const {
        const glm::dvec3 side = bounds.high - bounds.low;
        double least = kInfinity;
        int axis = 0;
        int bucket = -1;
        // Halves from here on would still fit the trail.
        const bool is_shallow =
            depth + static_cast<int>(std::bit_width(lights.size())) < kMostDepth;
        for (int k = 0; k < 3 && is_shallow; ++k) {
            const double longest = std::max({side.x, side.y, side.z});
            const auto costs = split_costs(lights, bounds, k);
            for (int b = 0; b + 1 < kBuckets; ++b) {
                const double here = costs[static_cast<std::size_t>(b)] * longest / side[k];
                if (!(here < least)) continue;
                least = here;
                axis = k;
                bucket = b;
            }
        }
        if (bucket < 0) return lights.size() / 2;
        // not std::ranges: Clang up to 15 cannot read the subranges of libstdc++
        const auto middle = std::stable_partition(lights.begin(), lights.end(), [&](auto light) {
            return bucket_of(light, bounds, axis) <= bucket;
        });
        return static_cast<std::size_t>(middle - lights.begin());
    }

    /// Of splits after each bucket along an axis; infinite where a side would be empty.
    [[nodiscard]] std::array<double, kBuckets> split_costs(std::span<const std::uint32_t> lights,
                                                           const Bounds& bounds, int axis) const {
        std::array<double, kBuckets> costs;
        costs.fill(kInfinity);
        if (!(bounds.high[axis] > bounds.low[axis])) return costs;
        std::array<Bounds, kBuckets> buckets;
        std::array<std::size_t, kBuckets> counts{};
        for (const std::uint32_t light : lights) {
            const auto b = static_cast<std::size_t>(bucket_of(light, bounds, axis));
            buckets[b].add(bounds_[light]);
            ++counts[b];
        }
        std::array<double, kBuckets> cost_above{};  // of all buckets after one
        Bounds above;
        for (std::size_t b = kBuckets - 1; b > 0; --b) {
            if (counts[b] > 0) above.add(buckets[b]);
            cost_above[b - 1] = cost(above);
        }
        Bounds below;
        std::size_t count = 0;
        for (std::size_t b = 0; b + 1 < kBuckets; ++b) {
            if (counts[b] > 0) below.add(buckets[b]);
            count += counts[b];
            if (count > 0 && count < lights.size()) costs[b] = cost(below) + cost_above[b];
        }
        return costs;
    }

    [[nodiscard]] int bucket_of(std::uint32_t light, const Bounds& bounds, int axis) const {
        const double place = (bounds_[light].center()[axis] - bounds.low[axis]) /
                             (bounds.high[axis] - bounds.low[axis]);
        return std::clamp(static_cast<int>(kBuckets * place), 0, kBuckets - 1);
    }

    void set(std::uint32_t node, int field, float value) {
        table_.fields[static_cast<std::size_t>(field) * table_.stride + node] = value;
    }
    void set(std::uint32_t node, int field, double value) {
        set(node, field, static_cast<float>(value));
    }

    void write(std::uint32_t node, const Bounds& bounds) {
        // Rounding must not leave an emitter out of its node.
        constexpr double kSlack = 1 + 1e-5;
        const double radius = kSlack * bounds.radius();
        const double angle = std::min(bounds.cone.angle + 1e-4, kPi);
        for (int k = 0; k < 3; ++k) {
            set(node, kLightNodeCenter + k, bounds.center()[k]);
            set(node, kLightNodeAxis + k, bounds.cone.axis[k]);
        }
        set(node, kLightNodeRadius2, radius * radius);
        set(node, kLightNodeCosine, std::cos(angle));
        set(node, kLightNodeSine, std::sin(angle));
        set(node, kLightNodePower, bounds.power);
    }

    std::vector<LightRecord>& lights_;
    std::vector<Bounds> bounds_;
    LightTreeTable table_;
    std::uint32_t next_ = 0;
};

}  // namespace

LightTreeTable build_light_tree(std::vector<LightRecord>& lights) {
    if (lights.empty()) return {};
    return Builder(lights).run();
}

}  // namespace vecino
