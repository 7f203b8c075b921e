// SPDX-License-Identifier: Apache-2.0
#include "tests/catch.h"
#include "tests/scene_text.h"

using namespace vecino;
using namespace vecino::test;

TEST_CASE("a scene reads as it is written", "[scene]") {
    const Scene scene = scene_from(R"({
        "camera": {"position": [0, 1, 4], "look_at": [0, 1, 0], "up": [0, 1, 0], "vertical_fov_degrees": 40},
        "materials": {"m": {"albedo": [0.5, 0.25, 1]}, "lamp": {"emission": [1, 2, 3]}},
        "objects": [
            {"quad": [[0,0,0],[1,0,0],[1,1,0],[0,1,0]], "material": "m"},
            {"sphere": {"center": [1, 2, 3], "radius": 4}, "material": "lamp"},
            {"triangles": {"positions": [[0,0,0],[1,0,0],[0,1,0]], "indices": [[2,1,0]], "normals": [[0,0,2],[0,1,0],[1,0,0]]},
             "material": "m"}]})");
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
