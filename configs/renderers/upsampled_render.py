#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders a small image and a full-resolution guide with another renderer, and has vecino rebuild the large image of both:
python3 upsampled_render.py RENDERER.py SCENE.json OUT.exr --size WxH --reduction F --scheme NAME --vecino PROGRAM ...

RENDERER.py is mitsuba_render.py or cycles_render.py of this folder. The attribute "seconds" of the image is the sum of rendering the
small image, rendering the guide and rebuilding, each without its program's start, without reading and writing files.
"""
import argparse
import json
import pathlib
import struct
import subprocess
import sys
import tempfile

from arguments import size


def header(data):
    """The attributes of an EXR file of one part or of its first part, and where they end."""
    at, found = 8, {}
    while data[at]:
        name, kind, rest = data[at:].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (length,) = struct.unpack_from("<i", data, at)
        found[name.decode()] = data[at + 4 : at + 4 + length]
        at += 4 + length
    return found, at


def seconds_in(path):
    """Of rendering, as Mitsuba's script or Blender tell them."""
    found, _ = header(path.read_bytes())
    if "seconds" in found:
        return struct.unpack({4: "<f", 8: "<d"}[len(found["seconds"])], found["seconds"])[0]
    seconds = 0.0
    for part in found["cycles.ViewLayer.render_time"].decode().split(":"):
        seconds = 60 * seconds + float(part)
    return seconds


def add_seconds(path, seconds):
    """Puts an attribute at the end of the header. All that follows moves, and the table of offsets says so."""
    data = path.read_bytes()
    _, end = header(data)
    added = b"seconds\0float\0" + struct.pack("<if", 4, seconds)
    first = min(struct.unpack_from("<Q", data, end + 1)[0], len(data))
    count = (first - (end + 1)) // 8
    table = [offset + len(added) for offset in struct.unpack_from(f"<{count}Q", data, end + 1)]
    path.write_bytes(data[:end] + added + b"\0" + struct.pack(f"<{count}Q", *table) + data[first:])


def render(arguments, planes, size, path):
    subprocess.run([sys.executable, arguments.renderer, arguments.scene, str(path), "--size", "{}x{}".format(*size), "--spp",
                    str(arguments.spp), "--max-depth", str(arguments.max_depth), "--seed", str(arguments.seed), "--planes", planes],
                   check=True)
    return seconds_in(path)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("renderer")
    parser.add_argument("scene")
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--size", type=size, required=True)
    parser.add_argument("--reduction", type=int, required=True)
    parser.add_argument("--spp", type=int, required=True)
    parser.add_argument("--max-depth", type=int, required=True)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--scheme", required=True)
    parser.add_argument("--guide-scale", type=int, default=1, help="samples of the guide per pixel, along each axis")
    parser.add_argument("--vecino", required=True, help="the program")
    arguments = parser.parse_args()
    width, height = arguments.size
    with tempfile.TemporaryDirectory() as folder:
        low, guide = pathlib.Path(folder) / "low.exr", pathlib.Path(folder) / "guide.exr"
        seconds = render(arguments, "emission", (width // arguments.reduction, height // arguments.reduction), low)
        scale = arguments.guide_scale
        seconds += render(arguments, "guide", (width * scale, height * scale), guide)
        made = subprocess.run([arguments.vecino, "upsample", str(low), "-o", str(arguments.output), "--size", f"{width}x{height}",
                               "--scheme", arguments.scheme, "--guide", str(guide), "--json"], check=True, stdout=subprocess.PIPE)
    add_seconds(arguments.output, seconds + json.loads(made.stdout)["time_s"]["reconstruct"])


main()
