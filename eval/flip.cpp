// SPDX-License-Identifier: Apache-2.0
#include "eval/flip.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace vecino {
namespace {

constexpr double kPi = 3.14159265358979323846;

// The paper's: how colour differences are compressed (exponent, and the share of the largest one
// up to which they take the range to 0.95), and how features widen them.
constexpr float kColourExponent = 0.7f;
constexpr float kColourShare = 0.4f;
constexpr float kColourKnee = 0.95f;
constexpr float kFeatureExponent = 0.5f;
constexpr double kFeatureWidth_degrees = 0.082;

/// What the contrast sensitivity of the eye leaves of a channel: a sum of Gaussians
/// a sqrt(pi/b) exp(-pi^2 x^2 / b) of the distance x in degrees.
struct Sensitivity {
    double a, b;
};
constexpr Sensitivity kAchromatic{1, 0.0047}, kRedGreen{1, 0.0053};
constexpr Sensitivity kBlueYellow[] = {{34.1, 0.04}, {13.5, 0.025}};

constexpr glm::vec3 kIlluminant{0.950428545f, 1.0f, 1.088900371f};
constexpr glm::vec3 kInverseIlluminant{1.052156925f, 1.0f, 0.918357670f};

glm::vec3 xyz_of_rgb(glm::vec3 c) {
    return {(10135552.0f * c.x + 8788810.0f * c.y + 4435075.0f * c.z) / 24577794.0f,
            (2613072.0f * c.x + 8788810.0f * c.y + 887015.0f * c.z) / 12288897.0f,
            (1425312.0f * c.x + 8788810.0f * c.y + 70074185.0f * c.z) / 73733382.0f};
}

glm::vec3 rgb_of_xyz(glm::vec3 c) {
    return {3.241003275f * c.x - 1.537398934f * c.y - 0.498615861f * c.z,
            -0.969224334f * c.x + 1.875930071f * c.y + 0.041554224f * c.z,
            0.055639423f * c.x - 0.204011202f * c.y + 1.057148933f * c.z};
}

/// From values relative to the illuminant: CIELAB of their cube roots, YCxCz of themselves.
glm::vec3 opponent(glm::vec3 c) {
    return {116.0f * c.y - 16.0f, 500.0f * (c.x - c.y), 200.0f * (c.y - c.z)};
}

glm::vec3 ycxcz_of_rgb(glm::vec3 linear) {
    return opponent(xyz_of_rgb(linear) * kInverseIlluminant);
}

glm::vec3 rgb_of_ycxcz(glm::vec3 c) {
    const float y = (c.x + 16.0f) / 116.0f;
    return rgb_of_xyz(glm::vec3(y + c.y / 500.0f, y, y - c.z / 200.0f) * kIlluminant);
}

float lab_root(float t) {
    constexpr float delta = 6.0f / 29.0f;
    return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0f / 29.0f;
}

/// CIELAB, its chroma lowered with the lightness (the Hunt effect).
glm::vec3 hunt_lab_of_rgb(glm::vec3 linear) {
    const glm::vec3 c = xyz_of_rgb(linear) * kInverseIlluminant;
    const glm::vec3 lab = opponent({lab_root(c.x), lab_root(c.y), lab_root(c.z)});
    return {lab.x, 0.01f * lab.x * lab.y, 0.01f * lab.x * lab.z};
}

float hyab(glm::vec3 a, glm::vec3 b) {
    const glm::vec3 d = a - b;
    return std::abs(d.x) + std::sqrt(d.y * d.y + d.z * d.z);
}

float compressed(float distance) {
    return std::pow(distance, kColourExponent);
}

/// The largest colour difference there is: of green and blue.
float largest_difference() {
    return compressed(hyab(hunt_lab_of_rgb({0, 1, 0}), hunt_lab_of_rgb({0, 0, 1})));
}

/// A channel each, 32-bit floating point.
struct Planes3 {
    cv::Mat x, y, z;

