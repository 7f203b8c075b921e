// SPDX-License-Identifier: Apache-2.0
#include "eval/reference_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "eval/metrics.h"
#include "eval/pixel_values.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

/// Sums over the pixels and channels of a part.
struct Sums {
    std::size_t pixels = 0;
    double display = 0;   ///< of squared errors of display values
    double relative = 0;  ///< of squared errors over r^2 + 0.01, linear
};

struct ValueError {
    double display, relative;
};

/// Gauss-Hermite points and weights of a normal distribution, for a mean of a function that bends
/// and is clipped.
constexpr std::array kNormalPoints = {0.0, 1.154405394739968, 2.366759410734541, 3.750439717725742};
constexpr std::array kNormalWeights = {0.4571428571428571, 0.2401231786050127, 0.03075712396758651,
                                       0.0005482688559722179};

/// Radiance is positive, and where its noise is large (a lamp that few samples hit) it is skewed: a
/// gamma distribution has both, and is the normal one where noise is small. Its value at a point of
/// the normal distribution, after Wilson and Hilferty:
double gamma_value(double mean, double variance, double point) {
    const double part = variance / (9 * mean * mean);
    const double root = std::max(0.0, 1 - part + point * std::sqrt(part));
    return mean * root * root * root;
}

ValueError error_of_variance(float reference, float variance_of_mean) {
    const auto linear = static_cast<double>(reference);
    const double variance = std::max(0.0, static_cast<double>(variance_of_mean));
    const auto shown = [](double value) {
        return static_cast<double>(srgb_encode(static_cast<float>(value)));
    };
    const auto step_at = [&](double point) {
        const double value = linear > 0 ? gamma_value(linear, variance, point)
                                        : linear + std::sqrt(variance) * point;
        return shown(value) - shown(linear);
    };
    double display = kNormalWeights[0] * step_at(0) * step_at(0);
    for (std::size_t i = 1; i < kNormalPoints.size(); ++i) {
        for (const double side : {-1.0, 1.0}) {
            const double step = step_at(side * kNormalPoints[i]);
            display += kNormalWeights[i] * step * step;
        }
    }
    return {display, variance / (linear * linear + 0.01)};
}

ValueError error_of_halves(float first, float second, double second_weight) {
    const double share = second_weight * (1 - second_weight);
    const auto a = static_cast<double>(first), b = static_cast<double>(second);
    const double mean = (1 - second_weight) * a + second_weight * b;
    const double shown =
        static_cast<double>(srgb_encode(first)) - static_cast<double>(srgb_encode(second));
    return {share * shown * shown, share * (a - b) * (a - b) / (mean * mean + 0.01)};
}

Json part_json(const Sums& sums) {
    const double values = 3 * static_cast<double>(sums.pixels);
    const bool is_known = sums.pixels > 0;
    return {{"psnr_float_db", sums.display > 0 ? Json(decibels_of(sums.display / values)) : Json()},
            {"relmse", is_known ? Json(sums.relative / values) : Json()}};
}

/// error_at gives the error of a channel value: the pixel's index and the channel.
template <class ErrorAt>
Json sum_up(std::size_t pixels, const RegionMap* regions, ErrorAt error_at) {
    Sums whole;
    PerRegion<Sums> parts;
    for (std::size_t p = 0; p < pixels; ++p) {
        const auto add = [&](Sums& sums, const ValueError& error) {
            sums.display += error.display;
            sums.relative += error.relative;
        };
        Sums* const part = regions ? &parts[region_index(regions->values()[p])] : nullptr;
        ++whole.pixels;
        if (part) ++part->pixels;
        for (int c = 0; c < 3; ++c) {
            const ValueError error = error_at(p, c);
            add(whole, error);
            if (part) add(*part, error);
        }
    }
    Json json = part_json(whole);
    if (!regions) return json;
    for (const RegionInfo& info : kRegions)
        json["regions"][std::string(info.name)] = part_json(parts[region_index(info.region)]);
    return json;
}

bool all_finite(const Image& image) {
    return std::ranges::all_of(image.values(), is_finite);
}

}  // namespace

Json reference_error(const HalfPair& halves, const RegionMap* regions) {
    require_comparable(halves.first, halves.second);
    if (regions) require_size(*regions, halves.first.size());
    if (!all_finite(halves.first) || !all_finite(halves.second)) return nullptr;
    Json json = sum_up(halves.first.values().size(), regions, [&](std::size_t p, int c) {
        return error_of_halves(halves.first.values()[p][c], halves.second.values()[p][c],
                               halves.second_weight);
    });
    json["source"] = "halves";
    return json;
}

Json reference_error(const Frame& reference, const RegionMap* regions) {
    const Image& image = reference.radiance;
    if (reference.variance.empty() || !all_finite(image) || !all_finite(reference.variance))
        return nullptr;
    require_comparable(image, reference.variance);
    if (regions) require_size(*regions, image.size());
    Json json = sum_up(image.values().size(), regions, [&](std::size_t p, int c) {
        return error_of_variance(image.values()[p][c], reference.variance.values()[p][c]);
    });
    json["source"] = "variance";
    return json;
}

bool is_limited(std::optional<double> result_db, double reference_db) {
    return !result_db || reference_db - *result_db <= 20 * std::log10(kLimitedWithin);
}

std::optional<bool> limited_by_reference(const Json& metrics, const Json& error) {
    if (!error.is_object() || !metrics.is_object()) return std::nullopt;
    const Json own = error.value("psnr_float_db", Json());
    const Json result = metrics.value("psnr_float_db", Json());
    // Without noise of its own a reference limits nothing.
    if (!own.is_number())
        return error.value("relmse", Json()) == 0.0 ? std::optional(false) : std::nullopt;
    const bool is_identical = result.is_null() && metrics.value("relmse", Json()).is_number();
    if (!result.is_number() && !is_identical) return std::nullopt;
    return is_limited(is_identical ? std::nullopt : std::optional(result.get<double>()),
                      own.get<double>());
}

Json part_of_error(const Json& error, const std::string& region) {
    if (region.empty() || !error.is_object()) return error;
    return error.value("regions", Json::object()).value(region, Json());
}

void mark_limited(Json& row) {
    if (!row.contains("metrics")) return;
    const auto flag = [&](const Json& metrics, const std::string& region) {
        const auto is_limited =
            limited_by_reference(metrics, part_of_error(row["reference_error"], region));
        return is_limited ? Json(*is_limited) : Json();
    };
    row["limited_by_reference"] = flag(row["metrics"], "");
    if (!row["metrics"].contains("regions")) return;
    for (const auto& [name, region] : row["metrics"]["regions"].items())
        row["limited_regions"][name] = flag(region, name);
}

double decibels_of(double mse) {
    return -10.0 * std::log10(mse);
}

double mse_of(double decibels) {
    return std::pow(10.0, -0.1 * decibels);
}

}  // namespace vecino
