// SPDX-License-Identifier: Apache-2.0
//
// The blocky ceiling is the best of all images that are constant per low-res pixel.
#include <algorithm>
#include <cmath>
#include <glm/vec4.hpp>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <tuple>

#include "core/color.h"
#include "core/image_io.h"
#include "eval/ceiling.h"
#include "eval/metrics.h"
#include "eval/pixel_values.h"
#include "filters/schemes.h"
#include "tests/catch.h"
#include "tests/error_of.h"

using namespace vecino;

namespace {

/// 0 to 1.3: some values are clipped.
Image random_image(Extent size, unsigned seed) {
    std::mt19937 engine(seed);
    Image image(size);
    for (glm::vec3& value : image.values())
        for (int c = 0; c < 3; ++c) value[c] = 1.3f * static_cast<float>(engine() % 4096) / 4096.0f;
    return image;
}

Image reference_image(const std::string& name) {
    if (name == "random") return random_image({67, 45}, 1);
    return load_image(VECINO_SOURCE_DIR "/tests/data/" + name + ".exr");
}

/// Bands of all three regions, across the blocks.
RegionMap bands(Extent size) {
    RegionMap regions(size);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            regions(x, y) = static_cast<Region>((x + 2 * y) / 5 % 3);
    return regions;
}

double psnr(const Image& test, const Image& reference) {
    return compare(test, reference).metrics.value().psnr_float_db.value();
}

/// Sums of the squared errors that psnr_float_db is the mean of.
PerRegion<double> squared_errors(const Image& test, const Image& reference,
                                 const RegionMap& regions) {
    PerRegion<double> sums{};
    for (std::size_t i = 0; i < test.values().size(); ++i) {
        const glm::dvec3 error = glm::dvec3(display_value(test.values()[i])) -
                                 glm::dvec3(display_value(reference.values()[i]));
        sums[region_index(regions.values()[i])] +=
            error.x * error.x + error.y * error.y + error.z * error.z;
    }
    return sums;
}

/// What a scheme makes of a low-res image.
Image enlarged(const Image& low, Extent size) {
    Frame frame;
    frame.radiance = low;
    return reconstruct(frame, find_scheme("nearest"), {size, {}, 1}).image;
}

/// One pixel of each block, its middle one.
Image subsampled(const Image& image, Extent low) {
    Image result(low);
    for (int y = 0; y < low.height; ++y)
        for (int x = 0; x < low.width; ++x)
            result(x, y) = image((2 * x + 1) * image.size().width / (2 * low.width),
                                 (2 * y + 1) * image.size().height / (2 * low.height));
    return result;
}

/// The linear mean of each block.
Image box_filtered(const Image& image, Extent low) {
    const Extent size = image.size();
    Image sum(low);
    Grid<float> count(low);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const int u = corresponding(x, size.width, low.width);
            const int v = corresponding(y, size.height, low.height);
            sum(u, v) += image(x, y);
            ++count(u, v);
        }
    for (std::size_t i = 0; i < sum.values().size(); ++i) sum.values()[i] /= count.values()[i];
    return sum;
}

/// Random changes, the same for all pixels of a low-res pixel.
Image perturbed(const Image& image, Extent low, unsigned seed) {
    const float scale = std::pow(10.0f, -0.03f * static_cast<float>(seed) - 1.0f);
    Image changes = random_image(low, seed);
    for (glm::vec3& change : changes.values()) change = scale * (change - 0.65f);
    const Image large = enlarged(changes, image.size());
    Image result = image;
    for (std::size_t i = 0; i < result.values().size(); ++i)
        result.values()[i] += large.values()[i];
    return result;
}

}  // namespace

TEST_CASE("no image that is constant per low-res pixel beats the blocky ceiling", "[ceiling]") {
    const std::string name =
        GENERATE("random", "cornell_sphere_depth2_128", "checker_spheres_depth2_128");
    const int factor = GENERATE(2, 3, 7);
    CAPTURE(name, factor);
    const Image reference = reference_image(name);
    const Extent low = reduced(reference.size(), factor);
    const Image ceiling = blocky_ceiling(reference, low);
    const double best = psnr(ceiling, reference);
    CHECK(psnr(enlarged(subsampled(reference, low), reference.size()), reference) < best);
    CHECK(psnr(enlarged(box_filtered(reference, low), reference.size()), reference) < best);
    const RegionMap whole(reference.size(), Region::interior);
    const double least = squared_errors(ceiling, reference, whole).back();
    double least_perturbed = std::numeric_limits<double>::infinity();
    for (unsigned seed = 0; seed < 100; ++seed) {
        const Image other = perturbed(ceiling, low, seed);
        least_perturbed = std::min(least_perturbed, squared_errors(other, reference, whole).back());
    }
    CHECK(least_perturbed > least);
    CHECK(least_perturbed < 1.1 * least);  // some came near: they are no straw men
}

