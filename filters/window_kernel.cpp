// SPDX-License-Identifier: Apache-2.0
//
// The one window loop behind all averaging schemes; a scheme adds a distance and a weight, which
// inline into it. Neighbouring pixels of a row stand side by side in the lanes of vectors, and each
// adds up its own neighbours from top left to bottom right: the bits depend on neither the vector
// width nor threads. Compiled once per instruction set, with VECINO_LANES and VECINO_KERNEL as its
// width and name.
#include "filters/window_row.h"

namespace vecino {
namespace {

constexpr int kLanes = VECINO_LANES;
static_assert(kLanes <= kMostLanes);
using Doubles = double __attribute__((vector_size(8 * kLanes)));
using Masks = std::int64_t __attribute__((vector_size(8 * kLanes)));
using Index = std::int64_t;

template <class Vector = Doubles>
Vector load(const double* from) {
    Vector vector;
    __builtin_memcpy(&vector, from, sizeof vector);
    return vector;
}
inline void store(double* to, Doubles value) {
    __builtin_memcpy(to, &value, sizeof value);
}
inline Doubles splat(double value) {
    return Doubles{} + value;
}

/// The value where the mask says yes, else 0. Bits, unlike a product with 0, also keep out what is
/// not finite.
inline Doubles masked(Doubles value, Masks mask) {
    return (Doubles)((Masks)value & mask);
}
inline Doubles select(Masks mask, Doubles yes, Doubles no) {
    return (Doubles)(((Masks)yes & mask) | ((Masks)no & ~mask));
}

inline Doubles sqrt(Doubles v) {
    for (int i = 0; i < kLanes; ++i) v[i] = __builtin_sqrt(v[i]);
    return v;
}

/// exp(x) for x <= 0, to 1e-11; 0 below -600, where weight times colour could underflow; NaN for
/// NaN. Our own: the C library's does not give the same bits on every machine.
inline Doubles exp_of_negative(Doubles x) {
    constexpr double kLog2E = 0x1.71547652b82fep+0;
    constexpr double kLn2High =
        0x1.62e42fee00000p-1;  // trailing zeros: its product with k is exact
    constexpr double kLn2Low = 0x1.a39ef35793c76p-33;
    constexpr double kRounder = 0x1.8p52;  // leaves the rounded integer k in the low bits
    const Doubles shifted = x * kLog2E + kRounder;
    const Doubles k = shifted - kRounder;
    const Doubles r = (x - k * kLn2High) - k * kLn2Low;  // |r| <= ln(2) / 2
    const Doubles r2 = r * r;
    const Doubles r4 = r2 * r2;
    const Doubles low = (1.0 + r) + r2 * (1.0 / 2 + r * (1.0 / 6));
    const Doubles middle = (1.0 / 24 + r * (1.0 / 120)) + r2 * (1.0 / 720 + r * (1.0 / 5040));
    const Doubles high = 1.0 / 40320 + r * (1.0 / 362880);
    const Doubles power_of_r = low + r4 * (middle + r4 * high);
    const Masks power_of_2 = (Masks)shifted << 52;
    return masked((Doubles)((Masks)power_of_r + power_of_2), ~(x < -600.0));
}

/// A neighbour, seen from its centre.
struct Offset {
    int dx, dy;
    Index step;      ///< from the centre to the neighbour, in values
    double* weight;  ///< where the weights of all lanes go
};

template <class Visit>
void for_each_offset(const WindowRow& row, Visit visit) {
    double* weight = row.weights;
    for (int dy = -row.above; dy <= row.below; ++dy) {
        for (int dx = -row.reach; dx <= row.reach; ++dx, weight += kLanes) {
            visit(Offset{dx, dy, dy * row.row_pitch + dx, weight});
        }
    }
}

inline Index window_area(const WindowRow& row) {
    return Index{row.above + 1 + row.below} * (2 * row.reach + 1);
}

inline double* centre_weight(const WindowRow& row) {
    return row.weights + kLanes * (row.above * Index{2 * row.reach + 1} + row.reach);
}

// Distances, squared: a Gaussian then needs no square root, and sqrt(d * d) is d exactly. admits()
// is the gate.

/// uv distance (Eq. 3). Windows that the border does not clip all have the same weights.
struct ImageDistance {
    static constexpr bool kSameInside = true;
    double du, dv;
    bool manhattan;

