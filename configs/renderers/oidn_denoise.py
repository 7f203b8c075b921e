#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Denoises a frame of vecino with Intel Open Image Denoise: python3 oidn_denoise.py FRAME.exr OUT.exr [--quality high|balanced|fast]

Needs: pip install pyoidn OpenEXR numpy. Runs the oidnDenoise program that the package holds, on radiance and, where the frame has them, the
anti-aliased guides AlbedoMean and NormalMean. The attribute "seconds" of the image tells the program's own time of filtering, the median
of three: reading, writing and setting up the device and the filter are left out.
"""
import argparse
import os
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

import numpy as np
import OpenEXR
import pyoidn

RUNS = 3
PACKAGE = pathlib.Path(pyoidn.__file__).parent / "oidn"
GUIDES = {"--alb": ("AlbedoMean.R", "AlbedoMean.G", "AlbedoMean.B"), "--nrm": ("NormalMean.X", "NormalMean.Y", "NormalMean.Z")}


def write_pfm(path, pixels):
    height, width, _ = pixels.shape
    path.write_bytes(b"PF\n%d %d\n-1.0\n" % (width, height) + np.flipud(pixels).astype("<f4").tobytes())


def read_pfm(path):
    kind, size, scale, data = path.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    if kind != b"PF" or float(scale) >= 0:
        sys.exit(f"{path}: found {kind} {scale}, allowed: a little-endian RGB PFM")
    return np.flipud(np.frombuffer(data, "<f4", count=3 * width * height).reshape(height, width, 3))


def planes_of(frame):
    channels = OpenEXR.File(str(frame), separate_channels=True).channels()
    if any(name not in channels for name in "RGB"):
        sys.exit(f"{frame}: found {', '.join(channels)}, allowed: channels R, G, B")
    wanted = {"--hdr": ("R", "G", "B"), **GUIDES}
    return {flag: np.stack([channels[name].pixels for name in names], -1)
            for flag, names in wanted.items() if all(name in channels for name in names)}


def denoise(planes, quality, folder):
    command = [str(PACKAGE / "bin" / "oidnDenoise"), "-d", "cpu", "-q", quality, "-n", str(RUNS), "-o", str(folder / "out.pfm")]
    for flag, pixels in planes.items():
        file = folder / f"{flag.strip('-')}.pfm"
        write_pfm(file, pixels)
        command += [flag, str(file)]
    environment = {**os.environ, "LD_LIBRARY_PATH": str(PACKAGE / "lib")}
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    times = [float(ms) / 1000 for ms in re.findall(r"msec=([0-9.]+), hash", done.stdout)]
    if done.returncode != 0 or not times:
        sys.exit(f"oidnDenoise: {done.stdout}{done.stderr}")
    return read_pfm(folder / "out.pfm"), statistics.median(times)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("frame", type=pathlib.Path)
    parser.add_argument("output", type=pathlib.Path)
    parser.add_argument("--quality", choices=["high", "balanced", "fast"], default="high")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        pixels, seconds = denoise(planes_of(arguments.frame), arguments.quality, pathlib.Path(folder))
    channels = {name: np.ascontiguousarray(pixels[..., k]) for k, name in enumerate("RGB")}
    OpenEXR.File({"seconds": seconds}, channels).write(str(arguments.output))


if __name__ == "__main__":
    main()
