// SPDX-License-Identifier: Apache-2.0
#include "eval/signature_pixels.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"

namespace vecino {
namespace {

constexpr float kInside_px = 2;

bool is_one_of(const std::vector<int>& objects, int object) {
    return std::ranges::find(objects, object) != objects.end();
}

void require_ids(const Frame& reference) {
    if (reference.object_id.size() == reference.radiance.size()) return;
    throw Error(ExitCode::mismatch, "signature: the reference has no plane id, allowed: with it");
}

/// To the nearest pixel for which `is` holds; far beyond any image where there is none.
cv::Mat distance_to(const Frame& reference, const std::function<bool(int)>& is) {
    const Extent size = reference.object_id.size();
    cv::Mat mask(size.height, size.width, CV_8U);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
            mask.at<std::uint8_t>(y, x) = is(reference.object_id(x, y)) ? 0 : 255;
    // distanceTransform has no "infinitely far" for an image without a zero.
    if (cv::countNonZero(mask) == size.width * size.height)
        return {size.height, size.width, CV_32F, cv::Scalar(1e9)};
    cv::Mat distance;
    cv::distanceTransform(mask, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    return distance;
}

bool is_in_box(const std::array<float, 4>& box, glm::ivec2 pixel, Extent size) {
    const double u = (pixel.x + 0.5) / size.width;
    const double v = (pixel.y + 0.5) / size.height;
    return u >= double{box[0]} && v >= double{box[1]} && u < double{box[2]} && v < double{box[3]};
}

}  // namespace

std::vector<glm::ivec2> pixels_of(const Where& where, const Frame& reference) {
    const Extent size = reference.radiance.size();
    if (!where.on.empty() || !where.near.empty()) require_ids(reference);
    cv::Mat distance;
    if (!where.near.empty())
        distance = distance_to(reference, [&](int id) { return is_one_of(where.near, id); });
    std::vector<glm::ivec2> pixels;
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            if (!is_in_box(where.box, {x, y}, size)) continue;
            if (!where.on.empty() && !is_one_of(where.on, reference.object_id(x, y))) continue;
            const float d = distance.empty() ? where.within_px[0] : distance.at<float>(y, x);
            if (d >= where.within_px[0] && d <= where.within_px[1]) pixels.emplace_back(x, y);
        }
    }
    if (pixels.empty())
        throw Error(ExitCode::usage,
                    "signature: found no pixel that \"where\" names, allowed: at least one");
    return pixels;
}

std::vector<PixelPair> neighbours(const std::vector<glm::ivec2>& pixels, Extent size) {
    Grid<std::uint8_t> is_in(size);
    for (const glm::ivec2 p : pixels) is_in(p.x, p.y) = 1;
    std::vector<PixelPair> pairs;
    for (const glm::ivec2 p : pixels) {
        if (p.x + 1 < size.width && is_in(p.x + 1, p.y) != 0)
            pairs.emplace_back(p, glm::ivec2(p.x + 1, p.y));
        if (p.y + 1 < size.height && is_in(p.x, p.y + 1) != 0)
            pairs.emplace_back(p, glm::ivec2(p.x, p.y + 1));
    }
    return pairs;
}

std::size_t outline_px(const std::vector<int>& objects, const Frame& reference) {
    require_ids(reference);
    const cv::Mat distance =
        distance_to(reference, [&](int id) { return !is_one_of(objects, id); });
    std::size_t count = 0;
    for (int y = 0; y < distance.rows; ++y) {
        for (int x = 0; x < distance.cols; ++x) {
            const float d = distance.at<float>(y, x);
            count += d > 0 && d <= 1 ? 1 : 0;
        }
    }
    return count;
}

glm::dvec3 mean_radiance(int object, const Frame& reference) {
    require_ids(reference);
    const cv::Mat distance = distance_to(reference, [&](int id) { return id != object; });
    glm::dvec3 inside(0.0), all(0.0);
    double inside_count = 0, count = 0;
    for (int y = 0; y < distance.rows; ++y) {
        for (int x = 0; x < distance.cols; ++x) {
            const float d = distance.at<float>(y, x);
            if (!(d > 0)) continue;
            const glm::dvec3 radiance(reference.radiance(x, y));
            all += radiance;
            ++count;
            if (d <= kInside_px) continue;
            inside += radiance;
            ++inside_count;
        }
    }
    if (count == 0)
        throw Error(ExitCode::usage, "signature: found no pixel of object " +
                                         std::to_string(object) + ", allowed: at least one");
    return inside_count > 0 ? inside / inside_count : all / count;
}

}  // namespace vecino
