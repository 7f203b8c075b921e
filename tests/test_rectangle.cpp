// SPDX-License-Identifier: Apache-2.0
//
// Rectangular emitters as the kernels sample them, at the narrowest packet width, against formulas
// and quadrature in double precision.
#define VECINO_WIDTH 4
#include "core/rectangle_lanes.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <random>

#include "tests/catch.h"

using namespace vecino;

namespace {

constexpr double kPiD = 3.14159265358979323846;
using Vector = glm::dvec3;

/// A rectangle seen from the origin, which is the shading point, on its emitting side; and the
/// shading normal.
struct Configuration {
    Vector corner, edge1, edge2, normal;
};

class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double unit() { return (static_cast<double>(engine_()) + 0.5) * 0x1p-32; }
    double between(double low, double high) { return low + (high - low) * unit(); }
    double log_between(double low, double high) { return low * std::pow(high / low, unit()); }
    Vector direction() {
        const double z = between(-1, 1);
        const double phi = between(0, 2 * kPiD);
        const double r = std::sqrt(1 - z * z);
        return {r * std::cos(phi), r * std::sin(phi), z};
    }

  private:
    std::mt19937 engine_;
};

/// Sides of 1 to 5, seen from heights of a thousandth of them to thirty times as much, straight
/// above as well as from beyond the sides.
Configuration random_configuration(Random& random) {
    const Vector x = random.direction();
    const Vector y = glm::normalize(glm::cross(x, random.direction()));
    const double width = random.between(1, 5);
    const double depth = random.between(1, 5);
    const double height = random.log_between(1e-3, 30);
    const Vector foot =
        x * random.between(-2 * width, width) + y * random.between(-2 * depth, depth);
    return {foot - glm::cross(x, y) * height, x * width, y * depth, random.direction()};
}

/// The same through single precision, in which the kernels get it.
Configuration rounded(const Configuration& c) {
    const auto single = [](const Vector& v) { return Vector(glm::vec3(v)); };
    return {single(c.corner), single(c.edge1), single(c.edge2), single(c.normal)};
}

Float3 lanes(const Vector& v) {
    return {splat(static_cast<float>(v.x)), splat(static_cast<float>(v.y)),
            splat(static_cast<float>(v.z))};
}

RectangleView view_of(const Configuration& c) {
    const auto inverse_length_of = [](const Vector& edge) {
        return splat(static_cast<float>(1 / glm::length(edge)));
    };
    return view_rectangle({lanes(c.corner), lanes(c.edge1), lanes(c.edge2),
                           lanes(glm::normalize(glm::cross(c.edge1, c.edge2))),
                           inverse_length_of(c.edge1), inverse_length_of(c.edge2)});
}

struct Sampled {
    Vector point;
    double solid_angle;
};

Sampled sampled(const Configuration& c, double u, double v) {
    const auto s = sample_solid_angle(view_of(c),
                                      {splat(static_cast<float>(u)), splat(static_cast<float>(v))});
    const auto value = [](const Float& lane) { return static_cast<double>(lane[0]); };
    return {{value(s.to_point.x), value(s.to_point.y), value(s.to_point.z)}, value(s.solid_angle)};
}

/// Of a triangle (Van Oosterom and Strackee 1983).
double triangle_solid_angle(Vector a, Vector b, Vector c) {
    a = glm::normalize(a);
    b = glm::normalize(b);
    c = glm::normalize(c);
    const double numerator = std::abs(glm::dot(a, glm::cross(b, c)));
    return 2 * std::atan2(numerator, 1 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
}

double exact_solid_angle(const Vector& corner, const Vector& edge1, const Vector& edge2) {
    const Vector opposite = corner + edge1 + edge2;
    return triangle_solid_angle(corner, corner + edge1, opposite) +
           triangle_solid_angle(corner, opposite, corner + edge2);
}

double exact_solid_angle(const Configuration& c) {
    return exact_solid_angle(c.corner, c.edge1, c.edge2);
}

/// Integral over a rectangle: halved until its sides are short against its distance, then by 5
/// points of Gauss each way. f is of the point relative to the shading point, per solid angle.
template <class F>
double integral(const Vector& corner, const Vector& edge1, const Vector& edge2, F f) {
    const double l1 = glm::length(edge1);
    const double l2 = glm::length(edge2);
    const double distance = glm::length(corner + 0.5 * (edge1 + edge2));
    if (std::max(l1, l2) > 0.4 * distance && std::max(l1, l2) > 1e-5) {
        const bool first = l1 > l2;
        const Vector half1 = first ? 0.5 * edge1 : edge1;
        const Vector half2 = first ? edge2 : 0.5 * edge2;
        return integral(corner, half1, half2, f) +
               integral(corner + (first ? half1 : half2), half1, half2, f);
    }
    constexpr double kAt[] = {-0.9061798459386640, -0.5384693101056831, 0, 0.5384693101056831,
                              0.9061798459386640};
    constexpr double kWeight[] = {0.2369268850561891, 0.4786286704993665, 0.5688888888888889,
                                  0.4786286704993665, 0.2369268850561891};
    const Vector normal = glm::normalize(glm::cross(edge1, edge2));
    double sum = 0;
    for (int i = 0; i < 5; ++i) {
        for (int j = 0; j < 5; ++j) {
            const Vector p = corner + 0.5 * (1 + kAt[i]) * edge1 + 0.5 * (1 + kAt[j]) * edge2;
            const double d2 = glm::dot(p, p);
            const double per_area = std::abs(glm::dot(p, normal)) / (d2 * std::sqrt(d2));
            sum += kWeight[i] * kWeight[j] * per_area * f(p);
        }
    }
    return 0.25 * l1 * l2 * sum;
}

double quadrature_irradiance(const Configuration& c) {
    return integral(c.corner, c.edge1, c.edge2,
                    [&](const Vector& p) {
                        return std::max(0.0, glm::dot(glm::normalize(p), glm::normalize(c.normal)));
                    }) /
           kPiD;
}

/// The least height of a corner above the horizon of the normal, against its distance.
double least_height(const Configuration& c) {
    const Vector corners[] = {c.corner, c.corner + c.edge1, c.corner + c.edge1 + c.edge2,
                              c.corner + c.edge2};
    double least = 1;
    for (const Vector& corner : corners)
        least = std::min(least, glm::dot(glm::normalize(corner), c.normal));
    return least;
}

}  // namespace

