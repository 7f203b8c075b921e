// SPDX-License-Identifier: Apache-2.0
//
// How wrong records are, without a reference: paths at some pixels, held against what records say
// of these.
#pragma once

#include <cstdint>
#include <vector>

#include "filters/needed_samples.h"

namespace vecino {

/// Means over pixels, of squares of differences in sRGB.
struct RecordCheck {
    double error = 0;           ///< of a pixel by records; noise may take it below 0
    double standard_error = 0;  ///< of that error
    double path_noise = 0;      ///< of a pixel by one path for each of its samples
};

/// Whether an error is more than its noise.
bool is_sure(const RecordCheck& check);

struct RecordCheckSize {
    std::size_t pixels;   ///< none: nothing is found out
    std::uint32_t paths;  ///< from each hit
};
constexpr int kCheckedHits = 8;  ///< of each pixel

/// Looks at so many of the pixels.
RecordCheck check_records(const NeedInputs& inputs, const std::vector<Pixel>& pixels,
                          const RecordCheckSize& size);

/// Those that several surfaces may share. needy: of rows.
std::vector<Pixel> shared_pixels(RowRange rows, const NeedyRows& needy);

/// So many from all over rows.
std::vector<Pixel> scattered_pixels(RowRange rows, int width, std::size_t count);

}  // namespace vecino
