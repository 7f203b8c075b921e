// SPDX-License-Identifier: Apache-2.0
//
// The window kernel by itself, where its sums can still be seen in double precision.
#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "filters/window_row.h"
#include "tests/catch.h"
#include "tests/scheme_frames.h"

using namespace vecino;

namespace {

constexpr int kWidth = 21;
constexpr int kReach = 3;
constexpr int kRows = 2 * kReach + 1;
constexpr int kPitch = kWidth + 2 * kReach + kMostLanes;
constexpr int kRowPitch = (kNormalPlanes + 3) * kPitch;

/// Rows of random planes, of which the middle one is to be summed.
std::vector<double> random_rows() {
    const double yes = std::bit_cast<double>(~std::uint64_t{0});
    Random random(1);
    std::vector<double> values(std::size_t{kRows} * kRowPitch);
    for (std::size_t i = 0; i < values.size(); ++i) {
        const float value = random.unit();
        values[i] = static_cast<double>(value);
        const std::size_t plane = i % kRowPitch / kPitch;
        if (plane == kPresentPlane) values[i] = yes;
        if (plane == kFinitePlane) values[i] = value < 0.7f ? yes : 0.0;
    }
    return values;
}

/// Sums of weights and of weighted colours, one row after the other.
std::vector<double> sums_of(SumWindows kernel, WindowDistance distance, WindowWeight weight) {
    const std::vector<double> rows = random_rows();
    std::vector<double> sums(std::size_t{4} * kPitch);
    std::vector<double> weights(std::size_t{kRows} * kRows * kMostLanes);
    kernel({.pixels = rows.data() + kReach * kRowPitch + kReach,
            .row_pitch = kRowPitch,
            .plane_pitch = kPitch,
            .width = kWidth,
            .reach = kReach,
            .above = kReach,
            .below = kReach,
            .distance = distance,
            .weight = weight,
            .use_centre = true,
            .du = 1.0 / kWidth,
            .dv = 0.125,
            .min_normal_cosine = 0.3,
            .weight_sum = sums.data(),
            .color_sum = {sums.data() + kPitch, sums.data() + 2 * kPitch, sums.data() + 3 * kPitch},
            .weights = weights.data()});
    for (std::size_t i = 0; i < sums.size(); ++i) {
        if (i % kPitch >= kWidth) sums[i] = 0.0;  // lanes past the end of the row
    }
    return sums;
}

/// The weight of a neighbour at distance d, the others lying such that the spread is 1.
double gaussian_weight(double d) {
    constexpr int kSide = 17;  // one row of 17 neighbours on either side, on a line in space
    constexpr int kNeighbours = 2 * kSide;
    constexpr int kPlanePitch = kNeighbours + 1 + kMostLanes;
    const double yes = std::bit_cast<double>(~std::uint64_t{0});
    std::vector<double> row(std::size_t{kNormalPlanes} * kPlanePitch);
    for (std::size_t x = 0; x <= kNeighbours; ++x) {
        row[kPresentPlane * kPlanePitch + x] = yes;
        row[kPositionPlanes * kPlanePitch + x] = (kNeighbours - d) / (kNeighbours - 1);
    }
    row[kPositionPlanes * kPlanePitch] = d;
    row[kPositionPlanes * kPlanePitch + kSide] = 0.0;
    row[kFinitePlane * kPlanePitch] = yes;  // the others have no colour, so that none is added
    std::vector<double> sums(std::size_t{4} * (1 + kMostLanes));
    std::vector<double> weights(std::size_t{kNeighbours + 1} * kMostLanes);
    double* const out = sums.data();
    WindowRow window{};
    window.pixels = row.data() + kSide;
    window.plane_pitch = kPlanePitch;
    window.width = 1;
    window.reach = kSide;
    window.distance = WindowDistance::world;
    window.weight = WindowWeight::gaussian;
    window.weight_sum = out;
    for (int c = 0; c < 3; ++c) window.color_sum[c] = out + (c + 1) * (1 + kMostLanes);
    window.weights = weights.data();
    sum_windows_baseline(window);
    return out[0];
}

}  // namespace

TEST_CASE("the gaussian weight is that of the C library's exponential to 2e-11", "[schemes]") {
    double worst = 0.0;
    for (int i = 0; i <= 3400; ++i) {
        const double d = i / 100.0;
        const double expected = std::exp(-0.5 * d * d);
        worst = std::max(worst, std::abs(gaussian_weight(d) / expected - 1.0));
    }
    CHECK(worst <= 2e-11);  // its own 1e-11, and the roundings of the spread
}

TEST_CASE("sums of windows are those of plain loops", "[schemes]") {
    const auto sums = sums_of(sum_windows_baseline, WindowDistance::world, WindowWeight::equal);
    const std::vector<double> rows = random_rows();
    const auto plane = [&](std::size_t which, std::size_t x, std::size_t y) {
        return rows[y * kRowPitch + which * kPitch + kReach + x];
    };
    double count = 0.0;
    double blue = 0.0;
    for (std::size_t y = 0; y < kRows; ++y) {
        for (std::size_t x = 2; x <= 8; ++x) {
            if (plane(kFinitePlane, x, y) == 0.0) continue;
            count += 1.0;
            blue += plane(kColorPlanes + 2, x, y);
        }
    }
    CHECK(sums[5] == count);
    CHECK(sums[3 * kPitch + 5] == blue);
}

#ifdef __x86_64__
TEST_CASE("every instruction set gives the same bits", "[schemes]") {
    std::vector<SumWindows> kernels;
    if (__builtin_cpu_supports("avx2")) kernels.push_back(sum_windows_avx2);
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512vl")) {
        kernels.push_back(sum_windows_avx512);
    }
    for (const auto distance : {WindowDistance::euclidean, WindowDistance::manhattan,
                                WindowDistance::world, WindowDistance::gated_world}) {
        for (const auto weight : {WindowWeight::equal, WindowWeight::proportional,
                                  WindowWeight::inverse, WindowWeight::gaussian}) {
            CAPTURE(static_cast<int>(distance), static_cast<int>(weight));
            const auto narrow = sums_of(sum_windows_baseline, distance, weight);
            CHECK(narrow[5] > 0.0);
            for (const SumWindows kernel : kernels) {
                CHECK((narrow == sums_of(kernel, distance, weight)));
            }
        }
    }
}
#endif
