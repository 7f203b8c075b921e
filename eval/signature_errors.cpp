// SPDX-License-Identifier: Apache-2.0
//
// Signatures that compare pixel by pixel: errors, and one surface's colour on another.
#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>

#include "core/error.h"
#include "eval/signature_pixels.h"
#include "eval/signature_values.h"

namespace vecino {
namespace {

using Pixels = std::vector<glm::ivec2>;

glm::dvec3 at(const Image& image, glm::ivec2 p) {
    return glm::dvec3(image(p.x, p.y));
}

double largest(const glm::dvec3& v) {
    return std::max({v.x, v.y, v.z});
}

double sum(const glm::dvec3& v) {
    return v.x + v.y + v.z;
}

double contrast_of(const SignatureInput& input) {
    return input.parameters.contrast;
}

/// One value per image, from the pixels that the measure names.
SignatureValues by_image(const SignatureInput& input,
                         const std::function<double(const Image&, const Pixels&)>& value) {
    const Pixels pixels = pixels_of(input.parameters.where, input.reference);
    SignatureValues values;
    for (const Image& image : input.images) values.push_back(value(image, pixels));
    return values;
}

/// Share of the far colour that a pixel's error amounts to.
double share_of(const glm::dvec3& x, const glm::dvec3& r, const glm::dvec3& far) {
    const glm::dvec3 step = far - r;
    const double length2 = glm::dot(step, step);
    return length2 > 0 ? glm::dot(x - r, step) / length2 : 0;
}

}  // namespace

SignatureValues rms_error(const SignatureInput& input) {
    return by_image(input, [&](const Image& image, const Pixels& pixels) {
        double squares = 0;
        for (const glm::ivec2 p : pixels) {
            const glm::dvec3 e = at(image, p) - at(input.reference.radiance, p);
            squares += glm::dot(e, e);
        }
        return std::sqrt(squares / (3.0 * static_cast<double>(pixels.size()))) / contrast_of(input);
    });
}

SignatureValues mean_error(const SignatureInput& input) {
    return by_image(input, [&](const Image& image, const Pixels& pixels) {
        double error = 0, reference = 0;
        for (const glm::ivec2 p : pixels) {
            error += sum(at(image, p) - at(input.reference.radiance, p));
            reference += sum(at(input.reference.radiance, p));
        }
        return std::abs(error) / reference;
    });
}

SignatureValues lost_contrast(const SignatureInput& input) {
    return by_image(input, [&](const Image& image, const Pixels& pixels) {
        glm::dvec3 mean_x(0.0), mean_r(0.0);
        const auto count = static_cast<double>(pixels.size());
        for (const glm::ivec2 p : pixels) {
            mean_x += at(image, p) / count;
            mean_r += at(input.reference.radiance, p) / count;
        }
        double covariance = 0, variance = 0;
        for (const glm::ivec2 p : pixels) {
            const glm::dvec3 r = at(input.reference.radiance, p) - mean_r;
            covariance += glm::dot(at(image, p) - mean_x, r);
            variance += glm::dot(r, r);
        }
        return std::max(0.0, 1 - covariance / variance);
    });
}

SignatureValues deviation(const SignatureInput& input) {
    const glm::dvec3 expected(input.parameters.expected);
    const double scale = largest(expected) > 0 ? largest(expected) : 1;
    return by_image(input, [&](const Image& image, const Pixels& pixels) {
        double worst = 0;
        for (const glm::ivec2 p : pixels) {
            const double error = largest(glm::abs(at(image, p) - expected)) / scale;
            if (!std::isnan(worst) && !(error <= worst)) worst = error;  // NaN stays
        }
        return worst;
    });
}

SignatureValues differs_from_path(const SignatureInput& input) {
    if (input.path.size() != input.images.size())
        throw Error(ExitCode::usage,
                    "signature: found no image of path tracing of every seed, allowed: all");
    const Pixels pixels = pixels_of(input.parameters.where, input.reference);
    SignatureValues values;
    for (std::size_t i = 0; i < input.images.size(); ++i) {
        double worst = 0, mean = 0;
        for (const glm::ivec2 p : pixels) {
            const glm::dvec3 path = at(input.path[i], p);
            worst = std::max(worst, largest(glm::abs(at(input.images[i], p) - path)));
            mean += sum(path) / (3.0 * static_cast<double>(pixels.size()));
        }
        values.push_back(worst / mean);
    }
    return values;
}

SignatureValues far_share(const SignatureInput& input) {
    const glm::dvec3 far = mean_radiance(input.parameters.far, input.reference);
    return by_image(input, [&](const Image& image, const Pixels& pixels) {
        double shares = 0;
        for (const glm::ivec2 p : pixels)
            shares += share_of(at(image, p), at(input.reference.radiance, p), far);
        return std::max(0.0, shares / static_cast<double>(pixels.size()));
    });
}

SignatureValues swap_width(const SignatureInput& input) {
    const glm::dvec3 far = mean_radiance(input.parameters.far, input.reference);
    const auto outline = outline_px(input.parameters.objects, input.reference);
    return by_image(input, [&](const Image& image, const Pixels& pixels) {
        const auto swapped = std::ranges::count_if(pixels, [&](glm::ivec2 p) {
            return share_of(at(image, p), at(input.reference.radiance, p), far) > 0.5;
        });
        return static_cast<double>(swapped) / static_cast<double>(outline);
    });
}

SignatureValues halo_width(const SignatureInput& input) {
    const auto outline = outline_px(input.parameters.objects, input.reference);
    const double limit = input.parameters.threshold * contrast_of(input);
    return by_image(input, [&](const Image& image, const Pixels& pixels) {
        const auto wrong = std::ranges::count_if(pixels, [&](glm::ivec2 p) {
            const glm::dvec3 e = at(image, p) - at(input.reference.radiance, p);
            return !(largest(glm::abs(e)) <= limit);
        });
        return static_cast<double>(wrong) / static_cast<double>(outline);
    });
}

SignatureValues leaked_energy(const SignatureInput& input) {
    double source = 0;
    Where on_source;
    on_source.on = input.parameters.objects;
    for (const glm::ivec2 p : pixels_of(on_source, input.reference))
        source += sum(at(input.reference.radiance, p));
    return by_image(input, [&](const Image& image, const Pixels& pixels) {
        double leaked = 0;
        for (const glm::ivec2 p : pixels) {
            const glm::dvec3 e = at(image, p) - at(input.reference.radiance, p);
            leaked += sum(glm::max(e, glm::dvec3(0.0)));
        }
        return leaked / source;
    });
}

}  // namespace vecino
