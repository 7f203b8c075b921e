// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "core/clones.h"
#include "filters/half_shadow.h"
#include "filters/shadow_field.h"

namespace vecino {
namespace {

constexpr int kReach = kFieldReach;
constexpr int kSide = 2 * kReach + 1;

// Over the window x and y are orthogonal, and so are what is left of their squares without the mean
// of these, and their product: sums of squares of these, and of ones.
constexpr float kMeanSquare = 4;
constexpr float kOnes = 49, kLinear = 196, kSquared = 588, kMixed = 784;

// Of a window of noise: squared differences of neighbours in a row (or in a column) in what the fit
// leaves, summed, held against that.
constexpr float kDifferencesOfNoise = 1.924f;

/// Rows of the window, first pixel of a block.
struct Window {
    const FieldRow* rows[kSide];
    std::size_t at;
};

// Of kPilotPixels pixels. Loops over plain arrays of so few floats are not made vectors of by
// GCC 12.
using Floats = float __attribute__((vector_size(4 * kPilotPixels)));
using Masks = std::int32_t __attribute__((vector_size(4 * kPilotPixels)));

template <class Vector, class Value>
VECINO_INLINE void load(const Value* from, Vector& to) {
    __builtin_memcpy(&to, from, sizeof to);
}

/// Values less that of the pixel itself: what is fitted is small then, and nothing cancels.
struct WindowValues {
    Floats value[kSide][kSide];
    // Bits, since GCC 12 compares such vectors lane by lane.
    Masks objects;  ///< not 0: there are several
    Masks creases;  ///< negative: normals differ
};

VECINO_CLONES void read_window(const Window& window, WindowValues& out) {
    const FieldRow& own = *window.rows[kReach];
    Floats normal[3], other[3], value, value_there;
    Masks object, object_there;
    for (int c = 0; c < 3; ++c) load(own.normal[c].data() + window.at, normal[c]);
    load(own.value.data() + window.at, value);
    load(own.object.data() + window.at, object);
    Masks objects = {}, creases = {};
    for (int y = 0; y < kSide; ++y) {
        const FieldRow& row = *window.rows[y];
        for (int x = 0; x < kSide; ++x) {
            const std::size_t from = window.at + static_cast<std::size_t>(x) - std::size_t{kReach};
            for (int c = 0; c < 3; ++c) load(row.normal[c].data() + from, other[c]);
            load(row.value.data() + from, value_there);
            load(row.object.data() + from, object_there);
            const Floats cosine =
                normal[0] * other[0] + normal[1] * other[1] + normal[2] * other[2];
            out.value[y][x] = value_there - value;
            objects |= object ^ object_there;
            creases |= (Masks)(cosine - kSameSurface);
        }
    }
    out.objects = objects;
    out.creases = creases;
}

/// Coefficients of one, x, y, and of the others in turn.
struct Coefficients {
    Floats one, x, y, xx, xy, yy;
};

VECINO_CLONES void fit_window(const WindowValues& values, Coefficients& fit) {
    Floats one = {}, by_x = {}, by_y = {}, xx = {}, xy = {}, yy = {};
    for (int row = 0; row < kSide; ++row) {
        const auto y = static_cast<float>(row - kReach);
        for (int column = 0; column < kSide; ++column) {
            const auto x = static_cast<float>(column - kReach);
            const Floats value = values.value[row][column];
            one += value;
            by_x += x * value;
            by_y += y * value;
            xx += (x * x - kMeanSquare) * value;
            xy += x * y * value;
            yy += (y * y - kMeanSquare) * value;
        }
    }
    fit.one = one / kOnes;
    fit.x = by_x / kLinear;
    fit.y = by_y / kLinear;
    fit.xx = xx / kSquared;
    fit.xy = xy / kMixed;
    fit.yy = yy / kSquared;
}

/// What the fit leaves, and how neighbours side by side and one above the other differ in that:
/// sums of squares.
struct Residuals {
    Floats squares, across, down;
};

VECINO_CLONES void residuals_of(const WindowValues& values, const Coefficients& fit,
                                Residuals& out) {
    Floats squares = {}, across = {}, down = {}, above[kSide], left;
    for (int row = 0; row < kSide; ++row) {
        const auto y = static_cast<float>(row - kReach);
        for (int column = 0; column < kSide; ++column) {
            const auto x = static_cast<float>(column - kReach);
            const Floats fitted = fit.one + fit.x * x + fit.y * y + fit.xx * (x * x - kMeanSquare) +
                                  fit.xy * (x * y) + fit.yy * (y * y - kMeanSquare);
            const Floats residual = values.value[row][column] - fitted;
            squares += residual * residual;
            if (column > 0) across += (residual - left) * (residual - left);
            if (row > 0) down += (residual - above[column]) * (residual - above[column]);
            left = residual;
            above[column] = residual;
        }
    }
    out.squares = squares;
    out.across = across;
    out.down = down;
}

/// How far what a fit leaves is noise. Of noise, both ratios are about one; along an edge
/// neighbours are alike in what is left.
float noisiness(const Residuals& residuals, int i) {
    constexpr float kEdge = 0.7f, kNoise = 0.9f;              // both together
    constexpr float kEdgeAlong = 0.45f, kNoiseAlong = 0.65f;  // the less one: fewer pairs
    const float expected = kDifferencesOfNoise * residuals.squares[i];
    if (!(expected > 0)) return 0;
    const float across = residuals.across[i] / expected, down = residuals.down[i] / expected;
    const auto between = [](float value, float low, float high) {
        return std::clamp((value - low) / (high - low), 0.0f, 1.0f);
    };
    return std::min(between(0.5f * (across + down), kEdge, kNoise),
                    between(std::min(across, down), kEdgeAlong, kNoiseAlong));
}

/// What the fit makes of values, pixel by pixel.
constexpr auto kFitWeights = [] {
    std::array<float, kSide * kSide> weights{};
    for (int k = 0; k < kSide * kSide; ++k) {
        const auto x = static_cast<float>(k % kSide - kReach);
        const auto y = static_cast<float>(k / kSide - kReach);
        weights[static_cast<std::size_t>(k)] =
            1 / kOnes - kMeanSquare * (x * x + y * y - 2 * kMeanSquare) / kSquared;
    }
    return weights;
}();

/// The fit of one channel at pixels, less their own.
VECINO_CLONES void fit_channel(const Window& window, int channel, Floats& out) {
    Floats own, value, sum = {};
    load(window.rows[kReach]->channel[channel].data() + window.at, own);
    for (std::size_t row = 0; row < kSide; ++row) {
        const float* const values = window.rows[row]->channel[channel].data() + window.at;
        for (std::size_t column = 0; column < kSide; ++column) {
            load(values + column - kReach, value);
            sum += kFitWeights[row * kSide + column] * (value - own);
        }
    }
    out = sum;
}

/// Side by side.
struct FittedLanes {
    float share[kPilotPixels];       ///< of the fit in what a pixel becomes
    Floats channel[kFieldChannels];  ///< of the fit at the pixel, less its own
};

/// As much of the fit as what it leaves is noise: along an edge neighbours are alike in that.
FittedLanes fit_lanes(const Window& window, bool picks) {
    WindowValues values;
    Coefficients fit;
    Residuals residuals;
    read_window(window, values);
    fit_window(values, fit);
    residuals_of(values, fit, residuals);
    FittedLanes out;
    for (int i = 0; i < kPilotPixels; ++i) {
        const bool alike = values.objects[i] == 0 && values.creases[i] >= 0;
        out.share[i] = alike ? noisiness(residuals, i) : 0.0f;
    }
    out.channel[0] = fit.one - kMeanSquare * (fit.xx + fit.yy);
    for (int c = 0; picks && c < kFieldChannels; ++c) fit_channel(window, c, out.channel[c]);
    return out;
}

/// Goes down rows with those around at hand.
class RowFitter {
  public:
    RowFitter(const LightField& field, RowRange rows)
        : field_(field), rows_(rows), window_(kReach, kReach) {}

