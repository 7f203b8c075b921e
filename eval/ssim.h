// SPDX-License-Identifier: Apache-2.0
//
// Structural similarity of 8-bit images, at one scale (Wang et al. 2004) and at five (Wang,
// Simoncelli, Bovik 2003). Windows are Gaussian, 11x11, sigma 1.5; K1 .01, K2 .03, range 255.
#pragma once

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

namespace vecino {

constexpr int kSsimWindow = 11;
constexpr int kSsimBorder = kSsimWindow / 2;

/// The coarsest of five scales, each half of the one before, has to hold a window: that many
/// pixels in both axes of the whole image.
constexpr int kMsSsimLeast = 16 * (kSsimWindow - 1) + 1;

/// Two images of equal size, 64-bit floating point, three channels side by side in values of
/// [0,255].
struct SsimPair {
    cv::Mat x, y;
};

struct Ssim {
    /// Per channel, of the pixels whose window stays inside of the image: kSsimBorder smaller on
    /// each side. Empty if the image is smaller than the window.
    std::vector<cv::Mat> maps;
    /// Mean over channels of the product over scales; none below kMsSsimLeast pixels in an axis.
    std::optional<double> multiscale;
};

/// The part of an image of that size that ssim maps show.
cv::Rect ssim_interior(cv::Size image);

Ssim structural_similarity(const SsimPair& images);

}  // namespace vecino
