// SPDX-License-Identifier: Apache-2.0
//
// Mistakes in upsampling and comparing: flags, and images that do not fit.
#include <limits>

#include "core/image_io.h"
#include "tests/bad_input.h"
#include "tests/catch.h"
#include "tests/foreign_image.h"
#include "tests/test_images.h"

using namespace vecino;
using namespace vecino::test;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A file of 8x8 pixels that hold the same value in every channel.
void write_exr(const TempDir& dir, const std::string& name,
               const std::vector<std::string>& channels, float value) {
    const auto spec = make_spec({8, 8}, channels, OIIO::TypeDesc::FLOAT);
    write_foreign(dir.path(name), spec, std::vector<float>(64 * channels.size(), value));
}

void write_images(const TempDir& dir) {
    save_image(make_image({8, 8}), dir.path("rgb.exr"));
    save_image(make_image({8, 9}), dir.path("tall.exr"));
    save_image(make_image({8, 8}), dir.path("rgb.png"));
    write_exr(dir, "nan.exr", {"R", "G", "B"}, kNaN);
    write_exr(dir, "depth.exr", {"Z"}, 1.0f);
    write_exr(dir, "no_blue.exr", {"R", "G", "Z"}, 1.0f);
    write_exr(dir, "half_position.exr", {"R", "G", "B", "P.X"}, 1.0f);
    write_exr(dir, "position.exr", {"R", "G", "B", "P.X", "P.Y", "P.Z"}, 1.0f);
    write_exr(dir, "nan_id.exr", {"R", "G", "B", "Id"}, kNaN);
    dir.write("empty.exr", "");
    dir.write("text.exr", "This is a letter to my landlord, and not an image.\n");
    dir.write("text.png", "Nor is this.\n");
    dir.write("cut.exr", dir.read("rgb.exr").substr(0, dir.read("rgb.exr").size() * 2 / 3));
    dir.write("cut.png", dir.read("rgb.png").substr(0, dir.read("rgb.png").size() * 2 / 3));
    dir.write("old.exr", "an older result");
    std::filesystem::create_directory(dir.path("folder.exr"));
    std::filesystem::create_directory(dir.path("folder.png"));
}

}  // namespace

