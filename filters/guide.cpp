// SPDX-License-Identifier: Apache-2.0
#include "filters/guide.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>

#include "core/error.h"

namespace vecino {
namespace {

/// Beyond it there is no surface: Blender writes 1e10.
constexpr float kFarthest = 1e9f;

[[noreturn]] void fault(const std::string& file, const std::string& found,
                        const std::string& allowed) {
    throw Error(ExitCode::mismatch, file + ": found " + found + ", allowed: " + allowed);
}

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.4g", value);
    return text;
}

double median_of(std::vector<float> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return static_cast<double>(*middle);
}

bool is_far(float distance) {
    return !(std::abs(distance) < kFarthest);  // NaN too
}

/// Lengths of all that is not zero.
std::vector<float> lengths(const Grid<glm::vec3>& plane, float scale, float offset) {
    std::vector<float> found;
    for (const glm::vec3& v : plane.values()) {
        if (is_finite(v) && v != glm::vec3(0.0f)) found.push_back(glm::length(scale * v + offset));
    }
    return found;
}

/// The share of lengths that are 1. Where surfaces meet, averaged normals are shorter.
double unit_share(const std::vector<float>& found) {
    constexpr float kTolerance = 0.02f;
    const auto is_unit = [](float length) { return std::abs(length - 1.0f) < kTolerance; };
    return static_cast<double>(std::ranges::count_if(found, is_unit)) /
           static_cast<double>(std::max<std::size_t>(found.size(), 1));
}

/// Unit vectors, or zeros: what is shorter than half was averaged over surfaces that face apart.
void normalise(Grid<glm::vec3>& plane) {
    for (glm::vec3& v : plane.values()) {
        if (!is_finite(v)) continue;
        const float length = glm::length(v);
        v = length > 0.5f ? v / length : glm::vec3(0.0f);
    }
}

void check_normals(Frame& guide, const std::string& file, std::vector<std::string>& notes) {
    constexpr double kLeastShare = 0.5;
    Grid<glm::vec3>& plane = guide.normal_world;
    const auto plain = lengths(plane, 1.0f, 0.0f);
    if (plain.empty()) fault(file, "no normal that is not 0", "normals of unit length");
    if (unit_share(plain) < kLeastShare) {
        if (unit_share(lengths(plane, 2.0f, -1.0f)) < kLeastShare) {
            const auto [least, most] = std::ranges::minmax(plain);
            fault(file,
                  "normals of length " + number(static_cast<double>(least)) + " to " +
                      number(static_cast<double>(most)) + ", in the middle " +
                      number(median_of(plain)),
                  "unit length, or unit normals encoded as (n + 1) / 2");
        }
        for (glm::vec3& v : plane.values()) {
            if (v != glm::vec3(0.0f)) v = 2.0f * v - 1.0f;
        }
        notes.push_back(file + ": its normals are encoded as (n + 1) / 2 and were decoded");
    }
    normalise(plane);
}

bool is_miss(const Frame& guide, int x, int y) {
    if (!guide.object_id.empty() && guide.object_id(x, y) == kMiss) return true;
    if (!guide.normal_world.empty() && guide.normal_world(x, y) == glm::vec3(0.0f)) return true;
    return !guide.distance_world.empty() &&
           (guide.distance_world(x, y) == 0.0f || is_far(guide.distance_world(x, y)));
}

/// Cosines, without sign, of normals to those that follow from positions, where three neighbours
/// are of one surface.
std::vector<float> cosines_to_positions(const Frame& guide) {
    std::vector<float> found;
    const Extent size = guide_size(guide);
    for (int y = 0; y + 1 < size.height; ++y) {
        for (int x = 0; x + 1 < size.width; ++x) {
            if (is_miss(guide, x, y) || is_miss(guide, x + 1, y) || is_miss(guide, x, y + 1))
                continue;
            const glm::vec3 n = guide.normal_world(x, y);
            const glm::dvec3 p(guide.position_world(x, y));
            const bool is_smooth = glm::dot(n, guide.normal_world(x + 1, y)) > 0.98f &&
                                   glm::dot(n, guide.normal_world(x, y + 1)) > 0.98f;
            const glm::dvec3 across = glm::cross(glm::dvec3(guide.position_world(x + 1, y)) - p,
                                                 glm::dvec3(guide.position_world(x, y + 1)) - p);
            const double length = glm::length(across);
            if (is_smooth && length > 0 && std::isfinite(length))
                found.push_back(
                    static_cast<float>(std::abs(glm::dot(across, glm::dvec3(n))) / length));
        }
    }
    return found;
}

void check_coordinates(const Frame& guide, const std::string& file) {
    constexpr double kLeastCosine = 0.8;
    constexpr std::size_t kFewest = 16;
    const auto cosines = cosines_to_positions(guide);
    if (cosines.size() < kFewest) return;  // too few to tell
    const double middle = median_of(cosines);
    if (middle >= kLeastCosine) return;
    fault(file,
          "normals with a cosine of " + number(middle) +
              " (median) to those of the surfaces that the positions describe",
          number(kLeastCosine) +
              " and more: both planes in one coordinate system, with the same axes");
}

void check_positions(const Frame& guide, const std::string& file) {
    const auto& values = guide.position_world.values();
    if (values.size() > 1 &&
        std::ranges::all_of(values, [&](const glm::vec3& p) { return p == values.front(); }))
        fault(file, "one position everywhere", "where each pixel's surface is");
}

void check_distances(Frame& guide, const std::string& file) {
    std::size_t below = 0;
    std::size_t above = 0;
    float least = 0;
    float most = 0;
    for (float& distance : guide.distance_world.values()) {
        if (is_far(distance)) distance = 0.0f;
        below += distance < 0 ? 1 : 0;
        above += distance > 0 ? 1 : 0;
        least = std::min(least, distance);
        most = std::max(most, distance);
    }
    if (below > 0 && above > 0)
        fault(file,
              "distances from " + number(static_cast<double>(least)) + " to " +
                  number(static_cast<double>(most)),
              "distances from the camera, all of one sign");
    if (below + above == 0) fault(file, "no distance but 0 and infinity", "some of surfaces");
    if (below == 0) return;
    for (float& distance : guide.distance_world.values()) distance = -distance;
}

void check_albedo(const Frame& guide, const std::string& file) {
    constexpr float kMost = 1.05f;
    float least = 0;
    float most = 0;
    std::size_t beyond = 0;
    for (const glm::vec3& a : guide.albedo.values()) {
        if (!is_finite(a)) continue;
        least = std::min({least, a.x, a.y, a.z});
        const float largest = std::max({a.x, a.y, a.z});
        most = std::max(most, largest);
        beyond += largest > kMost ? 1 : 0;
    }
    // A lamp may have its own radiance for an albedo; a wrong scale shows everywhere.
    const bool is_scaled = beyond > guide.albedo.size().area() / 4;
    if (least < 0 || is_scaled)
        fault(file,
              "albedo from " + number(static_cast<double>(least)) + " to " +
                  number(static_cast<double>(most)),
              "0 to 1");
}

void check_emission(const Frame& guide, const std::string& file) {
    for (const glm::vec3& e : guide.emission.values()) {
        const float least = std::min({e.x, e.y, e.z});
        if (least < 0)
            fault(file, "emission of " + number(static_cast<double>(least)), "0 and more");
    }
}

/// Ids tell misses apart, where there are any.
void mark_misses(Frame& guide) {
    if (guide.object_id.empty()) return;
    const Extent size = guide_size(guide);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            if (is_miss(guide, x, y)) guide.object_id(x, y) = kMiss;
        }
    }
}

}  // namespace

