// SPDX-License-Identifier: Apache-2.0
//
// Rebuilds frames of any planes with any scheme and any options: finite, of the size asked for,
// with counts that are true, and the same bits on any number of threads.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>

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
    require(result.dropped_samples == broken, name + ": dropped samples");
    const std::size_t area = input.low.size().area();
    require(result.fallback_pixels <= area && result.non_finite_pixels <= broken,
            name + ": more pixels counted than there are");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::SchemeInput input = fuzz::scheme_input(fuzz::Bytes({data, size}));
    const auto run = [&] { return reconstruct(input.low, *input.scheme, input.request); };
    Reconstruction result;
    if (!fuzz::gives_result([&] { result = run(); })) return 0;
    check(input, result);
    input.request.threads = 3;
    require(same(run(), result), std::string(input.scheme->name) + ": other bits on 3 threads");
    return 0;
}
