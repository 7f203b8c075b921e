// SPDX-License-Identifier: Apache-2.0
//
// Reads any bytes as the planes of an EXR file, as an image, and as a part of a render; what is
// accepted can be rebuilt by every scheme that has its planes.
#include <cmath>
#include <cstdint>
#include <string>
#include <variant>

#include "core/channel_file.h"
#include "core/image_io.h"
#include "core/part_file.h"
#include "core/planes.h"
#include "filters/schemes.h"
#include "tests/fuzz/contract.h"
#include "tests/temp_dir.h"

using namespace vecino;
using fuzz::gives_result;
using fuzz::require;

namespace {

void check(const Frame& frame) {
    require(frame.size().area() > 0, "a frame without pixels");
    for (const PlaneInfo& plane : all_planes()) {
        const Extent size = std::visit([&](auto m) { return (frame.*m).size(); }, plane.member);
        require(size.area() == 0 || size == frame.size(),
                "size of plane " + std::string(plane.name));
    }
}

void check_schemes(const Frame& frame) {
    const Extent size{frame.size().width + 1, 2 * frame.size().height};
    for (const Scheme& scheme : all_schemes()) {
        Reconstruction result;
        if (!gives_result([&] { result = reconstruct(frame, scheme, {size, {}, 1}); })) continue;
        for (const glm::vec3& color : result.image.values())
            require(is_finite(color), "a value that is not finite, of " + std::string(scheme.name));
    }
}

/// A header may say any size: what would fill the memory of the fuzzer is not for it.
bool is_small(const std::string& path) {
    constexpr std::size_t kMostPixels = 1 << 14;
    Extent size;
    return gives_result([&] { size = load_header(path).size; }) && size.area() <= kMostPixels;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const TempDir dir;
    static const std::string path =
        dir.path("a.exr");  // in memory, where the directory for temporary files is
    dir.write("a.exr", {reinterpret_cast<const char*>(data), size});
    if (!is_small(path)) return 0;
    Frame frame;
    if (gives_result([&] { frame = load_frame(path); })) {
        check(frame);
        constexpr std::size_t kMostPixels = 4096;
        if (frame.size().area() <= kMostPixels) check_schemes(frame);
    }
    gives_result([&] { (void)load_image(path, {"B", "Z", "N.X"}); });
    gives_result([&] { (void)load_part(load_part_header(path)); });
    return 0;
}