Extent guide_size(const Frame& guide) {
    for (const PlaneInfo& plane : all_planes()) {
        const bool is_read = kGuidePlanes.has(plane.plane);
        const Extent size =
            std::visit([&](auto member) { return (guide.*member).size(); }, plane.member);
        if (is_read && size.area() > 0) return size;
    }
    return {};
}

void require_guide(const Frame& guide, Extent size, const std::string& name) {
    const Planes held = planes_of(guide);
    const Planes telling{Plane::position, Plane::normal, Plane::distance, Plane::id};
    const Extent found = guide_size(guide);
    bool tells = false;
    for (const PlaneInfo& plane : all_planes()) {
        if (!held.has(plane.plane) || !kGuidePlanes.has(plane.plane)) continue;
        tells = tells || telling.has(plane.plane);
        const Extent own =
            std::visit([&](auto member) { return (guide.*member).size(); }, plane.member);
        if (own != found)
            fault(name, "plane \"" + std::string(plane.name) + "\" of " + size_text(own),
                  size_text(found) + ", as the others");
    }
    if (!tells)
        fault(name, "none of the planes position, normal, distance and id",
              "one of them at least (--channel says what a file calls them)");
    const bool is_multiple = found.width % size.width == 0 && found.height % size.height == 0 &&
                             found.width / size.width == found.height / size.height;
    if (!is_multiple)
        fault(name, "a guide of " + size_text(found),
              size_text(size) + " or a whole multiple of it");
}

std::vector<std::string> check_guide(Frame& guide, const std::string& file) {
    std::vector<std::string> notes;
    if (!guide.distance_world.empty()) check_distances(guide, file);
    if (!guide.normal_world.empty()) check_normals(guide, file, notes);
    if (!guide.position_world.empty()) check_positions(guide, file);
    if (!guide.position_world.empty() && !guide.normal_world.empty())
        check_coordinates(guide, file);
    check_albedo(guide, file);
    check_emission(guide, file);
    mark_misses(guide);
    return notes;
}

}  // namespace vecino
