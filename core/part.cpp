// SPDX-License-Identifier: Apache-2.0
#include "core/part.h"

#include <algorithm>
#include <array>
#include <utility>

#include "core/frame_planes.h"

namespace vecino {

std::string interval_text(SampleInterval samples) {
    return std::to_string(samples.begin) + ":" + std::to_string(samples.end);
}

std::string interval_fault(SampleInterval samples, int spp) {
    const std::string found = "found " + interval_text(samples) + ", allowed: ";
    if (samples.begin < 0 || samples.begin >= samples.end || samples.end > spp) {
        return found + "A:B with 0 <= A < B <= spp, which is " + std::to_string(spp);
    }
    const bool whole_blocks = samples.begin % kBlockSamples == 0 &&
                              (samples.end % kBlockSamples == 0 || samples.end == spp);
    if (whole_blocks) return "";
    return found + "multiples of " + std::to_string(kBlockSamples) + ", or spp as the end";
}

void join(Part& part, Part&& next) {
    part.sums.add(next.sums);
    if (next.samples.begin < part.samples.begin) part.first_hits = std::move(next.first_hits);
    part.samples = {std::min(part.samples.begin, next.samples.begin),
                    std::max(part.samples.end, next.samples.end)};
}

Frame finish(Part&& part, Planes planes, std::uint64_t& non_finite_pixels) {
    const Extent size = part.sums.size();
    planes.add(Plane::radiance);
    const Planes hits = common(planes, kFirstHitPlanes);
    Planes made;
    for (const PlaneInfo& info : all_planes()) {
        if (planes.has(info.plane) && !hits.has(info.plane)) made.add(info.plane);
    }
    Frame frame = make_frame(size, made);
    for (const PlaneInfo& info : all_planes()) {
        if (!hits.has(info.plane)) continue;
        std::visit([&](auto member) { frame.*member = std::move(part.first_hits.*member); },
                   info.member);
    }
    std::array<ExactSum::Digits, kMostSums> sums;
    for (std::size_t i = 0; i < size.area(); ++i) {
        part.sums.load(i, sums);
        const PixelValues values = pixel_values(sums, part.variance_of);
        store_values(values, pixel_at(i, size), frame);
        if (!is_finite(values.radiance())) ++non_finite_pixels;
    }
    return frame;
}

}  // namespace vecino
