// SPDX-License-Identifier: Apache-2.0
//
// Errors of one image against another, from their float values, by the formulas of the program: magnitude and signed as
// its error maps have them, ssim as its metric has it.
"use strict";

const errors = (() => {
    /// What a pixel that is no number is; one of several kinds counts as the first of them.
    const kinds = [null, "NaN", "+Inf", "−Inf"];
    const ssimSide = 11;
    const ssimBorder = 5;
    const [c1, c2] = [(0.01 * 255) ** 2, (0.03 * 255) ** 2];

    /// Clipped to [0, 1] and sRGB-encoded. NaN stays so.
    function encode(value) {
        const v = Math.min(1, Math.max(0, value));
        return v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055;
    }

    function decode(value) {
        return value <= 0.04045 ? value / 12.92 : ((value + 0.055) / 1.055) ** 2.4;
    }

    function kindOf(r, g, b) {
        if (Number.isFinite(r) && Number.isFinite(g) && Number.isFinite(b)) return 0;
        if (Number.isNaN(r) || Number.isNaN(g) || Number.isNaN(b)) return 1;
        return r === Infinity || g === Infinity || b === Infinity ? 2 : 3;
    }

    /// The pixels that are no numbers: a kind per index, in order.
    function nonFinite(plane) {
        const found = new Map();
        const v = plane.values;
        for (let i = 0; i < v.length; i += 3) {
            const kind = kindOf(v[i], v[i + 1], v[i + 2]);
            if (kind > 0) found.set(i / 3, kind);
        }
        return found;
    }

    const displays = []; // of the planes used last: an image and its reference

    /// Display values of a plane.
    function display(plane) {
        let found = displays.find((each) => each.plane === plane);
        if (found) displays.splice(displays.indexOf(found), 1);
        else found = { plane, values: plane.values.map((v) => (Number.isFinite(v) ? encode(v) : v)) };
        displays.push(found);
        if (displays.length > 2) displays.shift();
        return found.values;
    }

    const differences = {
        magnitude: (r, g, b) => Math.sqrt((r * r + g * g + b * b) / 3),
        sign: (r, g, b) => (r + g + b) / 3,
    };

    function perPixel(test, reference, of) {
        const [x, y] = [display(test), display(reference)];
        const values = new Float32Array(x.length / 3);
        for (let i = 0; i < values.length; ++i) {
            const [r, g, b] = [3 * i, 3 * i + 1, 3 * i + 2];
            const error = of(x[r] - y[r], x[g] - y[g], x[b] - y[b]);
            values[i] = Number.isFinite(error) ? error : NaN;
        }
        return values;
    }

    const gaussian = (() => {
        const weights = Array.from({ length: ssimSide }, (_, i) => Math.exp(-((i - ssimBorder) ** 2) / (2 * 1.5 ** 2)));
        const sum = weights.reduce((a, b) => a + b);
        return Float64Array.from(weights, (w) => w / sum);
    })();

    /// Weighted sums along one axis, of whole windows alone.
    function blur(values, [width, height], isAcross) {
        const size = isAcross ? [width - 2 * ssimBorder, height] : [width, height - 2 * ssimBorder];
        const stride = isAcross ? 1 : width;
        const out = new Float64Array(size[0] * size[1]);
        for (let y = 0; y < size[1]; ++y) {
            for (let x = 0; x < size[0]; ++x) {
                let sum = 0;
                for (let k = 0, at = y * width + x; k < ssimSide; ++k, at += stride) sum += gaussian[k] * values[at];
                out[y * size[0] + x] = sum;
            }
        }
        return { values: out, size };
    }

    /// 8-bit values of one channel.
    function channel(display, c) {
        const values = new Float64Array(display.length / 3);
        for (let i = 0, at = c; i < values.length; ++i, at += 3) values[i] = Math.round(255 * display[at]);
        return values;
    }

    function product(a, b) {
        const values = new Float64Array(a.length);
        for (let i = 0; i < values.length; ++i) values[i] = a[i] * b[i];
        return values;
    }

    function localMean(values, size) {
        const across = blur(values, size, true);
        return blur(across.values, across.size, false).values;
    }

    /// ssim of one channel of 8-bit values, without the border.
    function ssimChannel(x, y, size) {
        const [meanX, meanY] = [localMean(x, size), localMean(y, size)];
        const [xx, yy, xy] = [product(x, x), product(y, y), product(x, y)].map((p) => localMean(p, size));
        for (let i = 0; i < xy.length; ++i) {
            const [mx, my] = [meanX[i], meanY[i]];
            const squares = mx * mx + my * my;
            xy[i] = ((2 * mx * my + c1) * (2 * (xy[i] - mx * my) + c2)) / ((squares + c1) * (xx[i] + yy[i] - squares + c2));
        }
        return xy;
    }

    /// 1 − ssim of each pixel, mean over channels; none in the border of 5 that ssim crops, nor where a window holds a
    /// value that is no number.
    function ssim(test, reference) {
        const { width, height } = test;
        const values = new Float32Array(width * height).fill(NaN);
        if (Math.min(width, height) < ssimSide) return values;
        const [x, y] = [test, reference].map(display);
        const maps = [0, 1, 2].map((c) => ssimChannel(channel(x, c), channel(y, c), [width, height]));
        const inner = width - 2 * ssimBorder;
        for (let i = 0; i < maps[0].length; ++i) {
            const at = (Math.floor(i / inner) + ssimBorder) * width + (i % inner) + ssimBorder;
            const mean = (maps[0][i] + maps[1][i] + maps[2][i]) / 3;
            values[at] = Number.isFinite(mean) ? 1 - mean : NaN;
        }
        return values;
    }

    /// Over the pixels that have a value: their number, mean, mean square, 99th percentile of the size, and the worst.
    function statistics(values) {
        const sizes = values.filter((v) => !Number.isNaN(v)).map(Math.abs).sort();
        let [sum, squares, worst] = [0, 0, -1];
        for (let i = 0; i < values.length; ++i) {
            if (Number.isNaN(values[i])) continue;
            sum += values[i];
            squares += values[i] * values[i];
            if (worst < 0 || Math.abs(values[i]) > Math.abs(values[worst])) worst = i;
        }
        const n = sizes.length;
        return { n, mean: sum / n, meanSquare: squares / n, p99: n ? sizes[Math.ceil(0.99 * n) - 1] : 0, worst };
    }

    /// A map of one kind: "magnitude", "sign" or "ssim" (which is 1 − ssim, so that 0 is no error).
    function map(test, reference, kind) {
        const values = kind === "ssim" ? ssim(test, reference) : perPixel(test, reference, differences[kind]);
        return { kind, values, width: test.width, height: test.height, ...statistics(values) };
    }

    /// The least of 1, 2, 5 times a power of ten, from 0.001 on, that is not below a value.
    function roundUp(value) {
        for (let exponent = -3; exponent < 38; ++exponent) {
            for (const digit of [1, 2, 5]) {
                const candidate = Number(`${digit}e${exponent}`);
                if (Math.fround(candidate) >= Math.fround(value)) return candidate;
            }
        }
        return 1e38;
    }

    return { map, nonFinite, kinds, kindOf, encode, decode, roundUp };
})();
