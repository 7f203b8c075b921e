// SPDX-License-Identifier: Apache-2.0
#include "core/accumulate.h"

#include <cmath>

namespace vecino {
namespace {

constexpr int kLanes = 16;
using PartSums = std::array<float, kStreams>;

// Sample i goes to stream i % kStreams; 16 partial sums keep the adds independent of each other.
PartSums sum_streams(const float* values) {
    std::array<float, kLanes> lanes{};
    for (int i = 0; i < kBlockSamples; i += kLanes) {
        for (int k = 0; k < kLanes; ++k) lanes[static_cast<std::size_t>(k)] += values[i + k];
    }
    PartSums sums{};
    for (std::size_t s = 0; s < kStreams; ++s) {
        sums[s] = (lanes[s] + lanes[s + 4]) + (lanes[s + 8] + lanes[s + 12]);
    }
    return sums;
}

float* part_values(SampleBlock& block, int part) {
    float(*const planes[])[kBlockSamples] = {block.emission, block.direct, block.indirect};
    return planes[part / 3][part % 3];
}

bool finite_sample(SampleBlock& block, int i) {
    float sum = 0;
    for (int part = 0; part < 9; ++part) sum += part_values(block, part)[i];
    return std::isfinite(sum);
}

void clear_sample(SampleBlock& block, int i) {
    for (int part = 0; part < 9; ++part) part_values(block, part)[i] = 0.0f;
}

}  // namespace

void PixelAccumulator::add(SampleBlock& block, int count) {
    for (std::size_t s = 0; s < kStreams; ++s) {
        counts_[s] +=
            static_cast<std::uint64_t>((count + kStreams - 1 - static_cast<int>(s)) / kStreams);
    }
    std::array<PartSums, kParts> sums{};
    float total = 0;
    for (std::size_t part = 0; part < kParts; ++part) {
        sums[part] = sum_streams(part_values(block, static_cast<int>(part)));
        for (const float sum : sums[part]) total += sum;
    }
    if (std::isfinite(total)) {
        for (std::size_t part = 0; part < kParts; ++part) {
            for (std::size_t s = 0; s < kStreams; ++s)
                sums_[part][s] += static_cast<double>(sums[part][s]);
        }
    } else {
        add_carefully(block, count);
    }
    if (variance_of_ == VarianceOf::samples) add_spread(block, count);
}

// Rare: leaves out the samples that are not finite, and sums the rest without overflow.
void PixelAccumulator::add_carefully(SampleBlock& block, int count) {
    for (int i = 0; i < count; ++i) {
        const auto stream = static_cast<std::size_t>(i % kStreams);
        if (!finite_sample(block, i)) {
            clear_sample(block, i);
            --counts_[stream];
            ++dropped_;
        }
        for (std::size_t part = 0; part < kParts; ++part) {
            sums_[part][stream] +=
                static_cast<double>(part_values(block, static_cast<int>(part))[i]);
        }
    }
}

void PixelAccumulator::add_spread(const SampleBlock& block, int count) {
    const auto added = samples() - spread_count_;
    if (added == 0) return;
    const auto n = static_cast<double>(spread_count_);
    const auto m = static_cast<double>(added);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        std::array<float, kBlockSamples> values;
        double sum = 0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            values[i] =
                block.emission[channel][i] + block.direct[channel][i] + block.indirect[channel][i];
            sum += static_cast<double>(values[i]);
        }
        const double block_mean = sum / m;
        double squares = 0;
        for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
            const double deviation = static_cast<double>(values[i]) - block_mean;
            squares += deviation * deviation;
        }
        // Dropped samples stand in the block as zeros: take them out again.
        squares -= (static_cast<double>(count) - m) * block_mean * block_mean;
        const double delta = block_mean - running_mean_[channel];
        squared_deviations_[channel] += squares + delta * delta * n * m / (n + m);
        running_mean_[channel] += delta * m / (n + m);
    }
    spread_count_ += added;
}

std::uint64_t PixelAccumulator::samples() const {
    std::uint64_t total = 0;
    for (const std::uint64_t count : counts_) total += count;
    return total;
}

glm::vec3 PixelAccumulator::mean(std::size_t first_part) const {
    const std::uint64_t n = samples();
    if (n == 0) return glm::vec3(0.0f);
    glm::vec3 result;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const auto& streams = sums_[first_part + channel];
        const double sum = (streams[0] + streams[1]) + (streams[2] + streams[3]);
        result[static_cast<int>(channel)] = static_cast<float>(sum / static_cast<double>(n));
    }
    return result;
}

double PixelAccumulator::stream_variance(int channel) const {
    const auto total = static_cast<double>(samples());
    const auto c = static_cast<std::size_t>(channel);
    const auto sum_of = [&](std::size_t s) {
        return sums_[c][s] + sums_[c + 3][s] + sums_[c + 6][s];
    };
    const double mean_of_all = (sum_of(0) + sum_of(1) + sum_of(2) + sum_of(3)) / total;
    // Streams differ by at most one sample, so the weighted spread of their means estimates
    // the variance of one sample of a stream; that of the pixel mean is a total-th of it.
    double spread = 0;
    int streams = 0;
    for (std::size_t s = 0; s < kStreams; ++s) {
        if (counts_[s] == 0) continue;
        const auto n = static_cast<double>(counts_[s]);
        const double deviation = sum_of(s) / n - mean_of_all;
        spread += n * deviation * deviation;
        ++streams;
    }
    return streams > 1 ? spread / (streams - 1) / total : 0.0;
}

glm::vec3 PixelAccumulator::variance() const {
    const auto n = static_cast<double>(samples());
    if (n < 2.0) return glm::vec3(0.0f);
    glm::vec3 result(0.0f);
    for (int channel = 0; channel < 3; ++channel) {
        const double value =
            variance_of_ == VarianceOf::streams
                ? stream_variance(channel)
                : squared_deviations_[static_cast<std::size_t>(channel)] / (n - 1.0) / n;
        result[channel] = static_cast<float>(value);
    }
    return result;
}

}  // namespace vecino