    ImageDistance(const WindowRow& row, const double*)
        : du(row.du), dv(row.dv), manhattan(row.distance == WindowDistance::manhattan) {}

    [[nodiscard]] Doubles squared(const Offset& offset) const {
        const double u = offset.dx * du;
        const double v = offset.dy * dv;
        const double sum = __builtin_fabs(u) + __builtin_fabs(v);
        return splat(manhattan ? sum * sum : u * u + v * v);
    }
    [[nodiscard]] static Masks admits(const Offset&) { return ~Masks{}; }
};

/// Three planes around the pixels whose windows are summed.
struct Vectors {
    const double* x;
    const double* y;
    const double* z;
    Doubles centre_x, centre_y, centre_z;

    Vectors(const WindowRow& row, const double* centre, WindowPlane plane)
        : x(centre + plane * row.plane_pitch),
          y(x + row.plane_pitch),
          z(y + row.plane_pitch),
          centre_x(load(x)),
          centre_y(load(y)),
          centre_z(load(z)) {}
};

/// Distance of the first-hit positions (Eq. 5).
struct WorldDistance {
    static constexpr bool kSameInside = false;
    Vectors position;

    WorldDistance(const WindowRow& row, const double* centre)
        : position(row, centre, kPositionPlanes) {}

    [[nodiscard]] Doubles squared(const Offset& offset) const {
        const Doubles x = load(position.x + offset.step) - position.centre_x;
        const Doubles y = load(position.y + offset.step) - position.centre_y;
        const Doubles z = load(position.z + offset.step) - position.centre_z;
        return x * x + y * y + z * z;
    }
    [[nodiscard]] static Masks admits(const Offset&) { return ~Masks{}; }
};

/// The same behind the gate of Eq. 6, which the centre has to pass too.
struct GatedWorldDistance : WorldDistance {
    Vectors normal;
    double min_cosine;

    GatedWorldDistance(const WindowRow& row, const double* centre)
        : WorldDistance(row, centre),
          normal(row, centre, kNormalPlanes),
          min_cosine(row.min_normal_cosine) {}

