// SPDX-License-Identifier: Apache-2.0
//
// The random numbers of the tracer, at the narrowest packet width.
#define VECINO_WIDTH 4
#include "core/random_lanes.h"

#include <array>
#include <cmath>
#include <set>
#include <vector>

#include "tests/catch.h"

using namespace vecino;

namespace {

TraceTask task_with(bool sobol, std::uint32_t streams = 1) {
    TraceTask task{};
    task.sobol = sobol;
    task.streams = streams;
    task.seed = 7;
    return task;
}

struct Point {
    float u, v;
};

/// Points 0 .. count - 1 of one pixel and dimension pair.
std::vector<Point> points(const TraceTask& task, std::uint32_t pixel, std::uint32_t dimension,
                          std::uint32_t count) {
    std::vector<Point> result;
    for (std::uint32_t first = 0; first < count; first += 4) {
        const Uint sample = {first, first + 1, first + 2, first + 3};
        const Pair pair = PathRandom(task, pixel, sample).pair(dimension);
        for (int i = 0; i < 4; ++i) result.push_back({pair.u[i], pair.v[i]});
    }
    return result;
}

/// True if every one of the 2^k boxes of 2^a x 2^(k-a) strata holds exactly one point.
bool is_net(const std::vector<Point>& set, int k) {
    for (int a = 0; a <= k; ++a) {
        const auto columns = static_cast<float>(1 << a);
        const auto rows = static_cast<float>(1 << (k - a));
        std::set<std::pair<int, int>> boxes;
        for (const Point& p : set) {
            boxes.emplace(static_cast<int>(p.u * columns), static_cast<int>(p.v * rows));
        }
        if (boxes.size() != set.size()) return false;
    }
    return true;
}

double correlation(const std::vector<Point>& a, const std::vector<Point>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        sum += (static_cast<double>(a[i].u) - 0.5) * (static_cast<double>(b[i].v) - 0.5);
    }
    return sum * 12.0 / static_cast<double>(a.size());
}

}  // namespace

TEST_CASE("every aligned power of two of Sobol points has one point in every elementary box",
          "[random]") {
    const std::uint32_t dimension = GENERATE(0u, 1u, 2u, 9u);
    const auto set = points(task_with(true), 12, dimension, 256);
    CHECK(is_net(set, 8));
    CHECK(is_net({set.begin(), set.begin() + 64}, 6));
    CHECK(is_net({set.begin() + 192, set.end()}, 6));
}

TEST_CASE("each of the four streams is a net of its own", "[random]") {
    const auto set = points(task_with(true, kStreams), 3, 1, 256);
    for (std::size_t stream = 0; stream < 4; ++stream) {
        std::vector<Point> own;
        for (std::size_t i = stream; i < set.size(); i += 4) own.push_back(set[i]);
        CHECK(is_net(own, 6));
    }
    CHECK_FALSE(is_net(set, 8));
}

TEST_CASE("independent numbers fill the unit square evenly", "[random]") {
    std::array<int, 256> boxes{};
    constexpr int kCount = 1 << 18;
    for (const Point& p : points(task_with(false), 5, 3, kCount)) {
        REQUIRE((p.u >= 0 && p.u < 1 && p.v >= 0 && p.v < 1));
        ++boxes[static_cast<std::size_t>(p.u * 16) * 16 + static_cast<std::size_t>(p.v * 16)];
    }
    double chi2 = 0;
    for (const int n : boxes)
        chi2 += (n - kCount / 256.0) * (n - kCount / 256.0) / (kCount / 256.0);
    CHECK(chi2 < 255 + 4.5 * std::sqrt(2 * 255.0));
    CHECK(chi2 > 255 - 4.5 * std::sqrt(2 * 255.0));
}

TEST_CASE("dimensions, pixels and seeds are not correlated", "[random]") {
    const bool sobol = GENERATE(false, true);
    constexpr std::uint32_t kCount = 1 << 14;
    // Points are shuffled within their nets, so correlations of Sobol points scatter more widely
    // (1.3 times, measured).
    const double limit = (sobol ? 8.0 : 5.0) / std::sqrt(static_cast<double>(kCount));
    const TraceTask task = task_with(sobol);
    const auto base = points(task, 100, 2, kCount);
    CHECK(std::abs(correlation(base, base)) < limit);
    CHECK(std::abs(correlation(base, points(task, 100, 3, kCount))) < limit);
    CHECK(std::abs(correlation(base, points(task, 100, 4, kCount))) < limit);
    CHECK(std::abs(correlation(base, points(task, 101, 2, kCount))) < limit);
    TraceTask other = task;
    other.seed = 8;
    CHECK(std::abs(correlation(base, points(other, 100, 2, kCount))) < limit);
}

TEST_CASE("sine and cosine of a turn are exact to seven digits", "[random]") {
    double worst = 0;
    for (int i = 0; i < 100000; ++i) {
        const double u = i / 100000.0;
        Float sine, cosine;
        sincos_turns(splat(static_cast<float>(u)), sine, cosine);
        const double turn = 2 * 3.14159265358979323846 * static_cast<double>(static_cast<float>(u));
        worst = std::max(worst, std::abs(static_cast<double>(sine[0]) - std::sin(turn)));
        worst = std::max(worst, std::abs(static_cast<double>(cosine[0]) - std::cos(turn)));
    }
    CHECK(worst < 2e-7);
}