    std::vector<Smoothed> next(int y, const std::vector<int>& pixels) {
        window_.go_to(y, [this](int k, FieldRow& row) { field_.read(k, rows_, row); });
        Window window{};
        for (int k = 0; k < kSide; ++k) window.rows[k] = &window_[y + k - kReach];
        std::vector<Smoothed> out;
        FittedLanes fitted;
        int done = -1;  // block
        for (const int x : pixels) {
            if (x / kPilotPixels != done) {
                done = x / kPilotPixels;
                window.at = field_index(done * kPilotPixels);
                fitted = fit_lanes(window, field_.picks());
            }
            const auto lane = static_cast<std::size_t>(x % kPilotPixels);
            if (fitted.share[lane] > 0) out.push_back(smoothed(window, fitted, x));
        }
        return out;
    }

  private:
    [[nodiscard]] Smoothed smoothed(const Window& window, const FittedLanes& fitted, int x) const {
        const auto lane = static_cast<std::size_t>(x % kPilotPixels);
        const std::size_t at = field_index(x);
        const FieldRow& own = *window.rows[kReach];
        const float share = fitted.share[lane];
        const float most = field_.picks() ? std::numeric_limits<float>::max() : 1.0f;
        Smoothed pixel{x, {}};
        for (int c = 0; c < (field_.picks() ? kFieldChannels : 1); ++c) {
            const float made = own.channel[c][at] + share * fitted.channel[c][lane];
            pixel.channel[c] = std::clamp(made, 0.0f, most);
        }
        return pixel;
    }

    const LightField& field_;
    RowRange rows_;
    RowWindow<FieldRow> window_;
};

}  // namespace

void fit_half_shadow(const RecordTracer& tracer, const GivenSamples& given,
                     PixelClusters& clusters) {
    const auto smooth = [&](const LightField& field, const FieldPixels& pixels) {
        // Beyond the band there are first samples alone, which are far noisier.
        return go_down_rows(pixels, tracer.threads, [&] { return RowFitter(field, given.rows); });
    };
    smooth_lights(tracer, shadow_pixels(given.rows, given.needy), smooth, clusters);
}

}  // namespace vecino
