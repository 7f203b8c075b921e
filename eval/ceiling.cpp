// SPDX-License-Identifier: Apache-2.0
#include "eval/ceiling.h"

#include <algorithm>
#include <vector>

#include "core/color.h"
#include "core/error.h"
#include "eval/pixel_values.h"
#include "filters/schemes.h"

namespace vecino {
namespace {

void require_input(const Image& reference, Extent low, const RegionMap* regions) {
    const Extent size = reference.size();
    if (low.width < 1 || low.height < 1 || low.width > size.width || low.height > size.height) {
        throw Error(ExitCode::mismatch, "blocky ceiling: low-res size is " + size_text(low) +
                                            ", allowed: from 1x1 to the reference's " +
                                            size_text(size));
    }
    if (regions) require_size(*regions, size);
    if (!std::ranges::all_of(reference.values(), is_finite))
        throw Error(ExitCode::non_finite, "blocky ceiling: the reference has non-finite pixels");
}

/// The number of the group of pixels that share a value, for every pixel.
Grid<std::size_t> groups_of(Extent size, Extent low, const RegionMap* regions) {
    Grid<std::size_t> groups(size);
    for (int y = 0; y < size.height; ++y) {
        const auto low_y = static_cast<std::size_t>(corresponding(y, size.height, low.height));
        for (int x = 0; x < size.width; ++x) {
            const auto low_x = static_cast<std::size_t>(corresponding(x, size.width, low.width));
            const std::size_t block = low_y * static_cast<std::size_t>(low.width) + low_x;
            const std::size_t region = regions ? region_index((*regions)(x, y)) : 0;
            groups(x, y) = block * kRegions.size() + region;
        }
    }
    return groups;
}

struct Mean {
    glm::dvec3 sum{0.0};
    double count = 0;

    [[nodiscard]] glm::vec3 decoded() const {
        const glm::vec3 display(sum / count);
        return {srgb_decode(display.x), srgb_decode(display.y), srgb_decode(display.z)};
    }
};

}  // namespace

Image blocky_ceiling(const Image& reference, Extent low, const RegionMap* regions) {
    require_input(reference, low, regions);
    const Grid<std::size_t> groups = groups_of(reference.size(), low, regions);
    std::vector<Mean> means(low.area() * kRegions.size());
    for (std::size_t i = 0; i < groups.values().size(); ++i) {
        Mean& mean = means[groups.values()[i]];
        mean.sum += glm::dvec3(display_value(reference.values()[i]));
        ++mean.count;
    }
    Image ceiling(reference.size());
    std::ranges::transform(groups.values(), ceiling.values().begin(),
                           [&](std::size_t group) { return means[group].decoded(); });
    return ceiling;
}

}  // namespace vecino
