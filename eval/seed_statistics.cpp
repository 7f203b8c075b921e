// SPDX-License-Identifier: Apache-2.0
#include "eval/seed_statistics.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <numeric>
#include <string>

#include "eval/pixel_values.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

double sum_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Weighted sums of squares over pixels and channels, by seed, in one space.
struct Squares {
    explicit Squares(std::size_t seeds) : error(seeds), deviation(seeds) {}

    std::vector<double> error;      ///< from the reference
    std::vector<double> deviation;  ///< from the mean over seeds

    /// One channel value of every seed.
    void add(const std::vector<double>& values, double reference, double weight) {
        const double mean = sum_of(values) / static_cast<double>(values.size());
        for (std::size_t i = 0; i < values.size(); ++i) {
            error[i] += weight * (values[i] - reference) * (values[i] - reference);
            deviation[i] += weight * (values[i] - mean) * (values[i] - mean);
        }
    }
};

struct Sums {
    explicit Sums(std::size_t seeds) : display(seeds), relative(seeds) {}

    std::size_t pixels = 0;
    Squares display, relative;
};

/// With q_i the mean of (X_i - mean over seeds)^2 and Q their sum, the mean of (X_i - X_j)^2
/// sums up to n Q over all pairs and to n q_i + Q over those of seed i: no pair need be visited.
ErrorSplit split_of(const Squares& sums, std::size_t pixels) {
    ErrorSplit result;
    if (pixels == 0) return result;
    const auto per_value = [&](double sum) { return sum / (3 * static_cast<double>(pixels)); };
    std::ranges::transform(sums.error, std::back_inserter(result.mse), per_value);
    const auto n = static_cast<double>(sums.error.size());
    if (n < 2) return result;
    const double total = per_value(sum_of(sums.deviation));
    const double noise = total / (n - 1);
    result.noise = noise;
    result.bias2 = sum_of(result.mse) / n - noise;
    if (n < 3) return result;
    for (std::size_t i = 0; i < sums.error.size(); ++i) {
        const double own = per_value(sums.deviation[i]);
        const double noise_without = ((n - 1) * total - n * own) / ((n - 1) * (n - 2));
        result.noise_by_seed.push_back(n * noise - (n - 1) * noise_without);
        result.bias2_by_seed.push_back(result.mse[i] - result.noise_by_seed[i]);
    }
    return result;
}

SeedStatistics statistics_of(const Sums& sums) {
    SeedStatistics result;
    static_cast<ErrorSplit&>(result) = split_of(sums.display, sums.pixels);
    result.relative = split_of(sums.relative, sums.pixels);
    result.pixels = sums.pixels;
    return result;
}

Image display_image(const Image& image) {
    Image display(image.size());
    std::ranges::transform(image.values(), display.values().begin(), display_value);
    return display;
}

bool all_finite(const Image& image) {
    return std::ranges::all_of(image.values(), is_finite);
}

/// The whole image's sums, then, if there are regions, theirs.
std::vector<Sums> sum_up(std::span<const Image> images, const Image& reference,
                         const RegionMap* regions) {
    std::vector<Image> display;
    std::ranges::transform(images, std::back_inserter(display), display_image);
    std::vector<Sums> sums(1 + (regions ? kRegions.size() : 0), Sums(images.size()));
    std::vector<double> values(images.size());
    const auto fill = [&](const auto& from, std::size_t pixel, int channel) {
        std::ranges::transform(from, values.begin(), [&](const Image& image) {
            return static_cast<double>(image.values()[pixel][channel]);
        });
    };
    for (std::size_t p = 0; p < reference.values().size(); ++p) {
        const glm::vec3 wanted = display_value(reference.values()[p]);
        Sums* const region = regions ? &sums[1 + region_index(regions->values()[p])] : nullptr;
        ++sums[0].pixels;
        if (region) ++region->pixels;
        for (int c = 0; c < 3; ++c) {
            fill(display, p, c);
            sums[0].display.add(values, static_cast<double>(wanted[c]), 1);
            if (region) region->display.add(values, static_cast<double>(wanted[c]), 1);
            const auto linear = static_cast<double>(reference.values()[p][c]);
            const double weight = 1 / (linear * linear + 0.01);
            fill(images, p, c);
            sums[0].relative.add(values, linear, weight);
            if (region) region->relative.add(values, linear, weight);
        }
    }
    return sums;
}

