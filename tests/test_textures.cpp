// SPDX-License-Identifier: Apache-2.0
//
// Albedo from images: where its texels lie on surfaces, what lies between them, and what is
// refused.
#include <cmath>
#include <glm/geometric.hpp>
#include <nlohmann/json.hpp>

#include "core/color.h"
#include "core/image_io.h"
#include "eval/cell_sources.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/scene_text.h"
#include "tests/temp_dir.h"

using namespace vecino;
using namespace vecino::test;

namespace {

/// 3x2 texels, no two alike; of the top row, the first is red.
const Grid<glm::u8vec3>& picture() {
    static const Grid<glm::u8vec3> picture = [] {
        Grid<glm::u8vec3> p({3, 2});
        p.values() = {{255, 0, 0}, {0, 255, 0},     {128, 128, 128},
                      {0, 0, 255}, {255, 255, 255}, {64, 32, 16}};
        return p;
    }();
    return picture;
}

glm::dvec3 decoded(glm::u8vec3 texel) {
    const auto decode = [](int value) {
        return static_cast<double>(srgb_decode(static_cast<float>(value) / 255.0f));
    };
    return {decode(texel.r), decode(texel.g), decode(texel.b)};
}

/// The value at uv by the textbook: a mean of the four texels around it, weighted by nearness.
glm::dvec3 expected(const Grid<glm::u8vec3>& texels, glm::dvec2 uv) {
    const auto [width, height] = texels.size();
    glm::dvec3 sum(0.0);
    double weights = 0;
    const double x = uv.x * width - 0.5;
    const double y = (1 - uv.y) * height - 0.5;
    for (int row = -1; row <= height; ++row) {
        for (int column = -1; column <= width; ++column) {
            const double weight =
                std::max(0.0, 1 - std::abs(x - column)) * std::max(0.0, 1 - std::abs(y - row));
            sum += weight * decoded(texels(std::clamp(column, 0, width - 1),
                                           std::clamp(row, 0, height - 1)));
            weights += weight;
        }
    }
    return sum / weights;
}

/// A camera at z = 5 that sees [-1, 1] x [-1, 1] at z = 0, and sky of radiance 1 on all sides.
std::string scene_of(const std::string& shape, const std::string& texture) {
    return R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 22.6198649},
        "materials": {"picture": {"albedo_texture": )" +
           nlohmann::json(texture).dump() + R"(}}, "background": [1, 1, 1],
        "objects": [{)" +
           shape + R"(, "material": "picture"}]})";
}

const char* const kSquare = R"("quad": [[-1,-1,0],[1,-1,0],[1,1,0],[-1,1,0]])";

Frame centres(const Scene& scene, Extent size, int simd_width = 0) {
    RenderSettings settings = small_settings(size, 1);
    settings.first_hit = FirstHit::centre;
    settings.max_depth = 1;
    settings.simd_width = simd_width;
    return render(scene, settings).frame;
}

bool is_near(glm::vec3 found, glm::dvec3 value) {
    return glm::length(glm::dvec3(found) - value) < 2e-5;
}

/// How far p is along the edges of a triangle from its first corner.
glm::dvec2 coordinates(const std::array<glm::dvec3, 3>& corners, glm::dvec3 p) {
    const glm::dvec3 a = corners[1] - corners[0], b = corners[2] - corners[0], d = p - corners[0];
    const double aa = glm::dot(a, a), ab = glm::dot(a, b), bb = glm::dot(b, b);
    const double det = aa * bb - ab * ab;
    return {(bb * glm::dot(a, d) - ab * glm::dot(b, d)) / det,
            (aa * glm::dot(b, d) - ab * glm::dot(a, d)) / det};
}

class Textured {
  public:
    Textured() { save_raster(picture(), file()); }
    [[nodiscard]] std::string file() const { return dir_.path("picture.png"); }
    [[nodiscard]] Scene scene(const std::string& shape) const {
        return scene_from(scene_of(shape, file()));
    }
    [[nodiscard]] const TempDir& dir() const { return dir_; }

  private:
    TempDir dir_;
};

Error error_with(const std::string& shape, const std::string& texture) {
    return error_of([&] { scene_from(scene_of(shape, texture)); });
}

bool says(const Error& error, const std::string& text) {
    return std::string(error.what()).find(text) != std::string::npos;
}

}  // namespace

TEST_CASE("a texture stands upright on a quad that starts at its lower left corner", "[texture]") {
    const int width = GENERATE(from_range(simd_widths()));
    CAPTURE(width);
    const Textured textured;
    const Image albedo = centres(textured.scene(kSquare), {31, 31}, width).albedo;
    CHECK(is_near(albedo(0, 0), decoded({255, 0, 0})));
    CHECK(is_near(albedo(30, 0), decoded({128, 128, 128})));
    CHECK(is_near(albedo(0, 30), decoded({0, 0, 255})));
    CHECK(is_near(albedo(30, 30), decoded({64, 32, 16})));
}

TEST_CASE("between texels the albedo is bilinear, and the border's goes on outwards", "[texture]") {
    const int width = GENERATE(from_range(simd_widths()));
    CAPTURE(width);
    const Textured textured;
    const Extent size{31, 31};
    const Image albedo = centres(textured.scene(kSquare), size, width).albedo;
    for (int y = 0; y < size.height; ++y) {
        for (int x = 0; x < size.width; ++x) {
            const glm::dvec2 uv((x + 0.5) / size.width, 1 - (y + 0.5) / size.height);
            CHECK(is_near(albedo(x, y), expected(picture(), uv)));
        }
    }
    // Half way between the centres of green and white.
    CHECK(is_near(albedo(15, 15), {0.5, 1, 0.5}));
}

TEST_CASE("light that a textured surface reflects is that of its albedo at every point",
          "[texture]") {
    const Textured textured;
    RenderSettings settings = small_settings({24, 24}, 1);
    settings.max_depth = 1;
    settings.light_sampling = GENERATE(LightSampling::none, LightSampling::nee);
    const Frame frame = render(textured.scene(kSquare), settings).frame;
    for (std::size_t i = 0; i < frame.radiance.values().size(); ++i)
        CHECK(is_near(frame.radiance.values()[i], frame.albedo.values()[i]));
    CHECK(frame.direct == frame.radiance);
}

TEST_CASE("a picture lies on leaning quads, crooked quads and meshes by their corners",
          "[texture]") {
    const Textured textured;
    // Two triangles each, with the uv of their corners. The crooked quad is no parallelogram.
    struct Row {
        std::string shape;
        std::array<glm::dvec3, 4> corners;
        std::array<glm::dvec2, 4> uvs;
    };
    const std::array<glm::dvec2, 4> square = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    const Row row = GENERATE_COPY(values<Row>({
        {R"("quad": [[-1,-1,0],[1,-0.5,1],[1,0.75,0.5],[-1,0.25,-0.5]])",
         {{{-1, -1, 0}, {1, -0.5, 1}, {1, 0.75, 0.5}, {-1, 0.25, -0.5}}},
         square},
        {R"("quad": [[-1,-1,0],[0.5,-1,0],[1,1,0],[-0.75,0.5,0]])",
         {{{-1, -1, 0}, {0.5, -1, 0}, {1, 1, 0}, {-0.75, 0.5, 0}}},
         square},
        {R"("triangles": {"positions": [[-1,-1,0],[1,-1,0],[1,1,0],[-1,1,1]], "indices": [[0,1,2],[0,2,3]],
            "uvs": [[0.25,0.5],[1,0.125],[0.5,1],[0,0]]})",
         {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 1}}},
         {{{0.25, 0.5}, {1, 0.125}, {0.5, 1}, {0, 0}}}},
    }));
    CAPTURE(row.shape);
    const Frame frame = centres(textured.scene(row.shape), {23, 23});
    const std::array<std::array<std::size_t, 3>, 2> halves = {{{0, 1, 2}, {0, 2, 3}}};
    int hits = 0;
    for (std::size_t i = 0; i < frame.albedo.values().size(); ++i) {
        if (frame.object_id.values()[i] < 0) continue;
        const glm::dvec3 p = frame.position_world.values()[i];
        for (const auto& half : halves) {
            const auto& [a, b, c] = half;
            const glm::dvec2 st = coordinates({row.corners[a], row.corners[b], row.corners[c]}, p);
            const double edge = std::min({st.x, st.y, 1 - st.x - st.y});
            const glm::dvec3 on_plane = row.corners[a] + st.x * (row.corners[b] - row.corners[a]) +
                                        st.y * (row.corners[c] - row.corners[a]);
            if (edge < 1e-5 || glm::length(on_plane - p) > 1e-5) continue;
            ++hits;
            const glm::dvec2 uv =
                row.uvs[a] + st.x * (row.uvs[b] - row.uvs[a]) + st.y * (row.uvs[c] - row.uvs[a]);
            CHECK(is_near(frame.albedo.values()[i], expected(picture(), uv)));
        }
    }
    CHECK(hits > 150);
}

