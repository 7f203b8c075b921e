// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "tests/catch.h"
#include "tests/error_of.h"
#include "tests/scene_text.h"

using namespace vecino;
using namespace vecino::test;

namespace {

const char* const kCamera =
    R"("camera": {"position": [0, 1, 4], "look_at": [0, 1, 0], "up": [0, 1, 0], "vertical_fov_degrees": 40})";

std::string with(const std::string& materials, const std::string& objects) {
    return std::string("{") + kCamera + R"(, "materials": {)" + materials + R"(}, "objects": [)" +
           objects + "]}";
}

std::string with_object(const std::string& object) {
    return with(R"("m": {"albedo": [0.5, 0.5, 0.5]})", object);
}

struct Fault {
    std::string text;
    std::string message;  ///< after "test.json: "
};

}  // namespace

TEST_CASE("a scene reads as it is written", "[scene]") {
    const Scene scene =
        scene_from(with(R"("m": {"albedo": [0.5, 0.25, 1]}, "lamp": {"emission": [1, 2, 3]})",
                        R"({"quad": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "material": "m"},
           {"sphere": {"center": [1, 2, 3], "radius": 4}, "material": "lamp"},
           {"triangles": {"positions": [[0,0,0],[1,0,0],[0,1,0]], "indices": [[2,1,0]], "normals": [[0,0,2],[0,1,0],[1,0,0]]},
            "material": "m"})"));
    CHECK(scene.name == "test");
    CHECK(scene.camera.position_world == glm::vec3(0, 1, 4));
    CHECK(scene.camera.vertical_fov_degrees == 40.0f);
    CHECK(scene.background == glm::vec3(0.0f));
    REQUIRE(scene.objects.size() == 3);
    CHECK(std::get<Quad>(scene.objects[0].shape).corners_world[2] == glm::vec3(1, 1, 0));
    CHECK(std::get<Sphere>(scene.objects[1].shape).radius == 4.0f);
    const auto& mesh = std::get<TriangleMesh>(scene.objects[2].shape);
    CHECK(mesh.indices[0] == std::array<std::uint32_t, 3>{2, 1, 0});
    CHECK(mesh.normals_world[0] == glm::vec3(0, 0, 1));  // made unit
    const Material& lamp = scene.materials[scene.objects[1].material];
    CHECK(lamp.emission == glm::vec3(1, 2, 3));
    CHECK(lamp.albedo == glm::vec3(0.0f));
}

TEST_CASE("every scene of the repository loads", "[scene]") {
    const std::string name =
        GENERATE("cornell", "cornell_sphere", "hard_shadows", "checker_spheres", "illustration_9",
                 "illustration_13", "illustration_15", "illustration_16");
    CHECK(repository_scene(name).name == name);
}

TEST_CASE("a faulty scene is refused: where, what was found, what is allowed", "[scene]") {
    const std::string quad = R"({"quad": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "material": "m"})";
    const std::vector<Fault> faults = {
        {"[]", "/: found [], allowed: an object"},
        {"{}", "/: found no key \"camera\", allowed: an object that has it"},
        {R"({"pattern": "plaid"})", "/pattern: found \"plaid\", allowed: \"xy_gradient\""},
        {R"({"pattern": "xy_gradient", "objects": []})",
         "/: found unknown key \"objects\", allowed: pattern"},
        {with(R"("m": {"albdeo": [0, 0, 0]})", ""),
         "/materials/m: found unknown key \"albdeo\", allowed: albedo, emission"},
        {with(R"("m": {"albedo": [0, 0, 1.5]})", ""),
         "/materials/m/albedo/2: found 1.5, allowed: a number from 0 to 1"},
        {with(R"("m": {"emission": [0, 0, -1]})", ""),
         "/materials/m/emission/2: found -1, allowed: a number from 0 to 1e+30"},
        {with(R"("m": {"albedo": [0, 0]})", ""),
         "/materials/m/albedo: found 2 elements, allowed: 3 numbers"},
        {with(R"("m": {"albedo": [0, "x", 0]})", ""),
         "/materials/m/albedo/1: found \"x\", allowed: a number from 0 to 1"},
        {with_object(R"({"quad": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "material": "n"})"),
         "/objects/0/material: found \"n\", allowed: one of the scene's materials: m"},
        {with_object(R"({"quad": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]]})"),
         "/objects/0: found no key \"material\", allowed: an object that has it"},
        {with_object(R"({"quad": [[0,0,0],[1,0,0],[1,1,0]], "material": "m"})"),
         "/objects/0/quad: found 3 corners, allowed: 4 corners of 3 numbers"},
        {with_object(R"({"quad": [[0,0,0],[1,0,0],[2,0,0],[3,0,0]], "material": "m"})"),
         "/objects/0/quad: found a zero-area shape, allowed: corners 012 and 023 that span "
         "triangles"},
        {with_object(R"({"sphere": {"center": [0,0,0], "radius": 0}, "material": "m"})"),
         "/objects/0/sphere/radius: found 0, allowed: a number above 0"},
        {with_object(R"({"cube": 1, "material": "m"})"),
         "/objects/0: found unknown key \"cube\", allowed: quad, sphere, triangles, material"},
        {with_object(R"({"material": "m"})"),
         "/objects/0: found 0 shapes, allowed: exactly one of quad, sphere, triangles"},
        {with_object(
             R"({"triangles": {"positions": [[0,0,0],[1,0,0],[0,1,0]], "indices": [[0,1,3]]}, "material": "m"})"),
         "/objects/0/triangles/indices/0/2: found 3, allowed: an integer from 0 to 2"},
        {with_object(
             R"({"triangles": {"positions": [[0,0,0],[1,0,0],[0,1,0]], "indices": [[0,1,1]]}, "material": "m"})"),
         "/objects/0/triangles/indices/0: found a zero-area shape, allowed: three positions that "
         "span a triangle"},
        {with_object(
             R"({"triangles": {"positions": [[0,0,0],[1,0,0],[0,1,0]], "indices": []}, "material": "m"})"),
         "/objects/0/triangles/indices: found [], allowed: at least 1 triangle"},
        {with_object(
             R"({"triangles": {"positions": [[0,0,0],[1,0,0],[0,1,0]], "indices": [[0,1,2]], "normals": [[0,0,1]]}, "material": "m"})"),
         "/objects/0/triangles/normals: found 1 normals, allowed: as many as positions (3)"},
        {R"({"camera": {"position": [0,0,1], "look_at": [0,0,1], "up": [0,1,0], "vertical_fov_degrees": 40}, "materials": {}, "objects": []})",
         "/camera/up: found [0,1,0], allowed: a direction that is not parallel to look_at - "
         "position, which are "
         "different points"},
        {R"({"camera": {"position": [0,0,1], "look_at": [0,0,0], "up": [0,1,0], "vertical_fov_degrees": 180}, "materials": {}, "objects": []})",
         "/camera/vertical_fov_degrees: found 180, allowed: a number from 0.001 to 179"},
    };
    for (const Fault& fault : faults) {
        const Error error = error_of([&] { scene_from(fault.text); });
        CHECK(std::string(error.what()) == "test.json: " + fault.message);
        CHECK(error.code() == ExitCode::usage);
    }
    CHECK_NOTHROW(scene_from(with_object(quad)));
}
