// SPDX-License-Identifier: Apache-2.0
//
// A scene flattened for tracing: what the kernels read, and Embree's acceleration structure.
#pragma once

#include <memory>
#include <vector>

#include "core/embree_scene.h"
#include "core/light_tree.h"
#include "core/scene.h"
#include "core/trace_task.h"

namespace vecino {

struct FlatScene {
    std::vector<float> surface_fields;  ///< SurfaceTable::fields
    std::vector<std::int32_t> object_id;
    std::uint32_t surface_stride = 0;
    std::uint32_t first_triangle = 0;
    std::uint32_t first_sphere = 0;
    std::vector<VertexNormals> vertex_normals;  ///< one per triangle; empty: no mesh has normals
    std::vector<PlacedTexture> textures;        ///< on their surfaces; the scene holds the images
    bool has_mirrors = false;
    std::vector<LightRecord> lights;
    LightTreeTable light_tree;
    std::unique_ptr<EmbreeScene> embree;
};

/// Where the scene has textures, it must outlive the flat scene.
FlatScene flatten(const Scene& scene);

/// The part of a task that the scene fixes. The flat scene must outlive it.
TraceTask trace_task(const Scene& scene, const FlatScene& flat, float aspect);

}  // namespace vecino
