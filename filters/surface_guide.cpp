// SPDX-License-Identifier: Apache-2.0
#include "filters/surface_guide.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "core/parallel.h"

namespace vecino {
namespace {

constexpr std::size_t kPixelsPerBlock = 4096;

glm::vec3 position(const FirstHitRecord& hit) {
    return {hit.position_world[0], hit.position_world[1], hit.position_world[2]};
}

glm::vec3 normal(const FirstHitRecord& hit) {
    return {hit.normal_world[0], hit.normal_world[1], hit.normal_world[2]};
}

}  // namespace

SurfaceGuide::SurfaceGuide(std::vector<FirstHitRecord> hits, const Scene& scene,
                           const GuideSettings& settings)
    : hits_(std::move(hits)),
      settings_(settings),
      pixel_angle_(2.0f * std::tan(glm::radians(scene.camera.vertical_fov_degrees) / 2.0f) /
                   static_cast<float>(settings.size.height)),
      marks_(hits_.size()) {
    for_each_block(hits_.size(), kPixelsPerBlock, settings.threads, [&](BlockRange block) {
        for (std::size_t i = block.begin; i < block.end; ++i) mark(i, scene);
    });
}

void SurfaceGuide::mark(std::size_t pixel, const Scene& scene) {
    if (!is_miss(pixel)) {
        const auto object = static_cast<std::size_t>(hits_[pixel].object_id);
        const Material& material = scene.materials[scene.objects[object].material];
        if (material.mirror || material.emission != glm::vec3(0.0f)) marks_[pixel] |= kSpecial;
    }
    const auto [x, y] = pixel_at(pixel, settings_.size);
    const auto width = static_cast<std::size_t>(settings_.size.width);
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, settings_.size.height - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, settings_.size.width - 1); ++u) {
            const std::size_t other =
                static_cast<std::size_t>(v) * width + static_cast<std::size_t>(u);
            if (is_same_surface(pixel, other)) continue;
            marks_[pixel] |= kEdge;
            return;
        }
    }
}

bool SurfaceGuide::is_miss(std::size_t pixel) const {
    return hits_[pixel].object_id == kMiss;
}

float SurfaceGuide::footprint(std::size_t pixel) const {
    return hits_[pixel].distance_world * pixel_angle_;
}

bool SurfaceGuide::has_like_normal(std::size_t a, std::size_t b) const {
    if (is_miss(a) || is_miss(b)) return false;
    return a == b || glm::dot(normal(hits_[a]), normal(hits_[b])) > settings_.min_normal_cosine;
}

bool SurfaceGuide::is_same_surface(std::size_t a, std::size_t b) const {
    if (hits_[a].object_id != hits_[b].object_id) return false;
    if (a == b || is_miss(a)) return true;
    if (!has_like_normal(a, b)) return false;
    const glm::vec3 between = position(hits_[b]) - position(hits_[a]);
    return std::abs(glm::dot(normal(hits_[a]), between)) < footprint(a) &&
           std::abs(glm::dot(normal(hits_[b]), between)) < footprint(b);
}

double SurfaceGuide::distance(std::size_t from, std::size_t to) const {
    if (is_miss(from) || is_miss(to)) {
        const Pixel a = pixel_at(from, settings_.size);
        const Pixel b = pixel_at(to, settings_.size);
        return std::hypot(a.x - b.x, a.y - b.y);
    }
    const glm::vec3 between = position(hits_[to]) - position(hits_[from]);
    return static_cast<double>(glm::length(between)) / static_cast<double>(footprint(from));
}

}  // namespace vecino
