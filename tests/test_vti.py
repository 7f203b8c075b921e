# SPDX-License-Identifier: Apache-2.0
"""Reads the .vti files of `vecino compare` with VTK's own reader, as ParaView does.

Usage: test_vti.py VECINO SOURCE_DIR. Exits with 125, skipped, where VTK's Python modules are not installed.
"""

import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile

try:
    from vtkmodules.vtkCommonCore import vtkDataArray
    from vtkmodules.vtkIOXML import vtkXMLImageDataReader
except ImportError:
    print("skipped: VTK's Python modules (python3-vtk9) are not installed")
    sys.exit(125)

PROGRAM, SOURCE = sys.argv[1], pathlib.Path(sys.argv[2])
WIDTH, HEIGHT = 16, 12


def float_tiff(path, value):
    """Writes value(x, y, channel) as an RGB image of floats."""
    pixels = [value(x, y, c) for y in range(HEIGHT) for x in range(WIDTH) for c in range(3)]
    data = struct.pack(f"<{len(pixels)}f", *pixels)
    short, long = 3, 4
    extra = 8 + 2 + 11 * 12 + 4  # where what is longer than a tag begins
    tags = [
        (256, short, 1, WIDTH),
        (257, short, 1, HEIGHT),
        (258, short, 3, extra),
        (259, short, 1, 1),
        (262, short, 1, 2),
        (273, long, 1, extra + 12),
        (277, short, 1, 3),
        (278, short, 1, HEIGHT),
        (279, long, 1, len(data)),
        (284, short, 1, 1),
        (339, short, 3, extra + 6),
    ]
    head = b"II*\0" + struct.pack("<IH", 8, len(tags))
    head += b"".join(struct.pack("<HHII", *tag) for tag in tags) + struct.pack("<I", 0)
    path.write_bytes(head + struct.pack("<6H", 32, 32, 32, 3, 3, 3) + data)


def run(*arguments, expect=0):
    result = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    assert result.returncode == expect, (arguments, result.returncode, result.stderr)
    return result


def read(path):
    reader = vtkXMLImageDataReader()
    reader.SetFileName(str(path))
    assert reader.CanReadFile(str(path)) == 1
    reader.Update()
    assert reader.GetErrorCode() == 0
    image = reader.GetOutput()
    assert image.GetDimensions() == (WIDTH, HEIGHT, 1)
    assert image.GetSpacing() == (1, 1, 1) and image.GetOrigin() == (0, 0, 0)
    return image


def at(image, array, x, y, component=0):
    """The value of a pixel, counted from the top: VTK's y goes up."""
    point = image.FindPoint(x, HEIGHT - 1 - y, 0)
    return image.GetPointData().GetArray(array).GetComponent(point, component)


def single(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def test_values(folder):
    def reference(x, y, c):
        return 0.01 * x + 0.05 * y + 0.002 * c

    def tested(x, y, c):
        if (x, y, c) == (3, 1, 2):
            return math.nan
        if (x, y, c) == (9, 11, 0):
            return -math.inf
        return reference(x, y, c) + 0.001 * (x + 1)

    float_tiff(folder / "test.tif", tested)
    float_tiff(folder / "reference.tif", reference)
    run("compare", folder / "test.tif", folder / "reference.tif", "--error-map", folder / "a.vti", expect=5)
    image = read(folder / "a.vti")
    for y in range(HEIGHT):
        for x in range(WIDTH):
            for c in range(3):
                found, wanted = at(image, "test", x, y, c), single(tested(x, y, c))
                assert found == wanted or (math.isnan(found) and math.isnan(wanted)), (x, y, c, found, wanted)
                assert at(image, "reference", x, y, c) == single(reference(x, y, c))
    assert math.isnan(at(image, "error_magnitude", 3, 1)) and math.isnan(at(image, "error", 3, 1, 2))
    assert at(image, "error", 9, 11, 0) == -math.inf
    assert abs(at(image, "absolute_error", 5, 7) - 0.006) < 1e-6
    points = image.GetPointData()
    assert points.GetScalars().GetName() == "error_magnitude"
    test = points.GetArray("test")
    assert [test.GetComponentName(c) for c in range(3)] == ["R", "G", "B"]
    assert test.GetInformation().Get(vtkDataArray.UNITS_LABEL()).strip() == "linear radiance"


def test_planes(folder):
    scene = SOURCE / "scenes/cornell_sphere.json"
    for name, seed in (("test", 1), ("reference", 2)):
        run("render", scene, "-o", folder / f"{name}.exr", "--size", f"{WIDTH}x{HEIGHT}", "--spp", 16, "--seed", seed)
    out = run("compare", folder / "test.exr", folder / "reference.exr", "--error-map", folder / "b.vti", "--json")
    image = read(folder / "b.vti")
    points = image.GetPointData()
    names = {points.GetArrayName(i) for i in range(points.GetNumberOfArrays())}
    planes = ("direct", "indirect", "emission", "albedo", "position", "normal", "distance", "id", "count", "variance")
    wanted = {f"{whose}_{plane}" for whose in ("test", "reference") for plane in planes}
    assert wanted | {"test", "reference", "error", "error_signed", "relative_squared_error", "ssim", "region"} <= names
    assert points.GetArray("test_count").GetRange() == (16, 16)
    # The lamp is on top, seen by the first rows; the floor at the bottom.
    assert at(image, "test_position", 8, 0, 1) > 1 > at(image, "test_position", 8, HEIGHT - 1, 1)
    assert 0 < at(image, "test_distance", 8, 6) < 6
    fields = image.GetFieldData()
    metrics = json.loads(out.stdout)
    assert fields.GetArray("relmse").GetValue(0) == metrics["relmse"]
    assert fields.GetArray("psnr_float_db").GetValue(0) == metrics["psnr_float_db"]
    definitions = fields.GetAbstractArray("definitions")
    lines = [definitions.GetValue(i) for i in range(definitions.GetNumberOfValues())]
    assert len(lines) == points.GetNumberOfArrays()
    assert any(line.startswith("test_distance [scene units]: ") for line in lines)


def main():
    with tempfile.TemporaryDirectory() as name:
        test_values(pathlib.Path(name))
        test_planes(pathlib.Path(name))
    print("VTK reads every array, value and name")


main()