TEST_CASE("the quadrature of these tests gives solid angles", "[rectangle]") {
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        const Configuration c = random_configuration(random);
        const double by_sum =
            integral(c.corner, c.edge1, c.edge2, [](const Vector&) { return 1.0; });
        CHECK(by_sum == Approx(exact_solid_angle(c)).epsilon(1e-6));
    }
}

TEST_CASE("the solid angle of a rectangle is right to single precision", "[rectangle]") {
    Random random(2);
    double worst = 0;
    for (int i = 0; i < 20000; ++i) {
        const Configuration c = rounded(random_configuration(random));
        const double found = sampled(c, 0.5, 0.5).solid_angle;
        const double exact = exact_solid_angle(c);
        worst = std::max(worst, std::abs(found - exact) / (exact + 0.05));
    }
    CAPTURE(worst);
    CHECK(worst < 1e-4);
}

// The sampling is uniform over the solid angle if and only if the part of the rectangle before x
// holds the share u of it, and the part of the line at x before y the share v of that line's.
TEST_CASE("points of a rectangle divide its solid angle as the random numbers do", "[rectangle]") {
    Random random(3);
    double worst_u = 0;
    double worst_v = 0;
    double worst_plane = 0;
    for (int i = 0; i < 20000; ++i) {
        const Configuration c = rounded(random_configuration(random));
        const double whole = exact_solid_angle(c);
        if (whole < 1e-2) continue;  // sampled by area
        const double u = random.unit();
        const double v = random.unit();
        const Vector p = sampled(c, u, v).point;
        const double l1 = glm::length(c.edge1);
        const double l2 = glm::length(c.edge2);
        const double x = glm::dot(p - c.corner, c.edge1) / (l1 * l1);
        const double y = glm::dot(p - c.corner, c.edge2) / (l2 * l2);
        REQUIRE((x > -1e-5 && x < 1 + 1e-5 && y > -1e-5 && y < 1 + 1e-5));
        worst_plane =
            std::max(worst_plane,
                     std::abs(glm::dot(p - c.corner, glm::cross(c.edge1, c.edge2)) / (l1 * l2)));
        const double before_x = exact_solid_angle(c.corner, x * c.edge1, c.edge2);
        worst_u = std::max(worst_u, std::abs(before_x / whole - u));
        const double strip = 1e-4;
        const Vector from = c.corner + (x - 0.5 * strip) * c.edge1;
        const double column = exact_solid_angle(from, strip * c.edge1, c.edge2);
        const double before_y = exact_solid_angle(from, strip * c.edge1, y * c.edge2);
        worst_v = std::max(worst_v, std::abs(before_y / column - v));
    }
    CAPTURE(worst_u, worst_v, worst_plane);
    CHECK(worst_u < 0.01);
    CHECK(worst_v < 2e-3);
    CHECK(worst_plane < 1e-4);
}

TEST_CASE("the irradiance of a rectangle agrees with quadrature wherever it says to be exact",
          "[rectangle]") {
    Random random(4);
    double worst = 0;
    int exact = 0;
    int near = 0;
    for (int i = 0; i < 20000; ++i) {
        Configuration c = random_configuration(random);
        // Half of the normals look at the rectangle, as those of lit surfaces do.
        if (i % 2 == 0) {
            const Vector centre = c.corner + 0.5 * (c.edge1 + c.edge2);
            c.normal = glm::normalize(glm::normalize(centre) + random.between(0, 1) * c.normal);
        }
        c = rounded(c);
        const Irradiance found = rectangle_irradiance(view_of(c), lanes(c.normal));
        const double margin = least_height(c);
        if (std::abs(margin) > 1e-5) CHECK((found.exact[0] != 0) == (margin > 0));
        if (found.exact[0] == 0) continue;
        ++exact;
        near += exact_solid_angle(c) > 0.5 ? 1 : 0;
        const double error = static_cast<double>(found.value[0]) - quadrature_irradiance(c);
        worst = std::max(worst, std::abs(error));
    }
    CAPTURE(worst, exact, near);
    CHECK(exact > 2000);
    CHECK(near > 200);
    CHECK(worst < 2e-6);
}