TEST_CASE("a texture is the same on a quad of many, which Embree intersects itself", "[texture]") {
    const Textured textured;
    Scene scene = textured.scene(kSquare);
    const Image few = centres(scene, {17, 17}).albedo;
    scene.materials.push_back({.name = "far"});
    for (int i = 0; i < 2100; ++i) {
        const auto x = static_cast<float>(i);
        scene.objects.push_back(
            {Quad{{{{x, 100, 0}, {x + 0.5f, 100, 0}, {x + 0.5f, 101, 0}, {x, 101, 0}}}}, 1});
    }
    const Image many = centres(scene, {17, 17}).albedo;
    for (std::size_t i = 0; i < many.values().size(); ++i)
        CHECK(is_near(many.values()[i], few.values()[i]));
}

TEST_CASE("materials of one file share its texels, and an emitter may wear a texture",
          "[texture]") {
    const Textured textured;
    const Scene scene = scene_from(
        R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov_degrees": 20},
        "materials": {"a": {"albedo_texture": ")" +
        textured.file() + R"("}, "lamp": {"emission": [1, 2, 3], "albedo_texture": ")" +
        textured.file() + R"("}},
        "objects": [{"quad": [[-1,-1,0],[1,-1,0],[1,1,0],[-1,1,0]], "material": "lamp"}]})");
    REQUIRE(scene.materials[0].albedo_texture != nullptr);
    CHECK(scene.materials[0].albedo_texture == scene.materials[1].albedo_texture);
    const Frame frame = centres(scene, {5, 5});
    CHECK(frame.radiance(2, 2) == glm::vec3(1, 2, 3));
    CHECK(is_near(frame.albedo(2, 2), expected(picture(), {0.5, 0.5})));
}