// clang-format off
TEST_CASE("mistakes of upsample", "[bad_input]") {
    const TempDir dir;
    write_images(dir);
    const std::string to = " -o old.exr --size 16x16 --scheme ";
    const Mistake mistakes[] = {
        {"no scheme", "upsample rgb.exr -o old.exr --size 16x16", 64, "--scheme is required"},
        {"no size", "upsample rgb.exr -o old.exr --scheme mean", 64, "--size is required"},
        {"no output", "upsample rgb.exr --size 16x16 --scheme mean", 64, "-o is required"},
        {"no input", "upsample", 64, "required"},
        {"an unknown scheme", "upsample rgb.exr" + to + "bicubic", 64, "scheme: found \"bicubic\", allowed: nearest, mean, "},
        {"an unknown flag", "upsample rgb.exr" + to + "mean --guides rgb.exr", 64, "--guides"},
        {"a flag of render", "upsample rgb.exr" + to + "mean --spp 4", 64, "--spp"},
        {"a doubled flag", "upsample rgb.exr" + to + "mean --window 3 --window 5", 64, "--window"},
        {"two inputs", "upsample rgb.exr tall.exr" + to + "mean", 64, "tall.exr"},
        {"an unknown extension", "upsample rgb.exr -o out.jpg --size 16x16 --scheme mean", 64, "out.jpg: found extension .jpg, allowed: .exr"},
        {"no extension", "upsample rgb.exr -o out --size 16x16 --scheme mean", 64, "out: found no extension, allowed: .exr"},
        {"an empty output", "upsample rgb.exr -o \"\" --size 16x16 --scheme mean", 64, "found no extension"},
        {"an empty size", "upsample rgb.exr -o old.exr --size \"\" --scheme mean", 64, "--size"},
        {"a size of zero", "upsample rgb.exr -o old.exr --size 0x16 --scheme mean", 64, "--size/0: found 0, allowed: an integer from 1 to 65536"},
        {"too many pixels", "upsample rgb.exr -o old.exr --size 65536x65536 --scheme mean", 64, "--size: found [65536,65536], allowed: at most 2147483647 pixels"},
        {"a smaller size", "upsample rgb.exr -o old.exr --size 4x4 --scheme mean", 3, "size: found 4x4, allowed: at least the low-resolution 8x8"},
        {"a lower size", "upsample rgb.exr -o old.exr --size 16x7 --scheme nearest", 3, "size: found 16x7, allowed: at least the low-resolution 8x8"},

        {"an even window", "upsample rgb.exr" + to + "mean --window 4", 64, "--window: found 4, allowed: an odd integer from 1 to 9999"},
        {"a window of zero", "upsample rgb.exr" + to + "mean --window 0", 64, "--window: found 0, allowed: an integer from 1 to 9999"},
        {"a negative window", "upsample rgb.exr" + to + "mean --window -3", 64, "--window: found -3"},
        {"half a pixel of window", "upsample rgb.exr" + to + "mean --window 3.5", 64, "--window: found 3.5"},
        {"a huge window", "upsample rgb.exr" + to + "mean --window 99999999999", 64, "--window: found 99999999999"},
        {"a window in words", "upsample rgb.exr" + to + "mean --window wide", 64, "--window: found \"wide\""},
        {"an empty window", "upsample rgb.exr" + to + "mean --window \"\"", 64, "--window"},
        {"a NaN cosine", "upsample rgb.exr" + to + "mean --min-normal-cosine nan", 64, "--min-normal-cosine: found \"nan\", allowed: a number from -1 to 1"},
        {"an infinite cosine", "upsample rgb.exr" + to + "mean --min-normal-cosine -inf", 64, "--min-normal-cosine: found \"-inf\", allowed: a number from -1 to 1"},
        {"a cosine beyond 1", "upsample rgb.exr" + to + "mean --min-normal-cosine 1.5", 64, "--min-normal-cosine: found 1.5, allowed: a number from -1 to 1"},
        {"a cosine beyond all range", "upsample rgb.exr" + to + "mean --min-normal-cosine 1e999", 64, "--min-normal-cosine: found \"1e999\""},
        {"an unknown weighting", "upsample rgb.exr" + to + "distance2d --weighting box", 64, "--weighting: found \"box\", allowed: proportional, inverse, gaussian"},
        {"an unknown metric", "upsample rgb.exr" + to + "distance2d --metric maximum", 64, "--metric: found \"maximum\", allowed: euclidean, manhattan"},
        {"no threads", "upsample rgb.exr" + to + "mean --threads 0", 64, "--threads"},

        {"no such image", "upsample missing.exr" + to + "mean", 4, "missing.exr: cannot be read: No such file"},
        {"a folder as image", "upsample folder.exr" + to + "mean", 4, "folder.exr: cannot be read: it is a directory"},
        {"nothing as image", "upsample empty.exr" + to + "mean", 4, "empty.exr: cannot be read: "},
        {"text as EXR", "upsample text.exr" + to + "mean", 4, "text.exr: cannot be read: "},
        {"text as PNG", "upsample text.png" + to + "mean", 4, "text.png: cannot be read: "},
        {"half an EXR", "upsample cut.exr" + to + "mean", 4, "cut.exr: cannot be read: "},
        {"half a PNG", "upsample cut.png" + to + "mean", 4, "cut.png: cannot be read: "},
        {"an EXR without colour", "upsample depth.exr" + to + "mean", 3, "depth.exr: found channels Z, allowed: R, G, B or Y among them"},
        {"an EXR without blue", "upsample no_blue.exr" + to + "mean", 3, "no_blue.exr: found channels R, G, Z"},
        {"a third of a plane", "upsample half_position.exr" + to + "mean", 3, "half_position.exr: found only channels P.X, allowed: P.X, P.Y, P.Z"},
        {"a NaN identity", "upsample nan_id.exr" + to + "mean", 5, "nan_id.exr: found nan at pixel (0, 0), channel Id, allowed: 32-bit integers"},
        {"no positions", "upsample rgb.exr" + to + "distance3d", 3, "rgb.exr: scheme \"distance3d\" needs planes that are not there: position"},
        {"no normals", "upsample position.exr" + to + "distance3d_normal", 3, "position.exr: scheme \"distance3d_normal\" needs planes that are not there: normal"},
        {"no planes, and a flag in vain", "upsample rgb.exr" + to + "distance3d --metric manhattan", 3, "needs planes that are not there: position"},
        {"a folder as output", "upsample rgb.exr -o folder.exr --size 16x16 --scheme mean", 4, "folder.exr: cannot be written: it is a directory"},
        {"no folder for the output", "upsample rgb.exr -o none/out.png --size 16x16 --scheme mean", 4, "none/out.png: cannot be written: none: No such file or directory"},
        {"a file as folder", "upsample rgb.exr -o text.png/out.png --size 16x16 --scheme mean", 4, "text.png/out.png: cannot be written: text.png: Not a directory"},
    };
    check_mistakes(dir, mistakes);
}

