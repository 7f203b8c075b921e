# SPDX-License-Identifier: Apache-2.0
"""The viewer of a report against the EXR files of its run. Run by test_in_browser.py."""

import json
import math
import pathlib
import shutil

from report_reader import BAD, HEIGHT, ODD, PAGE, RUN, WIDTH, Reader, float32, same, srgb


class Viewer(Reader):
    def test_the_readout_is_the_float_in_the_file(self):
        for name, cell in (("cornell.nearest.f2", ODD), ("cornell_sphere.mean.f3.w5", "cornell_sphere.mean.f3.w5.s1")):
            self.open_report()
            self.look_at(name)
            image, reference = RUN.image(cell), RUN.reference(cell)
            for pane in ("test", "reference", "error"):
                for x, y in ((0, 0), (5, 0), (23, 15), (11, 9), *BAD):
                    PAGE.mouse("mouseMoved", *self.place(pane, x, y))
                    self.assertEqual(self.text("#viewer-readout-place"), f"x {x}, y {y}")
                    for row, file in (("test", image), ("reference", reference)):
                        for shown, stored in zip(self.readout(row), file.at(x, y)):
                            self.assertTrue(same(float32(shown), stored), f"{cell} {row} {x},{y}: {shown} is not {stored}")

    def test_pixels_that_are_no_numbers_are_counted_marked_and_found(self):
        self.look_at("cornell.nearest.f2")
        counts = self.text("#viewer-non-finite")
        for part in ("NaN: 1 in image", "+Inf: 1 in image", "−Inf: 1 in image"):
            self.assertIn(part, counts)
        self.assertNotIn("reference", counts)
        for place in [*BAD, list(BAD)[0]]:
            PAGE.key("n")
            self.assertEqual(self.text("#viewer-readout-place"), f"x {place[0]}, y {place[1]}")
        colours = {tuple(PAGE.value("""(() => { const c = panes.canvases.error; return [...c.getContext('2d')
            .getImageData(c.width / 2 + 1, c.height / 2 + 1, 1, 1).data]; })()""")) for _ in BAD if not PAGE.key("n") and not self.settle()}
        self.assertEqual(colours, {(255, 0, 255, 255), (0, 229, 255, 255), (0, 255, 0, 255)})

    def test_the_maps_are_those_of_the_metrics(self):
        self.look_at("cornell.mean.f2.w3")
        metrics = RUN.rows["cornell.mean.f2.w3.s1"]["metrics"]
        self.assertIn(f"({metrics['psnr_float_db']:.2f} dB)", self.text("#viewer-map-summary"))
        PAGE.click_on("[data-kind='ssim']")
        self.assertIn(f"mean ssim {metrics['ssim']:.4f}", self.text("#viewer-map-summary"))

    def test_errors_under_the_cursor_follow_their_formulas(self):
        cell = "cornell.mean.f2.w3.s1"
        self.look_at("cornell.mean.f2.w3")
        x, r = ([srgb(v) for v in file.at(4, 9)] for file in (RUN.image(cell), RUN.reference(cell)))
        expected = {"magnitude": math.sqrt(sum((a - b) ** 2 for a, b in zip(x, r)) / 3), "sign": sum(a - b for a, b in zip(x, r)) / 3}
        for kind, value in expected.items():
            PAGE.click_on(f"[data-kind='{kind}']")
            PAGE.mouse("mouseMoved", *self.place("error", 4, 9))
            shown = float(self.text("#viewer-readout-error").replace("−", "-"))
            self.assertAlmostEqual(shown, value, delta=1e-3 * abs(value) + 1e-6)

    def test_the_worst_pixel_is_the_worst(self):
        cell = "cornell_sphere.mean.f3.w5.s1"
        self.look_at("cornell_sphere.mean.f3.w5")
        image, reference = RUN.image(cell), RUN.reference(cell)

        def error(i):
            x, y = i % WIDTH, i // WIDTH
            return sum((srgb(a) - srgb(b)) ** 2 for a, b in zip(image.at(x, y), reference.at(x, y)))

        PAGE.key("x")
        x, y = (int(part.split()[1]) for part in self.text("#viewer-readout-place").split(","))
        self.assertAlmostEqual(error(y * WIDTH + x), max(map(error, range(WIDTH * HEIGHT))), delta=1e-6)

    def test_wheel_drag_and_pinch_move_all_panes_alike(self):
        self.look_at("cornell.mean.f2.w3")
        image, reference = RUN.image("cornell.mean.f2.w3.s1"), RUN.reference("cornell.mean.f2.w3.s1")
        before, at = self.scale(), self.place("test", 6, 4)
        for _ in range(4):
            PAGE.mouse("mouseWheel", *at, deltaX=0, deltaY=-150)
        self.assertGreater(self.scale(), 2 * before)
        PAGE.mouse("mouseMoved", *at)
        self.assertEqual(self.text("#viewer-readout-place"), "x 6, y 4")
        shift = self.box("reference")[0] - self.box("test")[0]
        PAGE.mouse("mouseMoved", at[0], at[1] + 3 * self.scale())
        self.assert_colour("test", at, image.at(6, 4))
        self.assert_colour("reference", (at[0] + shift, at[1]), reference.at(6, 4))
        end = (at[0] + 40, at[1] + 30)
        PAGE.drag(at, end)
        self.assertEqual(self.text("#viewer-readout-place"), "x 6, y 4")
        PAGE.key("f")
        self.assertEqual(self.scale(), before)
        left, top, width, height = self.box("error")
        middle = (left + width / 2, top + height / 2)
        PAGE.touch("touchStart", [(middle[0] - 30, middle[1]), (middle[0] + 30, middle[1])])
        PAGE.touch("touchMove", [(middle[0] - 60, middle[1]), (middle[0] + 60, middle[1])])
        PAGE.touch("touchEnd", [])
        self.assertAlmostEqual(self.scale() / before, 2, delta=0.2)

    def test_the_wipe_shows_the_image_on_its_left_and_the_reference_on_its_right(self):
        self.look_at("cornell.nearest.f2")
        image, reference = RUN.image(ODD), RUN.reference(ODD)
        PAGE.key("w")
        self.settle()
        left, top, width, height = self.box("test")
        for share in (0.8, 0.3):
            PAGE.drag(PAGE.middle("#viewer-wipe"), (left + share * width, top + height / 2))
            self.assertAlmostEqual(float(PAGE.value("document.getElementById('viewer-wipe').getAttribute('aria-valuenow')")), 100 * share, delta=1)
            at = self.place("test", 13, 8)
            PAGE.mouse("mouseMoved", *self.place("test", 13, 12))
            self.assert_colour("test", at, (image if share == 0.8 else reference).at(13, 8))
        PAGE.value("document.getElementById('viewer-wipe').focus()")
        PAGE.key("End")
        PAGE.wait_until("document.getElementById('viewer-wipe').getAttribute('aria-valuenow') === '100'")

    def test_keys_flip_between_methods_of_the_same_scene_and_factor_at_the_same_place(self):
        self.look_at("cornell_sphere.mean.f3.w5")
        PAGE.value("panes.goTo(8, 8)")
        scale = self.scale()
        for key, name in (("1", "path"), ("2", "nearest.f3"), ("4", "distance3d_normal.f3.w5"), ("3", "mean.f3.w5")):
            PAGE.key(key)
            self.wait_for_cell(f"cornell_sphere.{name}")
            self.assertEqual(self.scale(), scale)
            self.assertEqual(self.text("#viewer-readout-place"), "x 8, y 8")
            stored = RUN.image(f"cornell_sphere.{name}.s1").at(8, 8)
            self.assertEqual([float32(v) for v in self.readout("test")], stored)

    def test_0_shows_the_reference_in_the_image_s_place(self):
        self.look_at("cornell.nearest.f2")
        at = self.place("test", 13, 8)
        PAGE.key("0")
        self.assert_colour("test", at, RUN.reference(ODD).at(13, 8))
        PAGE.key("0")
        self.assert_colour("test", at, RUN.image(ODD).at(13, 8))

    def test_exposure_and_range_change_what_is_drawn(self):
        self.look_at("cornell.nearest.f2")
        at, error_at = self.place("test", 13, 8), self.place("error", 13, 8)
        PAGE.mouse("mouseMoved", *self.place("test", 2, 12))
        for _ in range(2):
            PAGE.key("e")
        self.assert_colour("test", at, RUN.image(ODD).at(13, 8), gain=2)
        dark = sum(self.colour("error", error_at))
        before = float(self.text("#viewer-range"))
        self.assertIn(f"{before:.0e}"[0], "125")
        self.assertEqual(self.text("#viewer-range"), f"{before:g}")
        for _ in range(3):
            PAGE.key("[")
        self.assertAlmostEqual(float(self.text("#viewer-range")), before / 10, delta=before / 1000)
        self.assertGreater(sum(self.colour("error", error_at)), dark)
        self.assertIn(f"≥ {before / 10:g}", self.text("#viewer-ticks"))

    def test_the_histogram_counts_every_pixel_that_has_an_error(self):
        self.look_at("cornell.nearest.f2")
        label = PAGE.value("document.getElementById('viewer-histogram').getAttribute('aria-label')")
        self.assertEqual(sum(int(word) for word in label.split() if word.isdigit()), WIDTH * HEIGHT - len(BAD))

    def test_the_address_brings_a_view_back(self):
        self.look_at("cornell_sphere.mean.f3.w5")
        PAGE.key("m")
        PAGE.key("w")
        PAGE.value("panes.goTo(8, 8)")
        scale = self.scale()
        PAGE.wait_until("location.hash.includes('at=') && location.hash.includes('map=sign&layout=wipe')")
        PAGE.wait_until(f"Math.abs(Number(new URLSearchParams(location.hash.slice(1)).get('at').split(',')[0]) - {scale}) < 0.01")
        address = PAGE.value("location.href")
        self.open_report()
        PAGE.open("about:blank")
        PAGE.open(address)
        self.wait_for_cell("cornell_sphere.mean.f3.w5")
        self.assertAlmostEqual(self.scale(), scale, delta=0.01)
        self.assertEqual(PAGE.value("panes.stage.dataset.layout"), "wipe")
        self.assertEqual(PAGE.value("document.querySelector('[data-kind=sign]').getAttribute('aria-pressed')"), "true")

    def test_arrows_step_through_the_cells_and_escape_closes(self):
        self.look_at("cornell.path")
        PAGE.key("ArrowRight")
        self.wait_for_cell(next(g["group"] for g in self.groups[1:] if "plane" in g))
        PAGE.key("Escape")
        PAGE.wait_until("!document.getElementById('viewer').open")

    def test_a_phone_shows_it_without_scrolling_sideways(self):
        self.open_report((400, 800))
        self.assertLessEqual(PAGE.value("document.documentElement.scrollWidth"), 400)
        self.look_at("cornell.nearest.f2")
        self.assertLessEqual(PAGE.value("document.getElementById('viewer').scrollWidth"), 400)
        x, y = self.place("test", 5, 0)
        PAGE.touch("touchStart", [(x, y)])
        PAGE.touch("touchEnd", [])
        self.assertEqual(self.text("#viewer-readout-place"), "x 5, y 0")
        self.assertEqual(float32(self.readout("test")[2]), float32(123456.789))


