# SPDX-License-Identifier: Apache-2.0
"""A small run, its report open in a browser, and what a reader of it does: for tests that hold the page against the run's files.
start() comes before the tests are imported."""

import array
import json
import math
import pathlib
import struct
import subprocess
import tempfile
import unittest

import exr
from browser import Browser

WIDTH, HEIGHT = 24, 16
ODD = "cornell.nearest.f2.s1"  # its image is written by the test
NAN, INF = math.nan, math.inf
PAGE, RUN = None, None  # made by start()
BAD = {(3, 2): (NAN, 1, 1), (20, 5): (0.5, INF, 0.5), (7, 14): (-INF, 0, 0)}


def float32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def same(a, b):
    return math.isnan(a) and math.isnan(b) or a == b


def srgb(value):
    value = min(1, max(0, value))
    return 12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055


class Run:
    """A small run; the image of one cell holds values that are hard to show."""

    def __init__(self, program, source):
        self.program = program
        self.temp = tempfile.TemporaryDirectory(prefix="vecino-viewer-")
        self.path = pathlib.Path(self.temp.name) / "run"
        matrix = {
            "name": "viewer",
            "axes": {"scene": [str(source / "scenes/cornell.json"), str(source / "scenes/cornell_sphere.json")],
                     "scheme": ["nearest", "mean", "distance3d_normal"], "reduction": [2, 3], "window": [3, 5], "seed": [1, 2]},
            "fixed": {"size": [WIDTH, HEIGHT], "spp": 8},
            "reference": {"spp": 64, "seed": 1000},
        }
        config = pathlib.Path(self.temp.name) / "matrix.json"
        config.write_text(json.dumps(matrix))
        subprocess.run([program, "run", config, "-o", self.path], check=True, capture_output=True)
        lines = (self.path / "results.jsonl").read_text().splitlines()
        self.rows = {row["cell"]: row for row in map(json.loads, lines)}
        self.write_odd_image()
        self.report()

    def write_odd_image(self):
        values = [[float32(0.37 * math.sin(0.7 * i + c) + 0.4) for i in range(WIDTH * HEIGHT)] for c in range(3)]
        values[0][5], values[1][5], values[2][5] = 1e-40, -2.5, 123456.789
        for (x, y), colour in BAD.items():
            for c in range(3):
                values[c][y * WIDTH + x] = colour[c]
        planes = {name: array.array("f", plane) for name, plane in zip("RGB", values)}
        exr.write(self.path / "cells" / ODD / "image.exr", WIDTH, HEIGHT, planes)

    def report(self, *options):
        subprocess.run([self.program, "report", self.path, *options], check=True, capture_output=True)

    def image(self, cell):
        return Image(self.path / "cells" / cell / "image.exr")

    def reference(self, cell):
        return Image(self.path / (self.rows[cell]["reference_file"] + ".exr"))


class Image:
    def __init__(self, path):
        self.width, self.height, self.planes = exr.read(path)

    def at(self, x, y):
        return [self.planes[c][y * self.width + x] for c in "RGB"]


class Reader(unittest.TestCase):
    """A test with a fresh page of the run's report."""

    def setUp(self):
        self.open_report()

    def tearDown(self):
        self.assertEqual(PAGE.errors, [])

    def open_report(self, size=(1280, 800), file=None):
        PAGE.errors.clear()
        PAGE.resize(*size)
        PAGE.open((file or RUN.path / "report.html").as_uri())
        self.groups = json.loads(PAGE.value("document.getElementById('report-data').textContent"))["groups"]

    def group(self, name):
        return next(g for g in self.groups if g["group"] == name)

    def text(self, selector):
        return PAGE.value(f"document.querySelector({json.dumps(selector)}).textContent")

    def wait_for_cell(self, name):
        PAGE.wait_until(f"viewer && document.getElementById('viewer').dataset.shown === {json.dumps(name)} && "
                        "document.getElementById('viewer').getAttribute('aria-busy') === 'false'")

    def look_at(self, name):
        """Opens a group by a click on its card's picture."""
        PAGE.click_on(f"#{self.group(name)['id']} .shot[data-view='1']")
        self.wait_for_cell(name)

    def settle(self):
        PAGE.wait_until("true")
        PAGE.wait_until("true")

    def box(self, pane):
        return PAGE.value(f"""(() => {{ const b = panes.canvases.{pane}.getBoundingClientRect();
            return [b.x, b.y, b.width, b.height]; }})()""")

    def scale(self):
        self.settle()
        return float(PAGE.value("panes.stage.dataset.scale"))

    def place(self, pane, x, y):
        """Where a pixel's centre stands on the screen while the whole image is in sight."""
        left, top, width, height = self.box(pane)
        scale = self.scale()
        return left + width / 2 + (x + 0.5 - WIDTH / 2) * scale, top + height / 2 + (y + 0.5 - HEIGHT / 2) * scale

    def readout(self, row):
        texts = PAGE.value(f"[...document.querySelector('#viewer-readout [data-row={row}]').cells].slice(1).map((c) => c.textContent)")
        return [float(text.replace("−", "-")) for text in texts]

    def colour(self, pane, screen):
        """What is drawn at a place of the screen."""
        left, top, *_ = self.box(pane)
        self.settle()
        return PAGE.value(f"[...panes.canvases.{pane}.getContext('2d').getImageData({screen[0] - left}, {screen[1] - top}, 1, 1).data].slice(0, 3)")

    def assert_colour(self, pane, screen, values, gain=1):
        for drawn, value in zip(self.colour(pane, screen), values):
            self.assertAlmostEqual(drawn, 255 * srgb(gain * value), delta=2)


def start(program, source):
    """Opens the browser and makes the run. Throws NoBrowser where there is none."""
    global PAGE, RUN
    PAGE = Browser()
    RUN = Run(program, pathlib.Path(source))
    return PAGE
