// SPDX-License-Identifier: Apache-2.0
//
// Renders in parts: each has some of the samples of every pixel. Parts hold exact sums, so that
// joining them, in any order and in any tree, gives the bits of the render in one go.
#pragma once

#include <cstdint>
#include <string>

#include "core/accumulate.h"
#include "core/render.h"
#include "core/sample_sums.h"

namespace vecino {

/// Samples [begin, end) of each pixel.
struct SampleInterval {
    int begin = 0;
    int end = 0;
    friend bool operator==(const SampleInterval&, const SampleInterval&) = default;
};

/// "0:128"
std::string interval_text(SampleInterval samples);

/// What some of the samples of a render came to.
struct Part {
    SampleInterval samples;
    Planes planes;  ///< of the whole render
    VarianceOf variance_of = VarianceOf::nothing;
    SampleSums sums;
    Frame first_hits;  ///< planes of the first hit, in the part with sample 0 alone
};

struct PartRender {
    Part part;
    RenderStatistics statistics;  ///< counts are of this part alone
};

/// Those asked for, radiance, and not the variance of one sample.
Planes planes_to_make(const RenderSettings& settings);

/// How the variance plane of a render is estimated, if it has one.
VarianceOf variance_of(const RenderSettings& settings);

/// Empty, or what is wrong with an interval of a render's samples: "found ..., allowed: ...".
std::string interval_fault(SampleInterval samples, int spp);

/// Traces samples [begin, end) of the settings' spp. Throws as render() does, and Error(usage) for
/// an interval that does not fit or a scene without samples. Memory beside that of the first hits:
/// SampleSums.
PartRender render_part(const Scene& scene, const RenderSettings& settings, SampleInterval samples,
                       const Progress& progress = {});

/// Adds a part of the same render whose samples are next to those of the first, on either side.
void join(Part& part, Part&& next);

/// The planes asked for, from a part that has all samples; pixels whose radiance is not finite are
/// counted. Precondition: part.planes has them.
Frame finish(Part&& part, Planes planes, std::uint64_t& non_finite_pixels);

}  // namespace vecino
