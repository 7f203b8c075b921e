// SPDX-License-Identifier: Apache-2.0
#include "core/image_io.h"
#include "eval/image_series.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/temp_dir.h"

using namespace vecino;

namespace {

Image constant(float value, Extent size = {16, 12}) {
    return Image(size, glm::vec3(value));
}

}  // namespace

TEST_CASE("valid images are numbered up to the first gap", "[image_series]") {
    const TempDir dir;
    for (const char* name : {"a.exr", "a_1.exr", "a_2.exr", "a_4.exr"}) dir.write(name, "");
    CHECK(valid_images(dir.path("a.exr")) ==
          std::vector{dir.path("a.exr"), dir.path("a_1.exr"), dir.path("a_2.exr")});
    CHECK(valid_images(dir.path("b.exr")).empty());
}

TEST_CASE("the closest valid image of the same size counts", "[image_series]") {
    const TempDir dir;
    save_image(constant(0.50f), dir.path("test.exr"));
    save_image(constant(0.30f), dir.path("v.exr"));
    save_image(constant(0.49f), dir.path("v_1.exr"));
    save_image(constant(0.50f, {8, 8}), dir.path("v_2.exr"));
    save_image(constant(0.60f), dir.path("v_3.exr"));
    CHECK(best_valid_image(dir.path("test.exr"), dir.path("v.exr")) == dir.path("v_1.exr"));
    save_image(constant(0.50f), dir.path("v_4.exr"));
    CHECK(best_valid_image(dir.path("test.exr"), dir.path("v.exr")) == dir.path("v_4.exr"));
    const Error error =
        error_of([&] { best_valid_image(dir.path("test.exr"), dir.path("w.exr")); });
    CHECK(error.code() == ExitCode::quality);
    CHECK(std::string(error.what()).find("copy it there") != std::string::npos);
}

TEST_CASE("a comparison is three pictures and their tags", "[image_series]") {
    const TempDir dir;
    const std::string tags = write_comparison(constant(0.5f), constant(0.4f), dir.path("out"));
    for (const char* name : {"test.png", "valid.png", "difference.png"}) {
        CHECK(load_image(dir.path(std::string("out/") + name)).size().width >= 16);
        CHECK(tags.find(dir.path(std::string("out/") + name)) != std::string::npos);
    }
    for (const char* tag : {"TestImage", "ValidImage", "DifferenceImage2"})
        CHECK(tags.find("name=\"" + std::string(tag) + "\"") != std::string::npos);
}
