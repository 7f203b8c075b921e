// SPDX-License-Identifier: Apache-2.0
#include "core/accumulate.h"

#include <algorithm>
#include <cmath>

#include "core/clones.h"

namespace vecino {
namespace {

constexpr int kLanes = 16;
using StreamSums = std::array<float, kStreams>;

// Sample i goes to stream i % kStreams; 16 partial sums keep the adds independent of each other.
StreamSums sum_streams(const float* values) {
    std::array<float, kLanes> lanes{};
    for (int i = 0; i < kBlockSamples; i += kLanes) {
        for (int k = 0; k < kLanes; ++k) lanes[static_cast<std::size_t>(k)] += values[i + k];
    }
    StreamSums sums{};
    for (std::size_t s = 0; s < kStreams; ++s) {
        sums[s] = (lanes[s] + lanes[s + 4]) + (lanes[s + 8] + lanes[s + 12]);
    }
    return sums;
}

// In double: 8 partial sums, for the same reason.
VECINO_INLINE double sum_of(const std::array<double, kBlockSamples>& values) {
    std::array<double, 8> lanes{};
    for (std::size_t i = 0; i < kBlockSamples; i += lanes.size()) {
        for (std::size_t k = 0; k < lanes.size(); ++k) lanes[k] += values[i + k];
    }
    return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) +
           ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

/// Squared deviations of n values from their mean; values beyond the first count are not there, and
/// those that were dropped are zeros.
VECINO_CLONES double squared_deviations(const float* samples, std::size_t count, double n) {
    std::array<double, kBlockSamples> values;
    for (std::size_t i = 0; i < kBlockSamples; ++i) values[i] = static_cast<double>(samples[i]);
    const double mean = sum_of(values) / n;
    for (std::size_t i = 0; i < kBlockSamples; ++i) {
        const double deviation = values[i] - mean;
        values[i] = i < count ? deviation * deviation : 0.0;
    }
    const double dropped = static_cast<double>(count) - n;
    return std::max(sum_of(values) - dropped * mean * mean, 0.0);
}

float* part_values(SampleBlock& block, std::size_t part) {
    float(*const planes[])[kBlockSamples] = {block.emission, block.direct, block.indirect};
    return planes[part / 3][part % 3];
}

float radiance(const SampleBlock& block, std::size_t channel, std::size_t i) {
    return block.emission[channel][i] + block.direct[channel][i] + block.indirect[channel][i];
}

bool finite_sample(SampleBlock& block, std::size_t i) {
    float sum = 0;
    for (std::size_t part = 0; part < 9; ++part) sum += part_values(block, part)[i];
    for (std::size_t channel = 0; channel < 3; ++channel) sum += radiance(block, channel, i);
    return std::isfinite(sum);
}

void clear_sample(SampleBlock& block, std::size_t i) {
    for (std::size_t part = 0; part < 9; ++part) part_values(block, part)[i] = 0.0f;
}

}  // namespace

// ---------------------------------------------------------------- from samples to sums

void PixelAccumulator::clear() {
    for (ExactSum& sum : parts_) sum.clear();
    for (ExactSum& sum : squares_) sum.clear();
    for (auto& stream : streams_) {
        for (ExactSum& sum : stream) sum.clear();
    }
    counts_ = {};
    dropped_ = 0;
    freedom_ = 0;
}

void PixelAccumulator::add(SampleBlock& block, int count) {
    const std::uint64_t before = samples();
    for (std::size_t s = 0; s < kStreams; ++s) {
        counts_[s] +=
            static_cast<std::uint64_t>((count + kStreams - 1 - static_cast<int>(s)) / kStreams);
    }
    std::array<StreamSums, kParts> streams;
    std::array<float, kParts> sums;
    float total = 0;
    for (std::size_t part = 0; part < kParts; ++part) {
        const StreamSums& s = streams[part] = sum_streams(part_values(block, part));
        sums[part] = (s[0] + s[1]) + (s[2] + s[3]);
        total += sums[part];
    }
    const bool by_stream = variance_of_ == VarianceOf::streams;
    std::array<std::array<float, 3>, kStreams> radiances;
    for (std::size_t s = 0; by_stream && s < kStreams; ++s) {
        for (std::size_t c = 0; c < 3; ++c) {
            radiances[s][c] = streams[c][s] + streams[c + 3][s] + streams[c + 6][s];
            total += radiances[s][c];
        }
    }
    if (!std::isfinite(total)) {
        add_carefully(block, count);
    } else {
        for (std::size_t part = 0; part < kParts; ++part) parts_[part].add(sums[part]);
        for (std::size_t s = 0; by_stream && s < kStreams; ++s) {
            for (std::size_t c = 0; c < 3; ++c) streams_[s][c].add(radiances[s][c]);
        }
    }
    if (variance_of_ == VarianceOf::samples) add_squares(block, count, samples() - before);
}

// Rare: leaves out the samples that are not finite, and sums the rest without overflow.
void PixelAccumulator::add_carefully(SampleBlock& block, int count) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        const std::size_t stream = i % kStreams;
        if (!finite_sample(block, i)) {
            clear_sample(block, i);
            --counts_[stream];
            ++dropped_;
            continue;
        }
        for (std::size_t part = 0; part < kParts; ++part) {
            parts_[part].add(part_values(block, part)[i]);
        }
        for (std::size_t c = 0; variance_of_ == VarianceOf::streams && c < 3; ++c) {
            streams_[stream][c].add(radiance(block, c, i));
        }
    }
}

