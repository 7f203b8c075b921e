// SPDX-License-Identifier: Apache-2.0
//
// Low-res frames that ask much of a scheme, and the ways to call one: every combination of the
// options it reads.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "core/frame.h"
#include "filters/schemes.h"

namespace vecino {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

enum class FrameContent {
    benign,   ///< finite colours, no two hits in one place, no misses
    awkward,  ///< misses, coincident hits and non-finite colours
    hostile,  ///< non-finite positions and normals too
};

/// The same numbers on every machine, unlike the distributions of the standard library.
class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    float unit() { return static_cast<float>(engine_() >> 8) * 0x1p-24f; }
    glm::vec3 vector() {
        const float x = unit();
        const float y = unit();
        return {x, y, unit()};
    }
    bool chance(float probability) { return unit() < probability; }

  private:
    std::mt19937 engine_;
};

inline void spoil(Frame& frame, int x, int y, Random& random) {
    if (random.chance(0.15f)) frame.object_id(x, y) = kMiss;
    if (random.chance(0.05f)) frame.radiance(x, y)[x % 3] = kNaN;
    if (random.chance(0.05f)) frame.radiance(x, y)[x % 3] = kInfinity;
    if (random.chance(0.5f)) {
        // Few distinct places: windows in which all hits coincide happen.
        const glm::vec3 p = frame.position_world(x, y);
        frame.position_world(x, y) = {x / 5 % 2 == 0 ? 0.0f : p.x, 0.0f, 0.0f};
    }
}

inline void poison(Frame& frame, int x, int y, Random& random) {
    if (random.chance(0.01f)) frame.position_world(x, y).y = kNaN;
    if (random.chance(0.01f)) frame.position_world(x, y).z = kInfinity;
    if (random.chance(0.01f)) frame.normal_world(x, y).x = kNaN;
    if (random.chance(0.02f)) frame.normal_world(x, y) = glm::vec3(0.0f);
}

/// All planes that a scheme may read. Normals point one of two ways, give or take a little.
inline Frame random_frame(Extent size, FrameContent content, unsigned seed = 1) {
    Random random(seed);
    Frame frame;
    frame.radiance = Image(size);
    frame.position_world = Grid<glm::vec3>(size);
    frame.normal_world = Grid<glm::vec3>(size);
    frame.object_id = Grid<std::int32_t>(size, 0);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            frame.radiance(x, y) = 0.01f + random.vector();
            frame.position_world(x, y) = random.vector() - 0.5f;
            const glm::vec3 axis = random.chance(0.7f) ? glm::vec3(0, 0, 1) : glm::vec3(0, 1, 0);
            const glm::vec3 normal = axis + 0.4f * (random.vector() - 0.5f);
            frame.normal_world(x, y) =
                normal / std::sqrt(normal.x * normal.x + normal.y * normal.y + normal.z * normal.z);
            if (content != FrameContent::benign) spoil(frame, x, y, random);
            if (content == FrameContent::hostile) poison(frame, x, y, random);
        }
    }
    return frame;
}

/// Every combination of the options that a scheme reads, at one window.
inline std::vector<SchemeParameters> parameters_of(const Scheme& scheme, int window) {
    std::vector<SchemeParameters> all;
    const auto choices = [&](const char* option, int count) {
        return scheme.reads(option) ? count : 1;
    };
    for (int order = 0; order < choices("order", 3); ++order) {
        SchemeParameters parameters = scheme.defaults;
        parameters.window = window;
        parameters.order = order;
        if (scheme.uses_guide()) all.push_back(parameters);
    }
    if (scheme.uses_guide()) return all;
    for (int weighting = 0; weighting < choices("weighting", 3); ++weighting) {
        for (int metric = 0; metric < choices("metric", 2); ++metric) {
            for (int centre = 0; centre < choices("use_centre", 2); ++centre) {
                SchemeParameters parameters;
                parameters.window = window;
                parameters.weighting = static_cast<Weighting>(weighting);
                parameters.metric = static_cast<Metric>(metric);
                parameters.use_centre = centre == 0;
                all.push_back(parameters);
            }
        }
    }
    return all;
}

/// "distance3d.w7.inverse.no_centre", for messages.
inline std::string cell_name(const Scheme& scheme, const SchemeParameters& parameters) {
    std::string name(scheme.name);
    for (const std::string_view option : scheme.options) {
        name += "." + find_scheme_option(option).slug(parameters);
    }
    return name;
}

/// A guide that shows in every pixel what the corresponding low-res pixel shows.
inline Frame replicated_guide(const Frame& low, Extent size) {
    Frame guide;
    guide.position_world = Grid<glm::vec3>(size);
    guide.normal_world = Grid<glm::vec3>(size);
    guide.object_id = Grid<std::int32_t>(size);
    for (int y = 0; y < size.height; ++y) {
        const int v = corresponding(y, size.height, low.size().height);
        for (int x = 0; x < size.width; ++x) {
            const int u = corresponding(x, size.width, low.size().width);
            guide.position_world(x, y) = low.position_world(u, v);
            guide.normal_world(x, y) = low.normal_world(u, v);
            guide.object_id(x, y) = low.object_id(u, v);
        }
    }
    return guide;
}

/// Schemes that take a guide get one of the frame's own planes, where size is a sound one.
inline Reconstruction rebuild(const Frame& low, const Scheme& scheme,
                              const SchemeParameters& parameters, Extent size, int threads = 1) {
    if (!scheme.uses_guide()) return reconstruct(low, scheme, {size, parameters, threads});
    const Frame guide = replicated_guide(low, size);
    return reconstruct(low, scheme, {size, parameters, threads, &guide});
}

inline bool same_bits(const Image& a, const Image& b) {
    return a.size() == b.size() && std::memcmp(a.values().data(), b.values().data(),
                                               a.size().area() * sizeof(glm::vec3)) == 0;
}

inline bool all_finite(const Image& image) {
    for (const glm::vec3& color : image.values()) {
        for (int c = 0; c < 3; ++c) {
            if (!std::isfinite(color[c])) return false;
        }
    }
    return true;
}

/// The largest difference of two channel values, relative to the larger of them.
inline double relative_difference(const Image& a, const Image& b) {
    double largest = 0.0;
    for (std::size_t i = 0; i < a.values().size(); ++i) {
        for (int c = 0; c < 3; ++c) {
            const auto p = static_cast<double>(a.values()[i][c]);
            const auto q = static_cast<double>(b.values()[i][c]);
            if (p != q)
                largest = std::max(largest, std::abs(p - q) / std::max(std::abs(p), std::abs(q)));
        }
    }
    return largest;
}

}  // namespace vecino
