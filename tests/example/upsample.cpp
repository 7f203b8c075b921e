// SPDX-License-Identifier: Apache-2.0
//
// Traces a scene at half the size, rebuilds the rest from neighbouring pixels, saves the image.
// Usage: upsample SCENE.json IMAGE
#include <core/error.h>
#include <core/image_io.h>
#include <core/render.h>
#include <core/scene.h>
#include <filters/schemes.h>

#include <cstdio>

int main(int argc, char** argv) try {
    if (argc != 3) throw vecino::Error(vecino::ExitCode::usage, "usage: upsample SCENE.json IMAGE");
    const vecino::Scene scene = vecino::load_scene(argv[1]);
    const vecino::Scheme& scheme = vecino::find_scheme("distance3d_normal");

    vecino::RenderSettings settings;
    settings.size = {128, 128};
    settings.reduction = 2;  // traces 64x64
    settings.planes = scheme.needs;
    settings.planes.add(vecino::Plane::id);  // tells misses from hits
    const vecino::Render low = vecino::render(scene, settings);

    vecino::ReconstructionRequest request;
    request.size = settings.size;
    request.parameters.weighting = vecino::Weighting::inverse;
    const vecino::Reconstruction large = vecino::reconstruct(low.frame, scheme, request);
    vecino::save_image(large.image, argv[2]);
} catch (const vecino::Error& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return static_cast<int>(error.code());
}
