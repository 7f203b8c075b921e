// SPDX-License-Identifier: Apache-2.0
#include "eval/regions.h"

#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/error.h"
#include "core/json_read.h"

namespace vecino {
namespace {

constexpr double kEdgeRadius = 2;
constexpr double kEmitterRadiiPerWidth = 32;
constexpr double kAlbedoStep = 1e-3;
constexpr double kNormalCosine = 0.95105651629515357;  // of 18 degrees

/// The 8-bit mask of what is within a distance of a marked pixel.
cv::Mat within(const cv::Mat& marked, double radius) {
    // distanceTransform has no "infinitely far" for an image without a zero.
    if (cv::countNonZero(marked) == 0) return cv::Mat::zeros(marked.size(), CV_8U);
    cv::Mat distance;
    cv::distanceTransform(marked == 0, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    // Squared distances are integers: half of one beyond the bound, no rounding of a root matters.
    return distance.mul(distance) <= std::floor(radius * radius) + 0.5;
}

bool emits(glm::vec3 emission) {
    return emission.x > 0 || emission.y > 0 || emission.z > 0;
}

cv::Mat emitter_mask(const Frame& frame) {
    const Extent size = frame.object_id.size();
    cv::Mat mask = cv::Mat::zeros(size.height, size.width, CV_8U);
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            if (frame.object_id(x, y) != kMiss && emits(frame.emission(x, y)))
                mask.at<std::uint8_t>(y, x) = 255;
        }
    }
    return mask;
}

bool albedos_differ(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 step = glm::abs(a - b);
    return step.x > kAlbedoStep || step.y > kAlbedoStep || step.z > kAlbedoStep;
}

/// Whatever their lengths, so that normals that another program wrote need not be of unit length.
bool directions_differ(const glm::dvec3& a, const glm::dvec3& b) {
    return glm::dot(a, b) < kNormalCosine * std::sqrt(glm::dot(a, a) * glm::dot(b, b));
}

bool change_between(const Frame& frame, cv::Point a, cv::Point b) {
    const auto differ = [&](const auto& plane, auto compare) {
        return compare(plane(a.x, a.y), plane(b.x, b.y));
    };
    if (differ(frame.object_id, std::not_equal_to{})) return true;
    if (frame.object_id(a.x, a.y) == kMiss) return false;
    return differ(frame.albedo, albedos_differ) || differ(frame.normal_world, directions_differ);
}

/// Both pixels of every change.
cv::Mat change_mask(const Frame& frame) {
    const Extent size = frame.object_id.size();
    cv::Mat mask = cv::Mat::zeros(size.height, size.width, CV_8U);
    const auto mark = [&](cv::Point a, cv::Point b) {
        if (b.x == size.width || b.y == size.height || !change_between(frame, a, b)) return;
        mask.at<std::uint8_t>(a) = mask.at<std::uint8_t>(b) = 255;
    };
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            mark({x, y}, {x + 1, y});
            mark({x, y}, {x, y + 1});
        }
    }
    return mask;
}

/// Names the planes that are not there, as "albedo, id".
std::string missing_planes(const Frame& frame) {
    std::vector<std::string_view> names;
    for (const PlaneInfo& info : all_planes()) {
        if (kRegionPlanes.has(info.plane) && !planes_of(frame).has(info.plane))
            names.push_back(info.name);
    }
    return join(names);
}

void require_equal_sizes(const Frame& frame) {
    const Extent wanted = frame.object_id.size();
    for (const PlaneInfo& info : all_planes()) {
        const Extent size = std::visit([&](auto m) { return (frame.*m).size(); }, info.member);
        if (!kRegionPlanes.has(info.plane) || size == wanted) continue;
        throw Error(ExitCode::mismatch, "regions: plane " + std::string(info.name) + " is " +
                                            size_text(size) + ", plane id is " + size_text(wanted) +
                                            ": allowed: equal sizes");
    }
}

}  // namespace

bool has_region_planes(const Frame& frame) {
    return missing_planes(frame).empty();
}

RegionMap regions_of(const Frame& frame) {
    if (!has_region_planes(frame)) {
        throw Error(ExitCode::mismatch,
                    "regions need the planes emission, albedo, normal and id, missing: " +
                        missing_planes(frame));
    }
    require_equal_sizes(frame);
    const Extent size = frame.object_id.size();
    RegionMap regions(size, Region::interior);
    cv::Mat view(size.height, size.width, CV_8U, regions.values().data());
    const auto assign = [&](Region region, const cv::Mat& mask) {
        view.setTo(static_cast<double>(region_index(region)), mask);
    };
    // The first match wins, so the last assignment is the first region's.
    assign(Region::edge, within(change_mask(frame), kEdgeRadius));
    assign(Region::emitter, within(emitter_mask(frame), size.width / kEmitterRadiiPerWidth));
    return regions;
}

PerRegion<std::size_t> region_pixels(const RegionMap& regions) {
    PerRegion<std::size_t> pixels{};
    for (const Region region : regions.values()) ++pixels[region_index(region)];
    return pixels;
}

void require_size(const RegionMap& regions, Extent image) {
    if (regions.size() == image) return;
    throw Error(ExitCode::mismatch, "regions are " + size_text(regions.size()) + ", image is " +
                                        size_text(image) + ": allowed: equal sizes");
}

}  // namespace vecino
