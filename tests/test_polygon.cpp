// SPDX-License-Identifier: Apache-2.0
//
// Exact irradiance of emitters cut by the horizon, as the kernels compute it at the narrowest
// packet width, against sums over small patches in double precision.
#define VECINO_WIDTH 4
#include "core/polygon_lanes.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <random>

#include "tests/catch.h"

using namespace vecino;

namespace {

constexpr double kPiD = 3.14159265358979323846;
using Vector = glm::dvec3;

class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double between(double low, double high) {
        return low + (high - low) * (static_cast<double>(engine_()) + 0.5) * 0x1p-32;
    }
    Vector direction() {
        const double z = between(-1, 1);
        const double phi = between(0, 2 * kPiD);
        const double r = std::sqrt(1 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

  private:
    std::mt19937 engine_;
};

Float3 lanes(const Vector& v) {
    return {splat(static_cast<float>(v.x)), splat(static_cast<float>(v.y)),
            splat(static_cast<float>(v.z))};
}

struct FlatShape {
    Vector origin, edge1, edge2;
    bool triangle;
};

/// Irradiance over pi at the origin, by the midpoint rule.
double by_patches(const FlatShape& shape, const Vector& normal) {
    constexpr int kSide = 400;
    const Vector cross = glm::cross(shape.edge1, shape.edge2);
    const Vector light_normal = glm::normalize(cross);
    double sum = 0;
    for (int j = 0; j < kSide; ++j) {
        for (int i = 0; i < kSide; ++i) {
            const double a = (i + 0.5) / kSide;
            const double row = shape.triangle ? 1 - a : 1;  // what of it is in the triangle
            const double b = (j + 0.5) / kSide * row;
            const Vector to = shape.origin + shape.edge1 * a + shape.edge2 * b;
            const double d2 = glm::dot(to, to);
            const double received = std::max(glm::dot(to, normal), 0.0);
            const double sent = std::max(-glm::dot(to, light_normal), 0.0);
            sum += row * received * sent / (d2 * d2);
        }
    }
    return sum * glm::length(cross) / (kSide * kSide) / kPiD;
}

Emitter emitter_of(const FlatShape& shape) {
    Emitter light{};
    const Vector cross = glm::cross(shape.edge1, shape.edge2);
    light.origin = lanes(shape.origin);
    light.edge1 = lanes(shape.edge1);
    light.edge2 = lanes(shape.edge2);
    light.normal = lanes(glm::normalize(cross));
    light.area = splat(static_cast<float>(glm::length(cross) * (shape.triangle ? 0.5 : 1.0)));
    light.triangle = shape.triangle ? ~Mask{} : Mask{};
    return light;
}

double exact(const Emitter& light, const Vector& normal) {
    return static_cast<double>(exact_irradiance(light, Float3{}, lanes(normal))[0]);
}

}  // namespace

TEST_CASE("flat emitters shine as their patches do, above, across and below the horizon",
          "[polygon]") {
    Random random(7);
    const bool triangle = GENERATE(false, true);
    const double size = GENERATE(1.5, 0.05);
    CAPTURE(triangle, size);
    int cut = 0;
    for (int i = 0; i < 60; ++i) {
        const Vector away = random.direction();
        const Vector origin = away * random.between(1, 2);
        const FlatShape shape{origin, random.direction() * size, random.direction() * size,
                              triangle};
        if (glm::length(glm::cross(shape.edge1, shape.edge2)) < 0.3 * size * size) continue;
        const Vector normal = random.direction();
        const double expected = by_patches(shape, normal);
        const Vector far = triangle ? shape.edge2 : shape.edge1 + shape.edge2;
        const bool above = glm::dot(origin, normal) > 0;
        if ((glm::dot(origin + far, normal) > 0) != above) ++cut;
        CAPTURE(i, expected);
        const double tolerance = 2e-3 * expected + 1e-5;
        CHECK(std::abs(exact(emitter_of(shape), normal) - expected) < tolerance);
    }
    CHECK((cut > 0 || size < 1));
}

TEST_CASE("an emitter that faces away sends nothing", "[polygon]") {
    const FlatShape shape{{-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, false};  // emits to +z, away
    CHECK(exact(emitter_of(shape), {0, 0, 1}) == 0.0);
    const FlatShape turned{{-1, -1, 1}, {0, 2, 0}, {2, 0, 0}, false};
    CHECK(exact(emitter_of(turned), {0, 0, 1}) ==
          Approx(by_patches(turned, {0, 0, 1})).epsilon(1e-3));
}

TEST_CASE("spheres shine as sums over their cone do, in full and cut by the horizon", "[polygon]") {
    const double radius = GENERATE(0.02, 0.5, 0.99);
    const double angle =
        GENERATE(0.0, 0.4, 1.2, 1.5, 1.7, 2.0, 2.6);  // of the normal to the centre
    CAPTURE(radius, angle);
    Emitter light{};
    light.origin = lanes({0, 0, 1});
    light.radius = splat(static_cast<float>(radius));
    light.sphere = ~Mask{};
    const Vector normal{std::sin(angle), 0, std::cos(angle)};
    constexpr int kRings = 2000;
    double sum = 0;
    const double cosine = std::sqrt(1 - radius * radius);
    for (int j = 0; j < kRings; ++j) {
        const double z = 1 - (1 - cosine) * (j + 0.5) / kRings;
        for (int i = 0; i < 360; ++i) {
            const double phi = 2 * kPiD * (i + 0.5) / 360;
            const double r = std::sqrt(1 - z * z);
            const Vector to{r * std::cos(phi), r * std::sin(phi), z};
            sum += std::max(glm::dot(to, normal), 0.0);
        }
    }
    const double expected = sum * 2 * kPiD * (1 - cosine) / (kRings * 360) / kPiD;
    CHECK(std::abs(exact(light, normal) - expected) < 2e-3 * expected + 1e-6);
    light.radius = splat(1.01f);  // the point is inside
    CHECK(exact(light, normal) == 0.0);
}
