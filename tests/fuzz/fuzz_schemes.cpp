// SPDX-License-Identifier: Apache-2.0
//
// Rebuilds frames of any planes with any scheme and any options: finite, of the size asked for,
// with counts that are true, and the same bits on any number of threads.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

#include "filters/guide.h"
#include "tests/fuzz/contract.h"
#include "tests/fuzz/scheme_input.h"

using namespace vecino;
using fuzz::require;

namespace {

bool same(const Reconstruction& a, const Reconstruction& b) {
    return a.image.size() == b.image.size() &&
           std::memcmp(a.image.values().data(), b.image.values().data(),
                       a.image.size().area() * sizeof(glm::vec3)) == 0 &&
           a.fallback_pixels == b.fallback_pixels && a.dropped_samples == b.dropped_samples &&
           a.non_finite_pixels == b.non_finite_pixels;
}

void check(const fuzz::SchemeInput& input, const Reconstruction& result) {
    const std::string name(input.scheme->name);
    require(result.image.size() == input.request.size, name + ": another size");
    require(std::ranges::all_of(result.image.values(), is_finite), name + ": not finite");
    const auto broken = static_cast<std::size_t>(std::ranges::count_if(
        input.low.radiance.values(), [](const glm::vec3& color) { return !is_finite(color); }));
    const bool is_guided = input.scheme->uses_guide();  // counts are then of the result
    const std::size_t area = is_guided ? input.request.size.area() : input.low.size().area();
    // Schemes with a guide drop those whose emission is broken, too.
    const std::size_t dropped = result.dropped_samples;
    require(is_guided ? dropped >= broken && dropped <= input.low.size().area() : dropped == broken,
            name + ": dropped samples");
    require(result.fallback_pixels <= area, name + ": more fallbacks than pixels");
    require(result.non_finite_pixels <= (is_guided ? area : broken),
            name + ": more pixels that are not finite than there are");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::SchemeInput input = fuzz::scheme_input(fuzz::Bytes({data, size}));
    const auto run = [&] { return reconstruct(input.low, *input.scheme, input.request); };
    if (input.scheme->uses_guide()) {
        input.request.guide = &input.guide;
        if (!fuzz::gives_result([&] { (void)check_guide(input.guide, "guide.exr"); })) return 0;
    }
    Reconstruction result;
    if (!fuzz::gives_result([&] { result = run(); })) return 0;
    check(input, result);
    input.request.threads = 3;
    require(same(run(), result), std::string(input.scheme->name) + ": other bits on 3 threads");
    return 0;
}
