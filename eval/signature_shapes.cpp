// SPDX-License-Identifier: Apache-2.0
//
// Signatures of shapes: edges, places, steps between neighbours, spots, and what seeds and counts
// tell.
#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <numbers>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "eval/signature_pixels.h"
#include "eval/signature_values.h"

namespace vecino {
namespace {

using Json = nlohmann::json;

glm::dvec3 at(const Image& image, glm::ivec2 p) {
    return glm::dvec3(image(p.x, p.y));
}

double largest(const glm::dvec3& v) {
    return std::max({v.x, v.y, v.z});
}

double brightness(const glm::dvec3& v) {
    return (v.x + v.y + v.z) / 3;
}

// ---- Edges ----------------------------------------------------------------------------------

/// Mean radiance of the pixels by their place along an axis.
std::vector<glm::dvec3> profile(const Image& image, const std::vector<glm::ivec2>& pixels,
                                Axis axis) {
    std::vector<glm::dvec3> sums(
        static_cast<std::size_t>(axis == Axis::x ? image.size().width : image.size().height));
    std::vector<double> counts(sums.size());
    for (const glm::ivec2 p : pixels) {
        const auto i = static_cast<std::size_t>(axis == Axis::x ? p.x : p.y);
        sums[i] += at(image, p);
        ++counts[i];
    }
    std::vector<glm::dvec3> means;
    for (std::size_t i = 0; i < sums.size(); ++i)
        if (counts[i] > 0) means.push_back(sums[i] / counts[i]);
    return means;
}

/// 6 x sum of p(1-p) is the width of a straight ramp; p runs from the one end to the other.
double ramp_width(const std::vector<glm::dvec3>& profile, const glm::dvec3& begin,
                  const glm::dvec3& end) {
    const glm::dvec3 step = end - begin;
    double sum = 0;
    for (const glm::dvec3& value : profile) {
        const double p = std::clamp(glm::dot(value - begin, step) / glm::dot(step, step), 0.0, 1.0);
        sum += p * (1 - p);
    }
    return 6 * sum;
}

// ---- Places ---------------------------------------------------------------------------------

/// Of how much each pixel differs from the colour far around.
glm::dvec2 centroid(const Image& image, const std::vector<glm::ivec2>& pixels,
                    const glm::dvec3& around) {
    glm::dvec2 place(0.0);
    double total = 0;
    for (const glm::ivec2 p : pixels) {
        const double weight = glm::length(at(image, p) - around);
        place += weight * (glm::dvec2(p) + 0.5);
        total += weight;
    }
    return place / total;
}

std::vector<glm::ivec2> around_object(int object, std::array<float, 2> within_px,
                                      const Frame& reference) {
    Where where;
    where.near = {object};
    where.within_px = within_px;
    return pixels_of(where, reference);
}

// ---- Steps ----------------------------------------------------------------------------------

/// The squared step from one pixel to its neighbour that the reference does not have.
double step2(const Image& image, const Frame& reference, const PixelPair& pair) {
    const auto error = [&](glm::ivec2 p) { return at(image, p) - at(reference.radiance, p); };
    const glm::dvec3 step = error(pair.first) - error(pair.second);
    return glm::dot(step, step) / 3;
}

struct MeanOfSquares {
    double sum = 0;
    double count = 0;
    void add(double square) {
        sum += square;
        ++count;
    }
    [[nodiscard]] double rms() const { return std::sqrt(sum / count); }
};

int id_at(const Frame& frame, glm::ivec2 p) {
    return frame.object_id(p.x, p.y);
}

[[noreturn]] void fail_without(const std::string& what) {
    throw Error(ExitCode::usage, "signature: found no " + what + ", allowed: at least one");
}

// ---- Counts ---------------------------------------------------------------------------------

double count_of(const Json& row, const char* key) {
    const Json value = row.value("counts", Json::object()).value(key, Json());
    return value.is_number() ? value.get<double>() : 0;
}

/// Pixels of the image per pixel of the frame that it was rebuilt from.
double block_px(const Json& row, Extent size) {
    const int reduction = row.value("params", Json::object()).value("reduction", 1);
    return static_cast<double>(size.area()) / static_cast<double>(reduced(size, reduction).area());
}

double injected_samples(const Json& row) {
    const Json list = row.value("params", Json::object()).value("inject", Json::array());
    return static_cast<double>(list.size());
}

}  // namespace

SignatureValues edge_widening(const SignatureInput& input) {
    const auto pixels = pixels_of(input.parameters.where, input.reference);
    const Axis axis = input.parameters.across;
    const auto exact = profile(input.reference.radiance, pixels, axis);
    const glm::dvec3 begin = exact.front(), end = exact.back();
    if (begin == end) fail_without("edge within \"where\"");
    const double width = ramp_width(exact, begin, end);
    SignatureValues values;
    for (const Image& image : input.images)
        values.push_back(
            std::max(0.0, ramp_width(profile(image, pixels, axis), begin, end) - width));
    return values;
}

SignatureValues centroid_shift(const SignatureInput& input) {
    const auto reach = static_cast<float>(input.parameters.reach_px);
    SignatureValues worst(input.images.size());
    for (const int object : input.parameters.objects) {
        const auto pixels = around_object(object, {0, reach}, input.reference);
        const auto beyond = around_object(object, {reach, reach + 1}, input.reference);
        glm::dvec3 around(0.0);
        for (const glm::ivec2 p : beyond)
            around += at(input.reference.radiance, p) / static_cast<double>(beyond.size());
        const glm::dvec2 exact = centroid(input.reference.radiance, pixels, around);
        for (std::size_t i = 0; i < worst.size(); ++i) {
            const glm::dvec2 shift = glm::abs(centroid(input.images[i], pixels, around) - exact);
            const double most = std::max(shift.x, shift.y);
            if (!(most <= worst[i])) worst[i] = most;
        }
    }
    return worst;
}

SignatureValues seam_step(const SignatureInput& input) {
    const auto pixels = pixels_of(input.parameters.where, input.reference);
    auto pairs = neighbours(pixels, input.reference.radiance.size());
    std::erase_if(pairs, [&](const PixelPair& pair) {
        return id_at(input.reference, pair.first) == id_at(input.reference, pair.second);
    });
    if (pairs.empty()) fail_without("neighbours of different objects");
    SignatureValues values;
    for (const Image& image : input.images) {
        MeanOfSquares steps;
        for (const PixelPair& pair : pairs) steps.add(step2(image, input.reference, pair));
        values.push_back(steps.rms() / input.parameters.contrast);
    }
    return values;
}

SignatureValues facet_step(const SignatureInput& input) {
    const Frame& reference = input.reference;
    const double cosine = std::cos(input.parameters.min_angle_degrees * std::numbers::pi / 180.0);
    const auto pairs =
        neighbours(pixels_of(input.parameters.where, reference), reference.radiance.size());
    const auto is_crease = [&](const PixelPair& pair) {
        const auto normal = [&](glm::ivec2 p) { return reference.normal_world(p.x, p.y); };
        return double{glm::dot(normal(pair.first), normal(pair.second))} < cosine;
    };
    SignatureValues values;
    for (const Image& image : input.images) {
        MeanOfSquares creases, flats;
        for (const PixelPair& pair : pairs)
            (is_crease(pair) ? creases : flats).add(step2(image, reference, pair));
        if (creases.count == 0 || flats.count == 0) fail_without("creases, or none between them");
        values.push_back(std::max(0.0, creases.rms() - flats.rms()) / input.parameters.contrast);
    }
    return values;
}

SignatureValues outlier_area(const SignatureInput& input) {
    const double limit = input.parameters.threshold * input.parameters.contrast;
    SignatureValues values;
    for (const Image& image : input.images) {
        const Extent size = image.size();
        cv::Mat mask = cv::Mat::zeros(size.height, size.width, CV_8U);
        for (int y = 0; y < size.height; ++y) {
            for (int x = 0; x < size.width; ++x) {
                const glm::dvec3 e = at(image, {x, y}) - at(input.reference.radiance, {x, y});
                if (!(largest(e) <= limit)) mask.at<std::uint8_t>(y, x) = 255;
            }
        }
        cv::Mat labels;
        const int spots = cv::connectedComponents(mask, labels, 8) - 1;
        values.push_back(spots == 0 ? 0 : static_cast<double>(cv::countNonZero(mask)) / spots);
    }
    return values;
}

SignatureValues seed_flips(const SignatureInput& input) {
    const auto pixels = pixels_of(input.parameters.where, input.reference);
    const double limit = input.parameters.threshold * input.parameters.contrast;
    std::size_t flips = 0;
    for (const glm::ivec2 p : pixels) {
        glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
        for (const Image& image : input.images) {
            low = glm::min(low, at(image, p));
            high = glm::max(high, at(image, p));
        }
        flips += largest(high - low) > limit ? 1 : 0;
    }
    const double share = static_cast<double>(flips) / static_cast<double>(pixels.size());
    return SignatureValues(input.images.size(), share);
}

SignatureValues seed_noise(const SignatureInput& input) {
    if (input.images.size() < 2)
        throw Error(ExitCode::usage, "signature: found one seed, allowed: at least two");
    const auto pixels = pixels_of(input.parameters.where, input.reference);
    const auto seeds = static_cast<double>(input.images.size());
    double reference = 0;
    std::vector<double> squares(input.images.size());
    for (const glm::ivec2 p : pixels) {
        reference += brightness(at(input.reference.radiance, p));
        glm::dvec3 mean(0.0);
        for (const Image& image : input.images) mean += at(image, p) / seeds;
        for (std::size_t i = 0; i < squares.size(); ++i) {
            const glm::dvec3 e = at(input.images[i], p) - mean;
            squares[i] += glm::dot(e, e) / 3;
        }
    }
    const auto count = static_cast<double>(pixels.size());
    SignatureValues values;
    for (const double sum : squares)
        values.push_back(std::sqrt(sum / count * seeds / (seeds - 1)) / (reference / count));
    return values;
}

SignatureValues damaged_blocks(const SignatureInput& input) {
    const double limit = input.parameters.threshold * input.parameters.contrast;
    SignatureValues values;
    for (std::size_t i = 0; i < input.images.size(); ++i) {
        const Json& row = input.rows[i];
        const double injected = injected_samples(row);
        if (injected == 0) fail_without("injected sample");
        std::size_t damaged = 0;
        for (const glm::ivec2 p : pixels_of({}, input.reference)) {
            const glm::dvec3 e = at(input.images[i], p) - at(input.reference.radiance, p);
            damaged += largest(glm::abs(e)) <= limit ? 0 : 1;
        }
        const bool is_told = count_of(row, "dropped_samples") >= injected;
        values.push_back(is_told ? static_cast<double>(damaged) /
                                       block_px(row, input.images[i].size()) / injected
                                 : std::numeric_limits<double>::infinity());
    }
    return values;
}

SignatureValues fallbacks(const SignatureInput& input) {
    SignatureValues values;
    for (std::size_t i = 0; i < input.images.size(); ++i) {
        const Extent size = input.images[i].size();
        const double blocks = static_cast<double>(size.area()) / block_px(input.rows[i], size);
        values.push_back(count_of(input.rows[i], "fallback_pixels") / blocks);
    }
    return values;
}

}  // namespace vecino