TEST_CASE("no such image beats the ceiling with regions in any region", "[ceiling]") {
    const std::string name = GENERATE("random", "cornell_sphere_depth2_128");
    CAPTURE(name);
    const Image reference = reference_image(name);
    const RegionMap regions = bands(reference.size());
    const Extent low = reduced(reference.size(), 3);
    const Image ceiling = blocky_ceiling(reference, low, &regions);
    const PerRegion<double> least = squared_errors(ceiling, reference, regions);
    const Image whole = blocky_ceiling(reference, low);
    for (unsigned seed = 0; seed < 101; ++seed) {
        const Image other = seed == 100 ? whole : perturbed(ceiling, low, seed);
        const PerRegion<double> sums = squared_errors(other, reference, regions);
        for (std::size_t i = 0; i < least.size(); ++i) CHECK(sums[i] > least[i]);
    }
}

TEST_CASE("the ceiling is the mean display value of each block, and region", "[ceiling]") {
    const auto [size, low] = GENERATE(table<Extent, Extent>(
        {{{512, 20}, {170, 6}}, {{20, 512}, {9, 170}}, {{31, 17}, {31, 1}}, {{5, 4}, {1, 1}}}));
    const bool with_regions = GENERATE(false, true);
    CAPTURE(size.width, size.height, low.width, low.height, with_regions);
    const Image reference = random_image(size, 2);
    const RegionMap regions = bands(size);
    const auto key_of = [&, wide = size.width, high = size.height, low_size = low](int x, int y) {
        return std::tuple(corresponding(x, wide, low_size.width),
                          corresponding(y, high, low_size.height),
                          with_regions ? regions(x, y) : Region::interior);
    };
    std::map<std::tuple<int, int, Region>, glm::dvec4> sums;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            for (int c = 0; c < 4; ++c)
                sums[key_of(x, y)][c] +=
                    c < 3 ? static_cast<double>(srgb_encode(reference(x, y)[c])) : 1.0;
    const Image ceiling = blocky_ceiling(reference, low, with_regions ? &regions : nullptr);
    double largest = 0;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            for (int c = 0; c < 3; ++c) {
                const glm::dvec4 sum = sums[key_of(x, y)];
                const auto found = static_cast<double>(srgb_encode(ceiling(x, y)[c]));
                largest = std::max(largest, std::abs(found - sum[c] / sum[3]));
            }
    CHECK(largest < 1e-6);
}

TEST_CASE("the ceiling at full resolution is the clipped reference", "[ceiling]") {
    const Image reference = random_image({21, 13}, 3);
    const RegionMap regions = bands(reference.size());
    const RegionMap* const given = GENERATE(false, true) ? &regions : nullptr;
    const Image ceiling = blocky_ceiling(reference, reference.size(), given);
    for (std::size_t i = 0; i < reference.values().size(); ++i)
        for (int c = 0; c < 3; ++c)
            CHECK(ceiling.values()[i][c] ==
                  Approx(std::min(reference.values()[i][c], 1.0f)).epsilon(1e-5).margin(1e-7));
    CHECK(psnr(ceiling, reference) > 120);
}

TEST_CASE("a ceiling needs a size that fits and a finite reference", "[ceiling]") {
    const auto low = GENERATE(Extent{0, 2}, Extent{2, 0}, Extent{5, 2}, Extent{2, 4});
    const Error size_error = error_of([&] { blocky_ceiling(Image({4, 3}), low); });
    CHECK(size_error.code() == ExitCode::mismatch);
    CHECK(std::string(size_error.what()) == "blocky ceiling: low-res size is " + size_text(low) +
                                                ", allowed: from 1x1 to the reference's 4x3");
    const RegionMap regions({3, 4});
    CHECK(error_of([&] {
              blocky_ceiling(Image({4, 3}), {2, 1}, &regions);
          }).code() == ExitCode::mismatch);
    Image reference({4, 3});
    reference(2, 2).y =
        GENERATE(std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN());
    CHECK(error_of([&] { blocky_ceiling(reference, {2, 1}); }).code() == ExitCode::non_finite);
}
