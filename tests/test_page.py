# SPDX-License-Identifier: Apache-2.0
"""Charts, matrix and table of a report against the numbers of its run. Run by test_in_browser.py."""

import json

from report_reader import PAGE, Reader


class Charts(Reader):
    def points(self, canvas):
        """Group, place on the screen and tone of every point of a chart, brought into sight."""
        PAGE.middle(canvas)
        self.settle()
        return PAGE.value(f"""(() => {{
            const canvas = document.querySelector({json.dumps(canvas)});
            const [chart, box] = [Chart.getChart(canvas), canvas.getBoundingClientRect()];
            return chart.data.datasets.flatMap((set, i) => set.data.map((p, j) => {{
                const {{ x, y }} = chart.getDatasetMeta(i).data[j];
                return {{ group: p.group.group, x: x + box.x, y: y + box.y, tone: set.backgroundColor[j] }};
            }})); }})()""")

    def alone(self, points):
        """A point that no other one lies near."""
        return next(p for p in points if all(q is p or abs(p["x"] - q["x"]) + abs(p["y"] - q["y"]) > 25 for q in points))

    def test_hover_tells_the_parameters(self):
        canvas = "canvas[data-scene='cornell'][data-part='whole']"
        point = self.alone(self.points(canvas))
        PAGE.mouse("mouseMoved", point["x"] - 40, point["y"] - 40)
        PAGE.mouse("mouseMoved", point["x"], point["y"])
        tooltip = f"Chart.getChart(document.querySelector({json.dumps(canvas)})).tooltip"
        PAGE.wait_until(f"{tooltip}.opacity > 0")
        lines = " ".join(PAGE.value(f"{tooltip}.body.flatMap((part) => part.lines)"))
        group = self.group(point["group"])
        self.assertIn(f"{group['method']}: {group['parameters']}", lines)
        self.assertIn(f"{group['psnr_float_db']['mean']:.2f} dB", lines)

    def test_click_opens_the_cell(self):
        point = self.alone(self.points("canvas[data-scene='cornell_sphere'][data-part='whole']"))
        PAGE.click(point["x"], point["y"])
        self.wait_for_cell(point["group"])
        self.assertEqual(self.text("#viewer-name"), point["group"])

    def test_points_that_another_one_beats_in_both_are_faint(self):
        for scene in ("cornell", "cornell_sphere"):
            own = [g for g in self.groups if g["scene"] == scene and g["time_s"] > 0 and g["psnr_float_db"]]
            points = {p["group"]: p for p in self.points(f"canvas[data-scene='{scene}'][data-part='whole']")}
            self.assertEqual(set(points), {g["group"] for g in own})
            score = {g["group"]: (-g["time_s"], g["psnr_float_db"]["mean"]) for g in own}
            for name, (speed, accuracy) in score.items():
                beaten = any(s >= speed and a >= accuracy and (s, a) != (speed, accuracy) for s, a in score.values())
                self.assertEqual(len(points[name]["tone"]) == 9, beaten, name)  # #rrggbbaa

    def test_a_hidden_method_beats_nobody(self):
        PAGE.click_on("#chart .legend [data-method='nearest']")
        self.settle()
        tones = {p["group"]: p["tone"] for p in self.points("canvas[data-scene='cornell'][data-part='whole']")}
        shown = {g["group"]: g for g in self.groups if g["scene"] == "cornell" and g["method"] != "nearest" and g["time_s"] > 0}
        best = max(shown.values(), key=lambda g: g["psnr_float_db"]["mean"])
        fastest = min(shown.values(), key=lambda g: g["time_s"])
        for group in (best, fastest):
            self.assertEqual(len(tones[group["group"]]), 7, group["group"])