class Values(Reader):
    """Where the float values come from."""

    def test_without_the_files_beside_it_the_page_falls_back_on_its_pictures(self):
        alone = pathlib.Path(RUN.temp.name) / "alone" / "report.html"
        alone.parent.mkdir(exist_ok=True)
        shutil.copy(RUN.path / "report.html", alone)
        self.open_report(file=alone)
        self.look_at("cornell.mean.f2.w3")
        self.assertIn("8-bit", self.text("#viewer-precision"))
        PAGE.mouse("mouseMoved", *self.place("test", 4, 9))
        for shown, stored in zip(self.readout("test"), RUN.image("cornell.mean.f2.w3.s1").at(4, 9)):
            self.assertAlmostEqual(srgb(shown), srgb(stored), delta=0.51 / 255)
        PAGE.open("about:blank")  # by then all is said of the files that are not there
        self.assertTrue(all("ERR_FILE_NOT_FOUND" in error for error in PAGE.errors), PAGE.errors)
        PAGE.errors.clear()

    def test_embedded_values_are_as_exact_as_they_say(self):
        for precision, says, bound in (("float32", "float32", 0), ("float16", "float16 difference", 2**-11)):
            page = pathlib.Path(RUN.temp.name) / "embedded" / f"{precision}.html"
            page.parent.mkdir(exist_ok=True)
            RUN.report("--embed", "--embed-precision", precision, "-o", page)
            self.open_report(file=page)
            self.look_at("cornell.nearest.f2")
            self.assertIn(says, self.text("#viewer-precision"))
            for x, y in ((0, 0), (11, 9), (23, 15), *BAD):
                PAGE.mouse("mouseMoved", *self.place("error", x, y))
                stored, reference = RUN.image(ODD).at(x, y), RUN.reference(ODD).at(x, y)
                self.assertEqual([float32(v) for v in self.readout("reference")], reference)
                for shown, value, against in zip(self.readout("test"), stored, reference):
                    if math.isfinite(value):
                        self.assertAlmostEqual(shown, value, delta=bound * abs(value - against) + 2e-7 * abs(value))
                    else:
                        self.assertTrue(same(shown, value))

    def test_a_page_elsewhere_finds_the_values_of_its_run(self):
        page = pathlib.Path(RUN.temp.name) / "else where" / "page.html"
        page.parent.mkdir(exist_ok=True)
        RUN.report("-o", page)
        self.open_report(file=page)
        self.look_at("cornell.nearest.f2")
        self.assertEqual(self.text("#viewer-precision"), "float32")