    explicit Planes3(cv::Size size) : x(size, CV_32F), y(size, CV_32F), z(size, CV_32F) {}
    Planes3(cv::Mat x_, cv::Mat y_, cv::Mat z_)
        : x(std::move(x_)), y(std::move(y_)), z(std::move(z_)) {}

    [[nodiscard]] glm::vec3 at(int row, int column) const {
        return {x.at<float>(row, column), y.at<float>(row, column), z.at<float>(row, column)};
    }
};

/// Along one axis, symmetric about its middle.
using Kernel = cv::Mat;

template <class Value>
Kernel kernel(int radius, Value value) {
    Kernel result(2 * radius + 1, 1, CV_64F);
    for (int i = -radius; i <= radius; ++i) result.at<double>(i + radius) = value(double(i));
    return result;
}

cv::Mat filtered(const cv::Mat& values, const Kernel& along_x, const Kernel& along_y) {
    cv::Mat result;
    cv::sepFilter2D(values, result, CV_32F, along_x, along_y, {-1, -1}, 0, cv::BORDER_REPLICATE);
    return result;
}

/// All of one radius: three standard deviations of the widest.
Kernel sensitivity_kernel(const Sensitivity& s) {
    const double widest = kBlueYellow[0].b / (2 * kPi * kPi);
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(widest) * kFlipPixelsPerDegree));
    return kernel(radius, [&](double pixels) {
        const double degrees = pixels / kFlipPixelsPerDegree;
        return std::sqrt(s.a * std::sqrt(kPi / s.b)) *
               std::exp(-kPi * kPi * degrees * degrees / s.b);
    });
}

/// The colours that are left at that distance from the screen, as linear RGB.
Planes3 seen(const Planes3& ycxcz) {
    const auto single = [](const Sensitivity& s) {
        const Kernel k = sensitivity_kernel(s);
        return Kernel(k / cv::sum(k)[0]);
    };
    const Kernel achromatic = single(kAchromatic);
    const Kernel red_green = single(kRedGreen);
    const Kernel first = sensitivity_kernel(kBlueYellow[0]);
    const Kernel second = sensitivity_kernel(kBlueYellow[1]);
    const double norm = std::hypot(cv::sum(first)[0], cv::sum(second)[0]);
    const Kernel wide = first / norm;
    const Kernel narrow = second / norm;
    return {filtered(ycxcz.x, achromatic, achromatic), filtered(ycxcz.y, red_green, red_green),
            filtered(ycxcz.z, wide, wide) + filtered(ycxcz.z, narrow, narrow)};
}

/// Lightness and chroma as seen, of every pixel.
Planes3 seen_lab(const Planes3& ycxcz) {
    Planes3 result = seen(ycxcz);
    for (int row = 0; row < result.x.rows; ++row) {
        for (int column = 0; column < result.x.cols; ++column) {
            const glm::vec3 rgb = rgb_of_ycxcz(result.at(row, column));
            const glm::vec3 lab =
                hunt_lab_of_rgb({std::clamp(rgb.x, 0.0f, 1.0f), std::clamp(rgb.y, 0.0f, 1.0f),
                                 std::clamp(rgb.z, 0.0f, 1.0f)});
            result.x.at<float>(row, column) = lab.x;
            result.y.at<float>(row, column) = lab.y;
            result.z.at<float>(row, column) = lab.z;
        }
    }
    return result;
}

/// Positive and negative weights each sum up to 1.
Kernel balanced(const Kernel& k) {
    const double positive = cv::sum(cv::max(k, 0.0))[0];
    const double negative = -cv::sum(cv::min(k, 0.0))[0];
    return cv::max(k, 0.0) / positive + cv::min(k, 0.0) / negative;
}

/// How much of an edge and of a point there is at every pixel.
struct Features {
    cv::Mat edge, point;
};

