// SPDX-License-Identifier: Apache-2.0
//
// Beside the viewer's panes: what the colours of the error map stand for, how its values are spread, and the values of the
// pixel under the cursor.
"use strict";

const legend = (() => {
    const part = (name) => document.getElementById(`viewer-${name}`);
    const titles = {
        magnitude: "magnitude: √(mean over channels of (x − r)²), display value",
        sign: "signed: mean over channels of (x − r), display value",
        ssim: "1 − ssim, mean over channels",
    };
    const bins = 64;

    /// The fewest digits that stand for the same float32.
    function floatText(value) {
        if (Number.isNaN(value)) return "NaN";
        if (!Number.isFinite(value)) return value > 0 ? "+Inf" : "−Inf";
        let text = "";
        for (let digits = 6; digits <= 9; ++digits) {
            text = value.toPrecision(digits);
            if (Math.fround(Number(text)) === value) break;
        }
        return String(Number(text)).replaceAll("-", "−");
    }

    const shortText = (value) => String(Number(value.toPrecision(4))).replaceAll("-", "−");

    /// Counts of a map's values over its range; first and last bin hold what lies beyond, too.
    function histogram(map, range) {
        const low = map.kind === "sign" ? -range : 0;
        const counts = new Uint32Array(bins);
        let beyond = 0;
        for (const value of map.values) {
            if (Number.isNaN(value)) continue;
            if (Math.abs(value) > range) ++beyond;
            ++counts[Math.min(bins - 1, Math.max(0, Math.floor(((value - low) / (range - low)) * bins)))];
        }
        return { counts, beyond, low };
    }

    function drawHistogram(map, range, { counts, low }) {
        const canvas = part("histogram");
        const ratio = window.devicePixelRatio || 1;
        [canvas.width, canvas.height] = [canvas.clientWidth, canvas.clientHeight].map((n) => Math.round(n * ratio));
        const context = canvas.getContext("2d");
        const bar = Math.round(12 * ratio);
        const room = canvas.height - bar - 2 * ratio;
        const most = Math.log1p(Math.max(...counts, 1));
        context.fillStyle = charts.colour("--soft");
        counts.forEach((count, i) => {
            const [x, next] = [i, i + 1].map((n) => Math.round((n * canvas.width) / bins));
            const height = Math.round((room * Math.log1p(count)) / most);
            context.fillRect(x, room - height, Math.max(1, next - x - 1), height);
        });
        for (let x = 0; x < canvas.width; ++x) {
            const value = low + ((range - low) * (x + 0.5)) / canvas.width;
            context.fillStyle = panes.cssColour(map.kind, value, range);
            context.fillRect(x, canvas.height - bar, 1, bar);
        }
        canvas.setAttribute("aria-label", `histogram over the colour bar, counts ${[...counts].join(" ")}`);
    }

    function summary(map, beyond) {
        if (map.n === 0) return "no pixel has a value";
        const means = {
            magnitude: () => `root mean square ${shortText(Math.sqrt(map.meanSquare))} (${(-10 * Math.log10(map.meanSquare)).toFixed(2)} dB)`,
            sign: () => `mean ${shortText(map.mean)}`,
            ssim: () => `mean ssim ${(1 - map.mean).toFixed(4)}`,
        };
        return `${means[map.kind]()}; 99 % within ${shortText(map.p99)}; ${((100 * beyond) / map.n).toFixed(2)} % beyond the range`;
    }

    /// Colour bar with histogram and numbers, of an error map in a range.
    function show(map, range) {
        const spread = histogram(map, range);
        part("map-title").textContent = titles[map.kind];
        drawHistogram(map, range, spread);
        const ends = map.kind === "sign" ? [`≤ −${shortText(range)}`, "0", `≥ +${shortText(range)}`]
            : ["0", shortText(range / 2), `≥ ${shortText(range)}`];
        all("span", part("ticks")).forEach((tick, i) => { tick.textContent = ends[i]; });
        part("map-summary").textContent = summary(map, spread.beyond);
    }

    /// Counts of pixels that are no numbers, by kind and image; nothing if all are.
    function showNonFinite(test, reference) {
        const counted = [["image", test], ["reference", reference]].flatMap(([name, plane]) =>
            [1, 2, 3].map((kind) => [name, kind, [...plane.nonFinite.values()].filter((k) => k === kind).length]));
        const swatch = (kind) => {
            const mark = document.createElement("i");
            mark.style.background = `rgb(${panes.markColours[kind].join(" ")})`;
            return mark;
        };
        const items = counted.filter(([, , count]) => count > 0).map(([name, kind, count]) => {
            const item = document.createElement("span");
            item.append(swatch(kind), `${errors.kinds[kind]}: ${count} in ${name}`);
            return item;
        });
        part("non-finite").replaceChildren(...items);
        part("non-finite").hidden = items.length === 0;
    }

    function fill(row, values) {
        const cells = part("readout").querySelector(`[data-row="${row}"]`).cells;
        values.forEach((text, i) => { cells[i + 1].textContent = text; });
    }

    /// The float values of a pixel in every image, and its error; dashes without a pixel.
    function read(pixel, { test, reference, map }) {
        const at = pixel ? 3 * (pixel.y * test.width + pixel.x) : -1;
        const values = (plane) => [0, 1, 2].map((c) => plane.values[at + c]);
        const none = ["–", "–", "–"];
        fill("test", pixel ? values(test).map(floatText) : none);
        fill("reference", pixel ? values(reference).map(floatText) : none);
        const differences = pixel ? values(test).map((v, c) => Math.fround(v - values(reference)[c])) : [];
        fill("difference", pixel ? differences.map(floatText) : none);
        const error = pixel ? map.values[at / 3] : NaN;
        const texts = { magnitude: shortText, sign: shortText, ssim: (v) => `ssim ${shortText(1 - v)}` };
        part("readout-error").textContent = Number.isNaN(error) ? "–" : texts[map.kind](error);
        part("readout-place").textContent = pixel ? `x ${pixel.x}, y ${pixel.y}` : "no pixel";
    }

    return { show, showNonFinite, read, floatText };
})();
