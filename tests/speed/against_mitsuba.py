#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Samples per second of vecino and of Mitsuba 3 (llvm_ad_rgb), on the same scenes, in turn, in one run.

Needs: pip install mitsuba numpy; LLVM (Debian: libllvm19). Usage: against_mitsuba.py VECINO [--repeats 7] [--json]
512x512, 64 spp, depth 2, next-event estimation, independent samples, radiance only. Mitsuba's path integrator uses
multiple importance sampling; its max_depth counts one more. Medians and the range of the ratios of neighbouring runs.
"""
import argparse
import json
import pathlib
import statistics
import subprocess
import tempfile
import time

import mitsuba as mi

SIZE, SPP, DEPTH = 512, 64, 2


def shapes_of(scene):
    for number, thing in enumerate(scene["objects"]):
        material = scene["materials"][thing["material"]]
        shape = {}
        if "quad" in thing:
            mesh = mi.Mesh(f"quad{number}", 4, 2)
            parameters = mi.traverse(mesh)
            parameters["vertex_positions"] = [c for corner in thing["quad"] for c in corner]
            parameters["faces"] = [0, 1, 2, 0, 2, 3]
            parameters.update()
            file = pathlib.Path(tempfile.mkdtemp()) / f"quad{number}.ply"
            mesh.write_ply(str(file))
            shape = {"type": "ply", "filename": str(file), "face_normals": True}
        elif "sphere" in thing:
            shape = {"type": "sphere", "center": thing["sphere"]["center"], "radius": thing["sphere"]["radius"]}
        else:
            raise SystemExit("only quads and spheres")
        reflectance = {"type": "rgb", "value": material.get("albedo", [0, 0, 0])}
        shape["bsdf"] = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": reflectance}}
        if any(material.get("emission", [0])):
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": material["emission"]}}
        yield f"shape{number}", shape


def load(path):
    scene = json.loads(pathlib.Path(path).read_text())
    camera = scene["camera"]
    return mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": DEPTH + 1, "rr_depth": 100},
        "sensor": {
            "type": "perspective", "fov": camera["vertical_fov_degrees"], "fov_axis": "y",
            "to_world": mi.ScalarTransform4f().look_at(origin=camera["position"], target=camera["look_at"], up=camera["up"]),
            "sampler": {"type": "independent", "sample_count": SPP},
            "film": {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
        },
        **dict(shapes_of(scene)),
    })


def time_mitsuba(scene, seed):
    import drjit as dr
    start = time.perf_counter()
    image = mi.render(scene, spp=SPP, seed=seed)
    dr.eval(image)
    dr.sync_thread()
    return time.perf_counter() - start, image


def time_vecino(program, scene, seed, options=()):
    with tempfile.TemporaryDirectory() as folder:
        out = subprocess.run(
            [program, "render", scene, "-o", f"{folder}/a.exr", "--size", f"{SIZE}x{SIZE}", "--spp", str(SPP),
             "--max-depth", str(DEPTH), "--sampler", "independent", "--planes", "radiance", "--seed", str(seed), "--json",
             *options], check=True, capture_output=True, text=True).stdout
    return json.loads(out)["time_s"]["trace"]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("vecino", help="the program")
    arguments.add_argument("--repeats", type=int, default=7)
    arguments.add_argument("--json", action="store_true")
    arguments = arguments.parse_args()
    mi.set_variant("llvm_ad_rgb")
    mi.set_log_level(mi.LogLevel.Error)
    samples = SIZE * SIZE * SPP
    root = pathlib.Path(__file__).resolve().parents[2]
    rows = []
    for name in ["cornell", "cornell_sphere"]:
        path = str(root / "scenes" / f"{name}.json")
        scene = load(path)
        time_mitsuba(scene, 0)  # compiles its kernel
        time_vecino(arguments.vecino, path, 0)
        pairs = []
        for seed in range(1, arguments.repeats + 1):
            pairs.append((time_mitsuba(scene, seed)[0], time_vecino(arguments.vecino, path, seed)))
        theirs = statistics.median(p[0] for p in pairs)
        ours = statistics.median(p[1] for p in pairs)
        ratios = sorted(p[0] / p[1] for p in pairs)
        rows.append({"scene": name, "mitsuba_samples_per_s": samples / theirs, "vecino_samples_per_s": samples / ours,
                     "ratio": statistics.median(ratios), "least": ratios[0], "most": ratios[-1]})
    if arguments.json:
        print(json.dumps({"mitsuba": mi.__version__, "rows": rows}))
        return
    print(f"{'scene':<16}{'Mitsuba':>10}{'vecino':>10}   Msamples/s, ratio (range of {arguments.repeats} pairs)")
    for r in rows:
        print(f"{r['scene']:<16}{r['mitsuba_samples_per_s'] / 1e6:>10.2f}{r['vecino_samples_per_s'] / 1e6:>10.2f}"
              f"   {r['ratio']:.2f} ({r['least']:.2f} to {r['most']:.2f})")


main()