TEST_CASE("mistakes of compare", "[bad_input]") {
    const TempDir dir;
    write_images(dir);
    const Mistake mistakes[] = {
        {"one image", "compare rgb.exr", 64, "REFERENCE is required"},
        {"three images", "compare rgb.exr rgb.exr rgb.exr", 64, "rgb.exr"},
        {"an unknown flag", "compare rgb.exr rgb.exr --max-psnr 30", 64, "--max-psnr"},
        {"a limit in words", "compare rgb.exr rgb.exr --min-psnr high", 64, "--min-psnr"},
        {"a limit that is no number", "compare rgb.exr rgb.exr --min-psnr nan", 64, "--min-psnr: found \"nan\", allowed: a finite number"},
        {"a limit without end", "compare rgb.exr rgb.exr --max-relmse inf", 64, "--max-relmse: found \"inf\", allowed: a finite number"},
        {"an empty limit", "compare rgb.exr rgb.exr --min-ssim \"\"", 64, "--min-ssim: found \"\", allowed: a finite number"},
        {"an empty map", "compare rgb.exr rgb.exr --error-map \"\"", 64, "--error-map: found nothing"},
        {"a doubled limit", "compare rgb.exr rgb.exr --min-ssim 0.1 --min-ssim 0.9", 64, "--min-ssim"},
        {"an unknown kind", "compare rgb.exr rgb.exr --error-kind colour", 64, "--error-kind"},
        {"an unknown extension", "compare rgb.exr rgb.exr --error-map out.vtk", 64, "--error-map: found \"out.vtk\", allowed: "},
        {"different sizes", "compare rgb.exr tall.exr", 3, "rgb.exr is 8x8, tall.exr is 8x9"},
        {"no colour", "compare depth.exr rgb.exr", 3, "depth.exr: found channels Z"},
        {"no such image", "compare missing.exr rgb.exr", 4, "missing.exr: cannot be read: "},
        {"no such reference", "compare rgb.exr missing.exr", 4, "missing.exr: cannot be read: "},
        {"half a reference", "compare rgb.exr cut.exr", 4, "cut.exr: cannot be read: "},
        {"no folder for the map", "compare rgb.exr rgb.exr --error-map none/out.png", 4, "none/out.png: cannot be written: "},
        {"a folder as map", "compare rgb.exr rgb.exr --error-map folder.png", 4, "folder.png: cannot be written: it is a directory"},
    };
    check_mistakes(dir, mistakes);
}

TEST_CASE("of two mistakes the code that comes first in 64, 4, 3, 5, 2 is told", "[bad_input]") {
    const TempDir dir;
    write_images(dir);
    const Mistake mistakes[] = {
        {"usage before a missing file", "upsample missing.exr -o out.gif --size 16x16 --scheme mean", 64, "out.gif"},
        {"usage before a missing file", "upsample missing.exr -o out.exr --size 0x0 --scheme mean", 64, "--size/0"},
        {"usage before a missing file", "compare missing.exr missing.exr --error-map out.vtk", 64, "out.vtk"},
        {"usage before a missing plane", "upsample rgb.exr -o out.exr --size 16x16 --scheme distance3d --window 2", 64, "--window"},
        {"usage before NaN", "upsample nan.exr -o out.exr --size 16x16 --scheme mean --window 2", 64, "--window"},
        {"an output that cannot be before a missing plane", "upsample rgb.exr -o none/out.exr --size 16x16 --scheme distance3d", 4, "none/out.exr"},
        {"an output that cannot be before a smaller size", "upsample rgb.exr -o none/out.exr --size 4x4 --scheme mean", 4, "none/out.exr"},
        {"an output that cannot be before NaN", "upsample nan.exr -o none/out.exr --size 16x16 --scheme mean", 4, "none/out.exr"},
        {"a missing file before no colour", "upsample depth.exr -o none/out.exr --size 16x16 --scheme mean", 4, "none/out.exr"},
        {"a missing file before no colour", "compare depth.exr missing.exr", 4, "missing.exr"},
        {"an unwritable map before different sizes", "compare rgb.exr tall.exr --error-map none/x.png", 4, "none/x.png"},
        {"a broken file before NaN", "compare nan.exr cut.exr", 4, "cut.exr"},
        {"a smaller size before NaN", "upsample nan.exr -o out.exr --size 4x4 --scheme mean", 3, "4x4"},
        {"NaN before a limit", "compare nan.exr rgb.exr --min-psnr 99", 5, "nan.exr: 192 values are not finite"},
        {"different sizes before NaN", "compare nan.exr tall.exr", 3, "nan.exr is 8x8, tall.exr is 8x9"},
    };
    check_mistakes(dir, mistakes);
}
// clang-format on
