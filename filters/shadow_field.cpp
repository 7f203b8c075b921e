// SPDX-License-Identifier: Apache-2.0
#include "filters/shadow_field.h"

#include <algorithm>

#include "core/color.h"
#include "core/parallel.h"

namespace vecino {
namespace {

/// Pixels side by side that lie on one surface alone, and have looked at the light.
struct KnownPixels {
    const PilotBlock& block;
    const float* samples;  ///< points on the light
    const bool* single;    ///< whether a pixel is known to have one surface
};

void put_block(const KnownPixels& known, std::size_t at, FieldRow& row) {
    for (std::size_t i = 0; i < kPilotPixels; ++i) {
        const bool is_there =
            known.single[i] & (known.block.object[i] >= 0) & (known.samples[i] > 0);
        row.object[at + i] = is_there ? known.block.object[i] : kNoField;
        for (int c = 0; c < 3; ++c)
            row.normal[c][at + i] = is_there ? known.block.first_normal[c][i] : 0.0f;
    }
}

}  // namespace

void FieldRow::resize(std::size_t size) {
    object.assign(size, kNoField);
    for (auto* plane :
         {&normal[0], &normal[1], &normal[2], &value, &channel[0], &channel[1], &channel[2]}) {
        plane->resize(size);
    }
    for (auto& plane : normal) std::ranges::fill(plane, 0.0f);
}

void LightField::read(int y, RowRange rows, FieldRow& row) const {
    row.resize(static_cast<std::size_t>(clusters_.width() + 2 * kFieldReach + kPilotPixels));
    if (y < rows.begin || y >= rows.end) return;
    for (int x = 0; x < clusters_.width(); x += kPilotPixels) read_block(x, y, row);
}

void LightField::read_block(int x, int y, FieldRow& row) const {
    const PilotBlock& block = clusters_.block(x, y);
    const PilotLight* const lights = clusters_.lights(x, y);
    const float* const samples = picks_ ? block.shadow_count : lights[light_].open;
    const std::size_t at = field_index(x);
    bool single[kPilotPixels] = {};
    for (int i = 0; i < std::min(kPilotPixels, clusters_.width() - x); ++i)
        single[i] = clusters_.list(x + i, y) == nullptr;
    put_block({block, samples, single}, at, row);
    for (std::size_t i = 0; i < kPilotPixels; ++i) {
        const float share = samples[i] > 0 ? 1.0f / samples[i] : 0.0f;
        if (picks_) {
            const float rgb[] = {lights[0].exact[i], lights[0].open[i], lights[0].seen[i]};
            for (int c = 0; c < kFieldChannels; ++c) row.channel[c][at + i] = rgb[c] * share;
            row.value[at + i] = luminance(rgb[0], rgb[1], rgb[2]) * share;
        } else {
            row.value[at + i] = std::min(lights[light_].seen[i] * share, 1.0f);
            row.channel[0][at + i] = row.value[at + i];
        }
    }
}

void LightField::store(int y, const Smoothed& pixel, PixelClusters& clusters) const {
    const PilotBlock& block = clusters_.block(pixel.x, y);
    const int lane = pixel.x % kPilotPixels;
    if (picks_) {
        float rgb[kFieldChannels];
        for (int c = 0; c < kFieldChannels; ++c)
            rgb[c] = pixel.channel[c] * block.shadow_count[lane];
        clusters.store_picked(pixel.x, y, rgb);
    } else {
        const float open = clusters_.lights(pixel.x, y)[light_].open[lane];
        clusters.store_seen(pixel.x, y, light_, pixel.channel[0] * open);
    }
}

FieldPixels shadow_pixels(RowRange rows, const NeedyRows& needy, int most_samples) {
    FieldPixels out{rows, std::vector<std::vector<int>>(needy.size())};
    for (std::size_t r = 0; r < needy.size(); ++r) {
        for (const NeedyPixel& pixel : needy[r]) {
            const bool few = pixel.samples <= static_cast<std::uint32_t>(most_samples);
            if (few && (pixel.needs & kNeedsShadow) != 0) out.x[r].push_back(pixel.x);
        }
    }
    return out;
}

void smooth_lights(const RecordTracer& tracer, const FieldPixels& pixels,
                   const FieldSmoother& smooth, PixelClusters& clusters) {
    if (std::ranges::all_of(pixels.x, [](const auto& row) { return row.empty(); })) return;
    const bool picks = picks_lights(tracer.task);
    const int lights = picks ? 1 : static_cast<int>(tracer.task.light_count);
    for (int l = 0; l < lights; ++l) {
        const LightField field(clusters, l, picks);
        const SmoothedRows smoothed = smooth(field, pixels);
        // Only now: pixels are smoothed by what their neighbours saw themselves.
        for_each_block(smoothed.size(), 1, tracer.threads, [&](BlockRange block) {
            for (const Smoothed& pixel : smoothed[block.begin])
                field.store(pixels.rows.begin + static_cast<int>(block.begin), pixel, clusters);
        });
    }
}

}  // namespace vecino
