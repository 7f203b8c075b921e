// SPDX-License-Identifier: Apache-2.0
#include "eval/colour_map.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace vecino {
namespace {

using ColourMap = std::vector<glm::u8vec3>;

// The diverging map has 2 kHalf + 1 entries, so that zero has a colour of its own.
constexpr int kHalf = 256;

ColourMap to_colours(const cv::Mat& rgb_8bit) {
    ColourMap colours;
    for (int i = 0; i < rgb_8bit.cols; ++i) {
        const auto& colour = rgb_8bit.at<cv::Vec3b>(0, i);
        colours.emplace_back(colour[0], colour[1], colour[2]);
    }
    return colours;
}

ColourMap make_sequential_map() {
    cv::Mat ramp(1, 256, CV_8U);
    for (int i = 0; i < ramp.cols; ++i) ramp.at<uchar>(0, i) = static_cast<uchar>(i);
    cv::Mat bgr, rgb;
    cv::applyColorMap(ramp, bgr, cv::COLORMAP_MAGMA);
    cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
    return to_colours(rgb);
}

ColourMap make_diverging_map() {
    const cv::Mat anchors =
        (cv::Mat_<cv::Vec3f>(1, 3) << cv::Vec3f(0.2314f, 0.2980f, 0.7529f),
         cv::Vec3f(0.865f, 0.865f, 0.865f), cv::Vec3f(0.7059f, 0.0157f, 0.1490f));
    cv::Mat anchors_lab;
    cv::cvtColor(anchors, anchors_lab, cv::COLOR_RGB2Lab);
    cv::Mat lab(1, 2 * kHalf + 1, CV_32FC3);
    for (int i = 0; i < lab.cols; ++i) {
        const int from = i < kHalf ? 0 : 1;
        const float t = static_cast<float>(i - from * kHalf) / kHalf;
        lab.at<cv::Vec3f>(0, i) = anchors_lab.at<cv::Vec3f>(0, from) * (1 - t) +
                                  anchors_lab.at<cv::Vec3f>(0, from + 1) * t;
    }
    cv::Mat rgb, rgb_8bit;
    cv::cvtColor(lab, rgb, cv::COLOR_Lab2RGB);
    rgb.convertTo(rgb_8bit, CV_8U, 255);
    return to_colours(rgb_8bit);
}

}  // namespace

glm::u8vec3 sequential_colour(float value) {
    static const ColourMap map = make_sequential_map();
    return map[static_cast<std::size_t>(std::lround(std::clamp(value, 0.0f, 1.0f) * 255))];
}

glm::u8vec3 diverging_colour(float value) {
    static const ColourMap map = make_diverging_map();
    return map[static_cast<std::size_t>(kHalf +
                                        std::lround(std::clamp(value, -1.0f, 1.0f) * kHalf))];
}

}  // namespace vecino