void PixelAccumulator::add_squares(const SampleBlock& block, int count, std::uint64_t kept) {
    if (kept < 2) return;
    std::array<float, kBlockSamples> values;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        for (std::size_t i = 0; i < kBlockSamples; ++i) values[i] = radiance(block, channel, i);
        squares_[channel].add_rounded(squared_deviations(
            values.data(), static_cast<std::size_t>(count), static_cast<double>(kept)));
    }
    freedom_ += kept - 1;
}

std::uint64_t PixelAccumulator::samples() const {
    return counts_[0] + counts_[1] + counts_[2] + counts_[3];
}

// ---------------------------------------------------------------- from sums to values

namespace {

ExactSum::Digits count_digits(std::uint64_t count) {
    ExactSum sum;
    sum.add_count(count);
    return sum.digits();
}

constexpr std::size_t kCounts = 9;  ///< index of the first count

using Sums = std::span<const ExactSum::Digits>;

glm::vec3 mean(Sums parts, double n) {
    glm::vec3 result;
    for (int c = 0; c < 3; ++c) {
        result[c] = static_cast<float>(ExactSum::value(parts[static_cast<std::size_t>(c)]) / n);
    }
    return result;
}

/// Unbiased for the variance of a sample, from what it is within each block.
glm::vec3 variance_of_samples(Sums sums, double n) {
    const double freedom = ExactSum::value(sums[kCounts + 4]);
    glm::vec3 result(0.0f);
    for (int c = 0; c < 3 && freedom > 0; ++c) {
        const double squares = ExactSum::value(sums[kCounts + 1 + static_cast<std::size_t>(c)]);
        result[c] = static_cast<float>(squares / freedom / n);
    }
    return result;
}

/// Streams differ by at most one sample, so the weighted spread of their means estimates the
/// variance of one sample of a stream; that of the pixel mean is a total-th of it.
float variance_of_streams(const std::array<double, kStreams>& sums,
                          const std::array<double, kStreams>& counts) {
    const double total = counts[0] + counts[1] + counts[2] + counts[3];
    const double mean_of_all = (sums[0] + sums[1] + sums[2] + sums[3]) / total;
    double spread = 0;
    int streams = 0;
    for (std::size_t s = 0; s < kStreams; ++s) {
        if (counts[s] == 0) continue;
        const double deviation = sums[s] / counts[s] - mean_of_all;
        spread += counts[s] * deviation * deviation;
        ++streams;
    }
    return streams > 1 ? static_cast<float>(spread / (streams - 1) / total) : 0.0f;
}

glm::vec3 variance_of_streams(Sums sums) {
    std::array<double, kStreams> counts;
    for (std::size_t s = 0; s < kStreams; ++s) counts[s] = ExactSum::value(sums[kCounts + s]);
    glm::vec3 result;
    for (std::size_t c = 0; c < 3; ++c) {
        std::array<double, kStreams> light;
        for (std::size_t s = 0; s < kStreams; ++s) {
            light[s] = ExactSum::value(sums[kCounts + kStreams + 3 * s + c]);
        }
        result[static_cast<int>(c)] = variance_of_streams(light, counts);
    }
    return result;
}

}  // namespace

void PixelAccumulator::sums(std::span<ExactSum::Digits> out) const {
    auto to = out.begin();
    for (const ExactSum& sum : parts_) *to++ = sum.digits();
    if (variance_of_ == VarianceOf::streams) {
        for (const std::uint64_t count : counts_) *to++ = count_digits(count);
        for (const auto& stream : streams_) {
            for (const ExactSum& sum : stream) *to++ = sum.digits();
        }
        return;
    }
    *to++ = count_digits(samples());
    if (variance_of_ == VarianceOf::nothing) return;
    for (const ExactSum& sum : squares_) *to++ = sum.digits();
    *to++ = count_digits(freedom_);
}

PixelValues pixel_values(Sums sums, VarianceOf variance_of) {
    const bool by_stream = variance_of == VarianceOf::streams;
    PixelValues values;
    double n = 0;
    for (std::size_t i = 0; i < (by_stream ? kStreams : 1u); ++i) {
        n += ExactSum::value(sums[kCounts + i]);
    }
    values.samples = static_cast<std::uint64_t>(n);
    if (values.samples == 0) return values;
    values.emission = mean(sums.subspan(0, 3), n);
    values.direct = mean(sums.subspan(3, 3), n);
    values.indirect = mean(sums.subspan(6, 3), n);
    if (values.samples < 2 || variance_of == VarianceOf::nothing) return values;
    values.variance = by_stream ? variance_of_streams(sums) : variance_of_samples(sums, n);
    return values;
}

std::vector<std::string> sum_names(VarianceOf variance_of) {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name) {
        for (const char channel : {'R', 'G', 'B'}) names.push_back(name + "." + channel);
    };
    for (const char* part : {"Emission", "Direct", "Indirect"}) add(part);
    if (variance_of == VarianceOf::streams) {
        for (int s = 0; s < kStreams; ++s) names.push_back("Count" + std::to_string(s));
        for (int s = 0; s < kStreams; ++s) add("Stream" + std::to_string(s));
        return names;
    }
    names.emplace_back("Count");
    if (variance_of == VarianceOf::nothing) return names;
    add("Squares");
    names.emplace_back("Freedom");
    return names;
}

}  // namespace vecino