Features features_of(const cv::Mat& lightness) {
    const double sigma = 0.5 * kFeatureWidth_degrees * kFlipPixelsPerDegree;
    const int radius = static_cast<int>(std::ceil(3 * sigma));
    const auto gauss = [&](double x) { return std::exp(-x * x / (2 * sigma * sigma)); };
    Kernel smooth = kernel(radius, gauss);
    smooth /= cv::sum(smooth)[0];
    const Kernel slope = balanced(kernel(radius, [&](double x) { return -x * gauss(x); }));
    const Kernel bend = balanced(
        kernel(radius, [&](double x) { return (x * x / (sigma * sigma) - 1) * gauss(x); }));
    const cv::Mat unit = lightness / 116.0 + 16.0 / 116.0;
    const auto strength = [&](const Kernel& k) {
        cv::Mat result;
        cv::magnitude(filtered(unit, k, smooth), filtered(unit, smooth, k), result);
        return result;
    };
    return {strength(slope), strength(bend)};
}

/// 0 for equal colours, 1 for the largest difference.
float colour_error(glm::vec3 test_lab, glm::vec3 reference_lab, float largest) {
    const float difference = compressed(hyab(test_lab, reference_lab));
    const float knee = kColourShare * largest;
    if (difference < knee) return difference * kColourKnee / knee;
    return kColourKnee + (difference - knee) / (largest - knee) * (1 - kColourKnee);
}

/// Of YCxCz.
Grid<float> flip_of(const Planes3& test, const Planes3& reference) {
    const Planes3 test_lab = seen_lab(test);
    const Planes3 reference_lab = seen_lab(reference);
    const Features in_test = features_of(test.x);
    const Features in_reference = features_of(reference.x);
    cv::Mat edge, point;
    cv::absdiff(in_test.edge, in_reference.edge, edge);
    cv::absdiff(in_test.point, in_reference.point, point);
    const cv::Mat feature = cv::max(edge, point);
    const float largest = largest_difference();
    Grid<float> map({feature.cols, feature.rows});
    for (int row = 0; row < feature.rows; ++row) {
        for (int column = 0; column < feature.cols; ++column) {
            const float colour =
                colour_error(test_lab.at(row, column), reference_lab.at(row, column), largest);
            const float change =
                std::pow(feature.at<float>(row, column) / std::sqrt(2.0f), kFeatureExponent);
            map(column, row) = std::pow(colour, 1 - change);
        }
    }
    return map;
}

/// YCxCz of what a function makes of every channel value.
template <class Shown>
Planes3 ycxcz_of(const Image& image, Shown shown) {
    Planes3 planes({image.size().width, image.size().height});
    for (int y = 0; y < image.size().height; ++y) {
        for (int x = 0; x < image.size().width; ++x) {
            const glm::vec3 linear = image(x, y);
            const glm::vec3 c = ycxcz_of_rgb({shown(linear.x), shown(linear.y), shown(linear.z)});
            planes.x.at<float>(y, x) = c.x;
            planes.y.at<float>(y, x) = c.y;
            planes.z.at<float>(y, x) = c.z;
        }
    }
    return planes;
}

/// The ACES filmic curve (Narkowicz), without its exposure of 0.6.
float aces(float x) {
    x = std::clamp(0.6f * x, 0.0f, 1e9f);  // beyond, squares would have no finite quotient
    return std::clamp(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), 0.0f, 1.0f);
}

}  // namespace

Grid<float> flip_map(const Image& test, const Image& reference) {
    const auto clipped = [](float x) { return std::clamp(x, 0.0f, 1.0f); };
    return flip_of(ycxcz_of(test, clipped), ycxcz_of(reference, clipped));
}

Grid<float> hdr_flip_map(const Image& test, const Image& reference,
                         const FlipExposures& exposures) {
    Grid<float> largest(test.size());
    const double step = (exposures.last_stop - exposures.first_stop) / (exposures.count - 1);
    for (int i = 0; i < exposures.count; ++i) {
        const auto scale = static_cast<float>(std::exp2(exposures.first_stop + i * step));
        const auto shown = [&](float x) { return aces(scale * x); };
        const Grid<float> map = flip_of(ycxcz_of(test, shown), ycxcz_of(reference, shown));
        std::ranges::transform(map.values(), largest.values(), largest.values().begin(),
                               [](float a, float b) { return std::max(a, b); });
    }
    return largest;
}

}  // namespace vecino