class Matrix(Reader):
    def choose(self, selector, label):
        """As a click into the list would."""
        PAGE.value(f"""(() => {{ const list = document.querySelector({json.dumps(selector)});
            list.value = [...list.options].find((o) => o.label.startsWith({json.dumps(label)})).value;
            list.dispatchEvent(new Event("change")); }})()""")

    def fields(self):
        return PAGE.value("""[...document.querySelectorAll("#matrix-table button")].map((b) =>
            ({ text: b.firstChild.textContent, title: b.title, background: b.style.background, ink: b.style.color }))""")

    def best(self, scene, method, value, key=max):
        found = [g for g in self.groups if (g["scene"], g["method"]) == (scene, method) and g["params"].get("reduction") in (None, 2)]
        return key(found, key=value)

    def test_every_field_holds_the_number_of_the_best_cell_that_is_left(self):
        for label, value, digits, key in (
            ("psnr_float_db, dB", lambda g: g["psnr_float_db"]["mean"], 2, max),
            ("ssim", lambda g: g["ssim"]["mean"], 4, max),
            ("psnr_float_db, edge", lambda g: g["regions"]["edge"]["mean"], 2, max),
        ):
            self.choose("#matrix-metric", label)
            fields = {f["title"].split(":")[0]: f for f in self.fields()}
            for scene in ("cornell", "cornell_sphere"):
                for method in ("path", "mean", "distance3d_normal"):
                    group = self.best(scene, method, value, key)
                    self.assertEqual(fields[group["group"]]["text"], f"{value(group):.{digits}f}")

    def test_lightness_rises_with_what_is_better(self):
        def lightness(colour):
            r, g, b = (float(v) for v in colour.removeprefix("rgb(").removesuffix(")").split(","))
            return 0.2126 * r + 0.7152 * g + 0.0722 * b

        for label, sign in (("psnr_float_db, dB", 1), ("relmse", -1)):
            self.choose("#matrix-metric", label)
            order = sorted(self.fields(), key=lambda f: sign * float(f["text"]))
            shades = [lightness(f["background"]) for f in order]
            self.assertGreater(shades[-1] - shades[0], 100)
            self.assertTrue(all(b >= a - 1 for a, b in zip(shades, shades[1:])), shades)

    def test_choices_leave_the_cells_that_they_name(self):
        self.choose("[data-name='reduction']", "3")
        self.choose("[data-name='window']", "5")
        titles = " ".join(f["title"] for f in self.fields())
        self.assertIn("cornell.mean.f3.w5:", titles)
        self.assertIn("cornell.nearest.f3:", titles)
        self.assertIn("cornell.path:", titles)
        self.assertNotIn(".f2", titles)
        self.assertNotIn(".w3", titles)

    def test_click_opens_the_cell(self):
        self.choose("[data-name='window']", "3")
        PAGE.click_on("#matrix-table button[title^='cornell_sphere.mean.f2.w3:']")
        self.wait_for_cell("cornell_sphere.mean.f2.w3")


class Table(Reader):
    def column(self, index):
        return PAGE.value(f"""[...document.querySelectorAll("#results-table tbody tr:not([hidden])")].map((row) =>
            row.cells[{index}].dataset.value ?? row.cells[{index}].textContent)""")

    def header(self, name):
        names = PAGE.value("[...document.querySelectorAll('#results-table .name')].map((n) => n.textContent)")
        return names.index(name)

    def test_a_click_on_a_heading_sorts_and_says_so(self):
        at = self.header("psnr_float_db")
        heading = f"#results-table th:nth-child({at + 1})"
        before = self.column(at)
        for expected in ("descending", "ascending", None):
            PAGE.click_on(f"{heading} button")
            self.assertEqual(PAGE.value(f"document.querySelector('{heading}').getAttribute('aria-sort')"), expected)
            values = [float(v) for v in self.column(at)]
            order = sorted(values, reverse=expected == "descending") if expected else [float(v) for v in before]
            self.assertEqual(values, order)

    def test_a_heading_sorts_from_the_keyboard(self):
        at = self.header("time")
        PAGE.value(f"document.querySelectorAll('#results-table th button')[{at}].focus()")
        PAGE.key("Enter")
        values = [float(v) for v in self.column(at) if v != "–"]
        self.assertEqual(values, sorted(values))

    def write(self, text):
        PAGE.value("(() => { const f = document.getElementById('table-filter'); f.value = ''; f.focus(); })()")
        for character in text:
            PAGE.key(character)

    def test_the_filter_takes_words_and_regular_expressions(self):
        names = [g["group"] for g in self.groups]
        for text, fits in (
            ("sphere w3", lambda n: "sphere" in n and "w3" in n),
            ("/mean.f[3]/", lambda n: ".mean.f3" in n),
            ("/^cornell.path", lambda n: n == "cornell.path"),
            ("nothing like it", lambda n: False),
        ):
            self.write(text)
            expected = sum(map(fits, names))
            self.assertEqual(len(self.column(0)), expected, text)
            self.assertEqual(self.text("#table-count"), f"{expected} of {len(names)} rows")

    def test_half_a_regular_expression_changes_nothing(self):
        self.write("mean")
        before = self.column(1)
        PAGE.value("document.getElementById('table-filter').value = ''")
        self.write("/mean(/")
        self.assertIn("not a regular expression", self.text("#table-count"))
        self.assertEqual(PAGE.value("document.getElementById('table-filter').getAttribute('aria-invalid')"), "true")
        self.assertGreaterEqual(len(self.column(1)), len(before))