Json optional_json(const std::optional<double>& value) {
    return value ? Json(*value) : Json(nullptr);
}

Json split_json(const ErrorSplit& s) {
    return {{"mse", s.mse},
            {"noise", optional_json(s.noise)},
            {"bias2", optional_json(s.bias2)},
            {"noise_by_seed", s.noise_by_seed},
            {"bias2_by_seed", s.bias2_by_seed}};
}

Json one_json(const SeedStatistics& s) {
    Json json = split_json(s);
    json["pixels"] = s.pixels;
    json["relative"] = split_json(s.relative);
    return json;
}

std::optional<double> read_optional(const JsonValue& json) {
    if (json.raw().is_null()) return std::nullopt;
    return json.number();
}

std::vector<double> read_numbers(const JsonValue& json) {
    std::vector<double> numbers;
    for (const JsonValue& element : json.elements()) numbers.push_back(element.number());
    return numbers;
}

ErrorSplit read_split(const JsonValue& json) {
    ErrorSplit s;
    s.mse = read_numbers(json.at("mse"));
    s.noise = read_optional(json.at("noise"));
    s.bias2 = read_optional(json.at("bias2"));
    s.noise_by_seed = read_numbers(json.at("noise_by_seed"));
    s.bias2_by_seed = read_numbers(json.at("bias2_by_seed"));
    return s;
}

SeedStatistics read_one(const JsonValue& json) {
    SeedStatistics s;
    static_cast<ErrorSplit&>(s) = read_split(json);
    s.pixels =
        static_cast<std::size_t>(json.at("pixels").integer(0, std::numeric_limits<int>::max()));
    s.relative = read_split(json.at("relative"));
    return s;
}

}  // namespace

ErrorSplit ErrorSplit::without_reference(double reference_mse) const {
    ErrorSplit result = *this;
    if (result.bias2) *result.bias2 -= reference_mse;
    for (double& value : result.bias2_by_seed) value -= reference_mse;
    return result;
}

std::optional<SeedStatisticsByRegion> seed_statistics(std::span<const Image> images,
                                                      const Image& reference,
                                                      const RegionMap* regions) {
    for (const Image& image : images) require_comparable(image, reference);
    if (regions) require_size(*regions, reference.size());
    if (images.empty() || !all_finite(reference) || !std::ranges::all_of(images, all_finite))
        return std::nullopt;

    const std::vector<Sums> sums = sum_up(images, reference, regions);
    SeedStatisticsByRegion result{.whole = statistics_of(sums[0]), .regions = {}};
    if (!regions) return result;
    auto& by_region = result.regions.emplace();
    std::transform(sums.begin() + 1, sums.end(), by_region.begin(), statistics_of);
    return result;
}

Json seed_statistics_json(const SeedStatisticsByRegion& statistics) {
    Json json = one_json(statistics.whole);
    if (!statistics.regions) return json;
    for (const RegionInfo& info : kRegions) {
        json["regions"][std::string(info.name)] =
            one_json((*statistics.regions)[region_index(info.region)]);
    }
    return json;
}

SeedStatisticsByRegion read_seed_statistics(const JsonValue& json) {
    SeedStatisticsByRegion result{.whole = read_one(json), .regions = {}};
    if (!json.has("regions")) return result;
    auto& by_region = result.regions.emplace();
    for (const RegionInfo& info : kRegions)
        by_region[region_index(info.region)] = read_one(json.at("regions").at(info.name));
    return result;
}

}  // namespace vecino
