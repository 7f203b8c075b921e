#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders a scene of vecino with Mitsuba 3: python3 mitsuba_render.py SCENE.json OUT.exr --size WxH --spp N --max-depth D --seed S

Needs: pip install mitsuba numpy; LLVM (Debian: libllvm19). Path tracing with multiple importance sampling, independent samples, box
filter. The attribute "seconds" of the image tells the time of rendering alone: without Python's start, and without compiling the
kernel, which a render of another seed does first. --planes emission adds the light that is seen directly, --planes guide writes that and
the first hits through the pixel centres, and no other light: what `vecino upsample --guide` reads.
"""
import json
import pathlib
import tempfile
import time

import mitsuba as mi
import numpy as np

from arguments import render_arguments


def mesh(name, positions, faces):
    shape = mi.Mesh(name, len(positions), len(faces))
    parameters = mi.traverse(shape)
    parameters["vertex_positions"] = [c for position in positions for c in position]
    parameters["faces"] = [i for face in faces for i in face]
    parameters.update()
    return shape


def shapes_of(scene, folder):
    for number, thing in enumerate(scene["objects"]):
        material = scene["materials"][thing["material"]]
        if "sphere" in thing:
            shape = {"type": "sphere", "center": thing["sphere"]["center"], "radius": thing["sphere"]["radius"]}
        else:
            quad = thing.get("quad")
            positions = quad or thing["triangles"]["positions"]
            faces = [[0, 1, 2], [0, 2, 3]] if quad else thing["triangles"]["indices"]
            file = folder / f"{number}.ply"
            mesh(f"shape{number}", positions, faces).write_ply(str(file))
            shape = {"type": "ply", "filename": str(file), "face_normals": True}
        reflectance = {"type": "rgb", "value": material.get("albedo", [0, 0, 0])}
        shape["bsdf"] = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": reflectance}}
        if any(material.get("emission", [0])):
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": material["emission"]}}
        yield f"shape{number}", shape
    if any(scene.get("background", [0])):
        yield "background", {"type": "constant", "radiance": {"type": "rgb", "value": scene["background"]}}


def load(scene, arguments, folder):
    camera = scene["camera"]
    width, height = arguments.size
    paths = {"type": "path", "max_depth": arguments.max_depth + 1, "rr_depth": 1000}
    emission = {"type": "path", "max_depth": 1}
    guide = "position:position,nn:geo_normal,albedo:albedo,shape_index:shape_index,dd.y:depth"
    integrators = {
        "none": paths,
        "emission": {"type": "aov", "aovs": "dd.y:depth", "image": paths, "emission": emission},
        "guide": {"type": "aov", "aovs": guide, "emission": emission},
    }
    # One sample per pixel, in its middle.
    centre = {"type": "stratified", "sample_count": 1, "jitter": False}
    return mi.load_dict({
        "type": "scene",
        "integrator": integrators[arguments.planes],
        "sensor": {
            "type": "perspective", "fov": camera["vertical_fov_degrees"], "fov_axis": "y",
            "to_world": mi.ScalarTransform4f().look_at(origin=camera["position"], target=camera["look_at"], up=camera["up"]),
            "sampler": centre if arguments.planes == "guide" else {"type": "independent"},
            "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
        },
        **dict(shapes_of(scene, folder)),
    })


def main():
    arguments = render_arguments(__doc__)
    if arguments.planes == "guide":
        arguments.spp = 1
    mi.set_variant("llvm_ad_rgb")
    with tempfile.TemporaryDirectory() as folder:
        scene = load(json.loads(pathlib.Path(arguments.scene).read_text()), arguments, pathlib.Path(folder))
        np.array(mi.render(scene, spp=arguments.spp, seed=arguments.seed + 1000000))
        start = time.perf_counter()
        image = np.array(mi.render(scene, spp=arguments.spp, seed=arguments.seed))
        seconds = time.perf_counter() - start
        bitmap = mi.Bitmap(image) if arguments.planes == "none" else scene.sensors()[0].film().bitmap()
    bitmap.metadata()["seconds"] = seconds
    bitmap.write(arguments.output)


main()
