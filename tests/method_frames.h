// SPDX-License-Identifier: Apache-2.0
//
// Requests to render methods, and what their tests look at.
#pragma once

#include <string>

#include "filters/methods.h"
#include "tests/catch.h"
#include "tests/scene_text.h"

namespace vecino::test {

inline MethodRequest request_of(const Scene& scene, Extent size, int spp) {
    MethodRequest request{scene, {}, {}};
    request.settings.size = size;
    request.settings.spp = spp;
    return request;
}

inline MethodRender render_by(const char* method, const MethodRequest& request) {
    return render(find_method(method), request);
}

/// Every pixel that was sampled has the radiance that path tracing gives it. Returns how many.
inline std::size_t require_paths_kept(const Frame& frame, const MethodRequest& request) {
    const Frame path = render(request.scene, request.settings).frame;
    std::size_t traced = 0;
    for (std::size_t i = 0; i < frame.radiance.values().size(); ++i) {
        if (frame.sample_count.values()[i] == 0) continue;
        ++traced;
        REQUIRE(frame.radiance.values()[i] == path.radiance.values()[i]);
        REQUIRE(frame.direct.values()[i] == path.direct.values()[i]);
    }
    return traced;
}

/// Mean squared error of radiance.
inline double error_against(const Image& image, const Image& reference) {
    double sum = 0;
    for (std::size_t i = 0; i < image.values().size(); ++i) {
        const glm::dvec3 d = glm::dvec3(image.values()[i]) - glm::dvec3(reference.values()[i]);
        sum += d.x * d.x + d.y * d.y + d.z * d.z;
    }
    return sum / static_cast<double>(image.values().size());
}

}  // namespace vecino::test