    [[nodiscard]] Masks admits(const Offset& offset) const {
        const Doubles x = load(normal.x + offset.step) * normal.centre_x;
        const Doubles y = load(normal.y + offset.step) * normal.centre_y;
        const Doubles z = load(normal.z + offset.step) * normal.centre_z;
        return x + y + z > min_cosine;
    }
};

// Weights of what a distance measured: measure() makes of the squared distance what weight() needs,
// and kNothing is the measure whose weight is 0. The spread s is the mean distance of the admitted
// neighbours. Where it is 0 or there are none, no weight is finite, and the pixel will fall back to
// its own colour.

struct EqualWeight {
    static constexpr bool kReadsSpread = false;
    static constexpr double kNothing = 0.0;
    static Doubles measure(Doubles d2) { return d2; }
    static Doubles weight(Doubles, Doubles) { return splat(1.0); }
};

/// Eq. 4 as printed.
struct ProportionalWeight {
    static constexpr bool kReadsSpread = false;
    static constexpr double kNothing = 0.0;
    static Doubles measure(Doubles d2) { return d2; }
    static Doubles weight(Doubles d2, Doubles) { return sqrt(d2); }
};

struct InverseWeight {
    static constexpr bool kReadsSpread = true;
    static constexpr double kNothing = __builtin_inf();
    static Doubles scale(Doubles s) { return 0.01 * s; }
    static Doubles measure(Doubles d2) { return sqrt(d2); }
    static Doubles weight(Doubles d, Doubles scale) { return 1.0 / (d + scale); }
};

struct GaussianWeight {
    static constexpr bool kReadsSpread = true;
    static constexpr double kNothing = __builtin_inf();
    static Doubles scale(Doubles s) { return -0.5 / (s * s); }
    static Doubles measure(Doubles d2) { return d2; }
    static Doubles weight(Doubles d2, Doubles scale) { return exp_of_negative(d2 * scale); }
};

/// Measures all neighbours; returns their spread if the weight reads it.
template <class Distance, class Weight>
Doubles measure(const WindowRow& row, const double* centre) {
    const Distance distance(row, centre);
    const double* present = centre + kPresentPlane * row.plane_pitch;
    Doubles sum{};
    Doubles count{};
    for_each_offset(row, [&](const Offset& offset) {
        const Masks admitted = distance.admits(offset) & load<Masks>(present + offset.step);
        const Doubles d2 = distance.squared(offset);
        store(offset.weight, select(admitted, Weight::measure(d2), splat(Weight::kNothing)));
        if constexpr (Weight::kReadsSpread) {
            sum += masked(sqrt(d2), admitted);
            count += masked(splat(1.0), admitted);
        }
    });
    if constexpr (!Weight::kReadsSpread) return sum;
    const Masks centre_admitted = distance.admits({0, 0, 0, nullptr}) & load<Masks>(present);
    return sum / (count - masked(splat(1.0), centre_admitted));
}

template <class Distance, class Weight>
void weigh(const WindowRow& row, const double* centre) {
    Doubles scale = measure<Distance, Weight>(row, centre);
    if constexpr (Weight::kReadsSpread) scale = Weight::scale(scale);
    double* const end = row.weights + kLanes * window_area(row);
    for (double* weight = row.weights; weight != end; weight += kLanes) {
        store(weight, Weight::weight(load(weight), scale));
    }
    if (!row.use_centre) store(centre_weight(row), Doubles{});
}

inline void sum(const WindowRow& row, const double* centre, int x) {
    const double* finite = centre + kFinitePlane * row.plane_pitch;
    const double* red = centre + kColorPlanes * row.plane_pitch;
    const double* green = red + row.plane_pitch;
    const double* blue = green + row.plane_pitch;
    Doubles weight_sum{}, red_sum{}, green_sum{}, blue_sum{};
    for_each_offset(row, [&](const Offset& offset) {
        const Doubles weight = masked(load(offset.weight), load<Masks>(finite + offset.step));
        weight_sum += weight;
        red_sum += weight * load(red + offset.step);
        green_sum += weight * load(green + offset.step);
        blue_sum += weight * load(blue + offset.step);
    });
    store(row.weight_sum + x, weight_sum);
    store(row.color_sum[0] + x, red_sum);
    store(row.color_sum[1] + x, green_sum);
    store(row.color_sum[2] + x, blue_sum);
}

template <class Distance, class Weight>
void sum_row(const WindowRow row) {  // a copy, which no store can alias
    bool weights_hold = false;
    for (int x = 0; x < row.width; x += kLanes) {
        const double* centre = row.pixels + x;
        const bool inside = x >= row.reach && x + kLanes + row.reach <= row.width;
        if (!(weights_hold && inside)) weigh<Distance, Weight>(row, centre);
        weights_hold = Distance::kSameInside && inside;
        sum(row, centre, x);
    }
}

template <class Distance>
void sum_row_with(const WindowRow& row) {
    switch (row.weight) {
        case WindowWeight::equal:
            return sum_row<Distance, EqualWeight>(row);
        case WindowWeight::proportional:
            return sum_row<Distance, ProportionalWeight>(row);
        case WindowWeight::inverse:
            return sum_row<Distance, InverseWeight>(row);
        case WindowWeight::gaussian:
            return sum_row<Distance, GaussianWeight>(row);
    }
}

}  // namespace

void VECINO_KERNEL(const WindowRow& row) {
    switch (row.distance) {
        case WindowDistance::euclidean:
        case WindowDistance::manhattan:
            return sum_row_with<ImageDistance>(row);
        case WindowDistance::world:
            return sum_row_with<WorldDistance>(row);
        case WindowDistance::gated_world:
            return sum_row_with<GatedWorldDistance>(row);
    }
}

}  // namespace vecino
