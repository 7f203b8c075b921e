// SPDX-License-Identifier: Apache-2.0
//
// The tree over emitters: every emitter is at the end of its trail, inside all nodes on the way.
#include "core/light_tree.h"

#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>
#include <random>
#include <set>

#include "tests/catch.h"

using namespace vecino;

namespace {

void put(float (&to)[3], glm::vec3 from) {
    for (int k = 0; k < 3; ++k) to[k] = from[k];
}

/// A triangle or, for every third, a sphere.
LightRecord light_at(glm::vec3 place, glm::vec3 normal, int number) {
    LightRecord light{};
    const glm::vec3 aside = std::abs(normal.x) < 0.5f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const glm::vec3 edge = glm::normalize(glm::cross(normal, aside));
    light.kind = number % 3 == 0 ? LightKind::sphere : LightKind::triangle;
    put(light.origin, place);
    put(light.edge1, 0.1f * edge);
    put(light.edge2, 0.2f * glm::cross(normal, edge));
    put(light.normal, normal);
    light.radius = 0.05f;
    light.area = 0.01f;
    for (float& value : light.radiance) value = 1.0f + static_cast<float>(number % 7);
    return light;
}

struct Numbers {
    std::mt19937 bits{1};
    float operator()() { return std::uniform_real_distribution<float>(-1, 1)(bits); }
    glm::vec3 vector() { return {(*this)(), (*this)(), (*this)()}; }
};

class Tree {
  public:
    explicit Tree(std::vector<LightRecord> lights)
        : lights_(std::move(lights)), table_(build_light_tree(lights_)) {}

    [[nodiscard]] const std::vector<LightRecord>& lights() const { return lights_; }
    [[nodiscard]] std::uint32_t count() const { return table_.count; }
    [[nodiscard]] float field(int number, std::uint32_t node) const {
        return table_.fields[static_cast<std::size_t>(number) * table_.stride + node];
    }
    [[nodiscard]] std::int32_t next(std::uint32_t node) const {
        return std::bit_cast<std::int32_t>(field(kLightNodeNext, node));
    }
    [[nodiscard]] glm::vec3 vector(int number, std::uint32_t node) const {
        return {field(number, node), field(number + 1, node), field(number + 2, node)};
    }

    /// The nodes from the root to the end of a light's trail.
    [[nodiscard]] std::vector<std::uint32_t> way_to(std::uint32_t light) const {
        std::vector<std::uint32_t> way = {0};
        for (std::uint32_t trail = lights_[light].trail; next(way.back()) > 0; trail >>= 1) {
            const std::uint32_t node = way.back();
            way.push_back((trail & 1) != 0 ? static_cast<std::uint32_t>(next(node)) : node + 1);
        }
        return way;
    }

  private:
    std::vector<LightRecord> lights_;
    LightTreeTable table_;
};

void check_holds(const Tree& tree, std::uint32_t node, const LightRecord& light) {
    const glm::vec3 origin(light.origin[0], light.origin[1], light.origin[2]);
    const glm::vec3 normal(light.normal[0], light.normal[1], light.normal[2]);
    const glm::vec3 center = tree.vector(kLightNodeCenter, node);
    const float radius = std::sqrt(tree.field(kLightNodeRadius2, node));
    const float cosine = tree.field(kLightNodeCosine, node);
    if (light.kind == LightKind::sphere) {
        CHECK(glm::distance(origin, center) + light.radius <= radius);
        CHECK(cosine == -1.0f);  // it sends light everywhere
        return;
    }
    const glm::vec3 edge1(light.edge1[0], light.edge1[1], light.edge1[2]);
    const glm::vec3 edge2(light.edge2[0], light.edge2[1], light.edge2[2]);
    for (const glm::vec3 corner : {origin, origin + edge1, origin + edge2})
        CHECK(glm::distance(corner, center) <= radius);
    const glm::vec3 axis = tree.vector(kLightNodeAxis, node);
    CHECK(glm::length(axis) == Approx(1.0f));
    CHECK(glm::dot(axis, normal) >= cosine - 5e-7f);  // by rounding
}

double power_of(const LightRecord& light) {
    const double share = light.kind == LightKind::sphere ? 0.25 : 1.0;
    return share * static_cast<double>(light.radiance[0]) * static_cast<double>(light.area);
}

void check_tree(const Tree& tree) {
    const auto count = static_cast<std::uint32_t>(tree.lights().size());
    REQUIRE(tree.count() == 2 * count - 1);
    std::set<std::uint32_t> leaves;
    double power = 0;
    for (std::uint32_t light = 0; light < count; ++light) {
        const auto way = tree.way_to(light);
        CHECK(tree.next(way.back()) == static_cast<std::int32_t>(~light));
        CHECK(way.size() <= 32);
        leaves.insert(way.back());
        for (const std::uint32_t node : way) check_holds(tree, node, tree.lights()[light]);
        power += power_of(tree.lights()[light]);
    }
    CHECK(leaves.size() == count);
    CHECK(tree.field(kLightNodePower, 0) == Approx(power));
}

}  // namespace

TEST_CASE("every emitter is at the end of its trail, inside all nodes on the way", "[light_tree]") {
    const int count = GENERATE(1, 2, 3, 17, 500);
    Numbers number;
    std::vector<LightRecord> lights;
    for (int i = 0; i < count; ++i)
        lights.push_back(light_at(10.0f * number.vector(), glm::normalize(number.vector()), i));
    check_tree(Tree(std::move(lights)));
}

TEST_CASE("emitters that share a place, or lie ever closer to one, do not make a deep tree",
          "[light_tree]") {
    const float ratio = GENERATE(1.0f, 0.5f);
    std::vector<LightRecord> lights;
    float place = 1e9f;
    for (int i = 0; i < 1000; ++i, place *= ratio)
        lights.push_back(light_at({ratio == 1.0f ? 1.0f : place, 0, 0}, {0, 0, 1}, 3 * i));
    check_tree(Tree(std::move(lights)));
}

TEST_CASE("without emitters there is no tree", "[light_tree]") {
    std::vector<LightRecord> none;
    CHECK(build_light_tree(none).count == 0);
}
