// SPDX-License-Identifier: Apache-2.0
#include "filters/plane_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace vecino {
namespace {

std::int64_t cross(Pixel a, Pixel b) {
    return std::int64_t{a.x} * b.y - std::int64_t{a.y} * b.x;
}

std::int64_t dot(Pixel a, Pixel b) {
    return std::int64_t{a.x} * b.x + std::int64_t{a.y} * b.y;
}

void inverse_distances(std::span<const Pixel> points, std::span<double> weights) {
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        weights[i] = 1.0 / std::sqrt(static_cast<double>(dot(points[i], points[i])));
        sum += weights[i];
    }
    for (double& weight : weights) weight /= sum;
}

}  // namespace

bool surrounds_origin(std::span<const Pixel> points) {
    // If they do not, they fit between one of them and less than half a turn to its left.
    return !points.empty() && std::ranges::none_of(points, [&](Pixel first) {
        return std::ranges::all_of(points, [&](Pixel other) {
            const std::int64_t turn = cross(first, other);
            return turn > 0 || (turn == 0 && dot(first, other) > 0);
        });
    });
}

void weights_at_origin(std::span<const Pixel> points, std::span<double> weights) {
    const auto count = static_cast<double>(points.size());
    double x = 0, y = 0;
    for (const Pixel& point : points) {
        x += point.x / count;
        y += point.y / count;
    }
    double xx = 0, xy = 0, yy = 0;
    for (const Pixel& point : points) {
        xx += (point.x - x) * (point.x - x);
        xy += (point.x - x) * (point.y - y);
        yy += (point.y - y) * (point.y - y);
    }
    const double determinant = xx * yy - xy * xy;
    if (determinant < 1e-9 * (xx + yy) * (xx + yy)) return inverse_distances(points, weights);
    // The value at the middle, and from there along the slopes to the origin.
    const double to_x = (-x * yy + y * xy) / determinant;
    const double to_y = (-y * xx + x * xy) / determinant;
    for (std::size_t i = 0; i < points.size(); ++i)
        weights[i] = 1.0 / count + to_x * (points[i].x - x) + to_y * (points[i].y - y);
}

}  // namespace vecino