TEST_CASE("a texture's path is relative to the scene file", "[texture]") {
    const Textured textured;
    const std::string path = textured.dir().write("scene.json", scene_of(kSquare, "./picture.png"));
    CHECK(load_scene(path).materials[0].albedo_texture->texels.size() == Extent{3, 2});
}

TEST_CASE("a scene is another one where the bytes of a texture are others", "[texture]") {
    const Textured textured;
    const std::string path = textured.dir().write("scene.json", scene_of(kSquare, "picture.png"));
    const std::string before = scene_hash(path, load_scene(path));
    CHECK(scene_hash(path, load_scene(path)) == before);
    Grid<glm::u8vec3> other = picture();
    other(1, 1).r = 254;
    save_raster(other, textured.file());
    CHECK(scene_hash(path, load_scene(path)) != before);
}

TEST_CASE("floating-point textures are linear", "[texture]") {
    const TempDir dir;
    Image texels({1, 1}, glm::vec3(0.5f, 0.25f, 0.125f));
    save_image(texels, dir.path("grey.exr"));
    const Frame frame = centres(scene_from(scene_of(kSquare, dir.path("grey.exr"))), {3, 3});
    CHECK(frame.albedo(1, 1) == glm::vec3(0.5f, 0.25f, 0.125f));
}

TEST_CASE("a texture that cannot be read is refused: where it is named and why", "[texture]") {
    const TempDir dir;
    const std::string at = "test.json: /materials/picture/albedo_texture: ";
    const auto hdr = [&](const char* size) {
        return dir.write("size.hdr",
                         std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n") + size + "\n");
    };
    const auto check = [&](const std::string& file, ExitCode code, const std::string& text) {
        const Error error = error_with(kSquare, file);
        CAPTURE(error.what());
        CHECK(error.code() == code);
        CHECK(says(error, at + file + text));
        CHECK(std::string(error.what()).find('\n') == std::string::npos);
    };
    check(dir.path("none.png"), ExitCode::file, ": cannot be read: No such file or directory");
    check(dir.path(""), ExitCode::file, ": cannot be read: it is a directory");
    check(dir.write("letter.png", "Dear sir,"), ExitCode::file, ": cannot be read: ");
    check(hdr("-Y 0 +X 0"), ExitCode::file, ": cannot be read: ");
    check(hdr("-Y 20000 +X 20000"), ExitCode::usage,
          ": found an image of 20000x20000, allowed: sides of at most 16384");
    check(hdr("-Y 200 +X 200"), ExitCode::file, ": cannot be read: ");  // no texels at all
    Image texels({3, 2}, glm::vec3(0.5f));
    texels(2, 1).y = std::nanf("");
    save_image(texels, dir.path("nan.exr"));
    check(dir.path("nan.exr"), ExitCode::non_finite, ": found nan at pixel (2, 1), channel G");
    texels(2, 1).y = 1.5f;
    save_image(texels, dir.path("bright.exr"));
    const Error error = error_with(kSquare, dir.path("bright.exr"));
    CHECK(error.code() == ExitCode::usage);
    CHECK(says(error, at + "found " + dir.path("bright.exr") +
                          " with 1.500000 at texel (2, 1), allowed: an image of values from 0 to "
                          "1"));
}

TEST_CASE("a texture needs to know where its picture lies", "[texture]") {
    const Textured textured;
    const Error sphere =
        error_with(R"("sphere": {"center": [0, 0, 0], "radius": 1})", textured.file());
    CHECK(says(sphere,
               "test.json: /objects/0/sphere: found a sphere of a material with albedo_texture, "
               "allowed: a quad, or triangles with uvs"));
    const Error mesh =
        error_with(R"("triangles": {"positions": [[0,0,0],[1,0,0],[0,1,0]], "indices": [[0,1,2]]})",
                   textured.file());
    CHECK(says(mesh,
               "test.json: /objects/0/triangles: found no key \"uvs\", allowed: uvs, since "
               "the material has albedo_texture"));
}
