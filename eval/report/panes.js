// SPDX-License-Identifier: Apache-2.0
//
// The panes of the viewer: image, reference and error map, all at the same place in the same scale, with the pixel under the
// cursor and the pixels that are no numbers marked in each; and a wipe between the first two.
"use strict";

const panes = (() => {
    const stage = document.getElementById("viewer-stage");
    const canvases = Object.fromEntries(all(".pane", stage).map((pane) => [pane.dataset.pane, pane.querySelector("canvas")]));
    const handle = document.getElementById("viewer-wipe");
    const markColours = [null, [255, 0, 255], [0, 229, 255], [0, 255, 0]]; // by errors.kinds; none is near a map
    const letters = [null, "NaN", "+Inf", "−Inf"];
    const mostMarks = 400; // drawn per pane
    const largest = 128; // screen pixels per pixel
    let images = {}; // by pane: {raster, marks}
    let size = [0, 0];
    let view = { scale: 0, x: 0, y: 0 }; // scale 0: what fits; x, y: the point of the image in the middle
    let cursor = null;
    let wipe = 0.5;
    let cursorMoved = () => {};
    let viewMoved = () => {};
    let isDue = false;

    // ---- From values to colours -----------------------------------------------------------------------------------------------

    const encoded = Uint8Array.from({ length: 16385 }, (_, i) => Math.round(255 * errors.encode(i / 16384)));

    function colourTable(hex) {
        return Uint8Array.from({ length: hex.length / 2 }, (_, i) => parseInt(hex.slice(2 * i, 2 * i + 2), 16));
    }
    const tables = { magnitude: colourTable(report.viewer.colours.magnitude), sign: colourTable(report.viewer.colours.sign) };
    const tableOf = (kind) => (kind === "sign" ? tables.sign : tables.magnitude);

    function raster({ width, height, nonFinite }, fill) {
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [width, height];
        const data = new ImageData(width, height);
        fill(data.data);
        for (const [i, kind] of nonFinite) data.data.set([...markColours[kind], 255], 4 * i);
        canvas.getContext("2d").putImageData(data, 0, 0);
        return { raster: canvas, marks: nonFinite };
    }

    /// An image as a screen shows it, exposure in stops.
    function picture(plane, exposure) {
        const gain = 16384 * 2 ** exposure;
        return raster(plane, (data) => {
            for (let pixel = 0; pixel < data.length / 4; ++pixel) {
                for (let c = 0; c < 3; ++c) {
                    const level = Math.round(plane.values[3 * pixel + c] * gain);
                    data[4 * pixel + c] = encoded[Math.min(16384, Math.max(0, level))];
                }
                data[4 * pixel + 3] = 255;
            }
        });
    }

    /// Entry of a colour table for a value; what lies beyond the range has the colour of the end.
    function entry(kind, value, range) {
        const t = Math.min(1, Math.max(-1, value / range));
        return kind === "sign" ? 256 + Math.round(256 * t) : Math.round(255 * Math.max(0, t));
    }

    /// An error map; a pixel without value has the colour of the page, if it is not one that is no number.
    function heat(map, range, nonFinite) {
        const table = tableOf(map.kind);
        return raster({ ...map, nonFinite }, (data) => {
            map.values.forEach((value, i) => {
                if (Number.isNaN(value)) return;
                const at = 3 * entry(map.kind, value, range);
                data.set(table.subarray(at, at + 3), 4 * i);
                data[4 * i + 3] = 255;
            });
        });
    }

    /// The colour of a value, for the colour bar.
    function cssColour(kind, value, range) {
        const at = 3 * entry(kind, value, range);
        return `rgb(${tableOf(kind).subarray(at, at + 3).join(" ")})`;
    }

    // ---- Drawing --------------------------------------------------------------------------------------------------------------

    function fitting() {
        const { clientWidth, clientHeight } = canvases.test;
        const ratio = Math.min(clientWidth / size[0], clientHeight / size[1]);
        return ratio > 1 ? Math.floor(ratio) : ratio; // whole pixels, where it is enlarged
    }

    const scale = () => view.scale || fitting() || 1;

    /// Where the image stands in a canvas, in its own pixels.
    function placeIn(canvas) {
        const ratio = canvas.width / canvas.clientWidth;
        const s = scale() * ratio;
        return { ratio, s, left: Math.round(canvas.width / 2 - view.x * s), top: Math.round(canvas.height / 2 - view.y * s) };
    }

    function drawMark(context, place, index, kind) {
        const { ratio, s, left, top } = place;
        const side = Math.max(s, 9 * ratio);
        const x = left + ((index % size[0]) + 0.5) * s - side / 2;
        const y = top + (Math.floor(index / size[0]) + 0.5) * s - side / 2;
        for (const [width, colour] of [[3, "#000"], [1.5, `rgb(${markColours[kind].join(" ")})`]]) {
            context.lineWidth = width * ratio;
            context.strokeStyle = colour;
            context.strokeRect(x, y, side, side);
        }
        context.font = `600 ${11 * ratio}px ${getComputedStyle(stage).fontFamily}`;
        context.lineWidth = 3 * ratio;
        context.strokeStyle = "#000";
        context.fillStyle = "#fff";
        const at = [x + side + 3 * ratio, y + side / 2 + 4 * ratio];
        context.strokeText(letters[kind], ...at);
        context.fillText(letters[kind], ...at);
    }

    function drawCursor(context, { ratio, s, left, top }) {
        const side = Math.max(s, 5 * ratio);
        const [x, y] = [left + (cursor.x + 0.5) * s - side / 2, top + (cursor.y + 0.5) * s - side / 2];
        for (const [grow, colour] of [[1.5, "#000"], [0.5, "#fff"]]) {
            context.lineWidth = ratio;
            context.strokeStyle = colour;
            context.strokeRect(x - grow * ratio, y - grow * ratio, side + 2 * grow * ratio, side + 2 * grow * ratio);
        }
    }

    function drawImage(context, place, { raster: source, marks }) {
        context.imageSmoothingEnabled = place.s < 1;
        context.drawImage(source, place.left, place.top, size[0] * place.s, size[1] * place.s);
        let drawn = 0;
        for (const [index, kind] of marks) if (drawn++ < mostMarks) drawMark(context, place, index, kind);
    }

    const isWiping = () => stage.dataset.layout === "wipe";

    function drawPane(name) {
        const canvas = canvases[name];
        if (!canvas.clientWidth) return;
        const ratio = window.devicePixelRatio || 1;
        const wanted = [Math.round(canvas.clientWidth * ratio), Math.round(canvas.clientHeight * ratio)];
        if (canvas.width !== wanted[0] || canvas.height !== wanted[1]) [canvas.width, canvas.height] = wanted;
        const context = canvas.getContext("2d");
        context.clearRect(0, 0, canvas.width, canvas.height);
        if (!images[name]) return;
        const place = placeIn(canvas);
        drawImage(context, place, images[name]);
        if (name === "test" && isWiping()) {
            context.save();
            context.beginPath();
            context.rect(wipe * canvas.width, 0, canvas.width, canvas.height);
            context.clip();
            context.clearRect(0, 0, canvas.width, canvas.height);
            drawImage(context, place, images.reference);
            context.restore();
        }
        if (cursor) drawCursor(context, place);
    }

    function drawAll() {
        isDue = false;
        Object.keys(canvases).forEach(drawPane);
        handle.style.left = `${100 * wipe}%`;
        handle.setAttribute("aria-valuenow", String(Math.round(100 * wipe)));
        stage.dataset.scale = String(scale());
    }

    function draw() {
        if (isDue) return;
        isDue = true;
        requestAnimationFrame(drawAll);
    }

    // ---- Moving ---------------------------------------------------------------------------------------------------------------

    function hold() {
        if (view.scale <= fitting()) view = { scale: 0, x: size[0] / 2, y: size[1] / 2 };
        view.x = Math.min(size[0], Math.max(0, view.x));
        view.y = Math.min(size[1], Math.max(0, view.y));
        viewMoved();
        draw();
    }

    /// By a factor, so that the point at (dx, dy) screen pixels from the middle stays where it is.
    function zoom(factor, dx = 0, dy = 0) {
        const before = scale();
        const after = Math.min(largest, before * factor);
        view = { scale: after, x: view.x + dx / before - dx / after, y: view.y + dy / before - dy / after };
        hold();
    }

    function pan(dx, dy) {
        view = { scale: scale(), x: view.x - dx / scale(), y: view.y - dy / scale() };
        hold();
    }

    function fit() {
        view.scale = 0;
        hold();
    }

    /// Brings a pixel into the middle, large enough to be seen.
    function goTo(x, y) {
        view = { scale: Math.max(scale(), 8 * Math.max(1, fitting())), x: x + 0.5, y: y + 0.5 };
        point(x, y);
        hold();
    }

    function point(x, y) {
        const isInside = x >= 0 && y >= 0 && x < size[0] && y < size[1];
        cursor = isInside ? { x, y } : null;
        cursorMoved(cursor);
        draw();
    }

    /// Pictures of one size by pane: "test", "reference", "error".
    function show(pictures) {
        images = pictures;
        const { width, height } = pictures.test.raster;
        if (width !== size[0] || height !== size[1]) {
            size = [width, height];
            cursor = null;
            fit();
        }
        cursorMoved(cursor);
        draw();
    }

    /// What is in sight; scale 0 stands for all of it.
    function place(to) {
        if (to) {
            view = { ...to };
            hold();
        }
        return { ...view };
    }

    function moveWipe(to) {
        wipe = Math.min(1, Math.max(0, to));
        draw();
    }

    return {
        picture, heat, cssColour, markColours, show, draw, fit, zoom, pan, goTo, place, point, moveWipe, placeIn,
        canvases, stage, handle,
        wipe: () => wipe,
        cursor: () => cursor,
        onCursor: (call) => { cursorMoved = call; },
        onView: (call) => { viewMoved = call; },
    };
})();

// ---- Mouse, touch and keys on the panes -----------------------------------------------------------------------------------------

(() => {
    const { stage, handle } = panes;
    const fingers = new Map(); // pointers that are down

    function pixelAt(event) {
        const canvas = event.target.closest(".pane").querySelector("canvas");
        const box = canvas.getBoundingClientRect();
        const { ratio, s, left, top } = panes.placeIn(canvas);
        return [((event.clientX - box.left) * ratio - left) / s, ((event.clientY - box.top) * ratio - top) / s].map(Math.floor);
    }

    function fromMiddle(clientX, clientY, pane) {
        const box = pane.getBoundingClientRect();
        return [clientX - box.left - box.width / 2, clientY - box.top - box.height / 2];
    }

    function gesture() {
        const at = [...fingers.values()];
        const [x, y] = [0, 1].map((axis) => at.reduce((sum, p) => sum + p[axis], 0) / at.length);
        return { x, y, spread: at.length > 1 ? Math.hypot(at[0][0] - at[1][0], at[0][1] - at[1][1]) : 0 };
    }

    function down(event) {
        if (event.target.tagName !== "CANVAS") return;
        event.target.setPointerCapture(event.pointerId);
        fingers.set(event.pointerId, [event.clientX, event.clientY]);
        panes.point(...pixelAt(event));
    }

    function move(event) {
        if (event.target.tagName !== "CANVAS") return;
        if (!fingers.has(event.pointerId)) {
            panes.point(...pixelAt(event));
            return;
        }
        const before = gesture();
        fingers.set(event.pointerId, [event.clientX, event.clientY]);
        const after = gesture();
        panes.pan(after.x - before.x, after.y - before.y);
        if (before.spread > 0) panes.zoom(after.spread / before.spread, ...fromMiddle(after.x, after.y, event.target));
    }

    function up(event) {
        fingers.delete(event.pointerId);
    }

    function wheel(event) {
        event.preventDefault();
        const lines = event.deltaMode === 1 ? 30 : 1;
        const pane = event.target.closest(".pane");
        if (pane) panes.zoom(Math.exp(-0.002 * lines * event.deltaY), ...fromMiddle(event.clientX, event.clientY, pane));
    }

    function wipeKeys(event) {
        const step = { ArrowLeft: -0.02, ArrowRight: 0.02, Home: -1, End: 1 }[event.key];
        if (step === undefined) return;
        panes.moveWipe(panes.wipe() + step);
        event.preventDefault();
        event.stopPropagation();
    }

    function wipeTo(event) {
        if (!handle.hasPointerCapture(event.pointerId)) return;
        const box = handle.parentElement.getBoundingClientRect();
        panes.moveWipe((event.clientX - box.left) / box.width);
    }

    stage.addEventListener("pointerdown", down);
    stage.addEventListener("pointermove", move);
    for (const name of ["pointerup", "pointercancel"]) stage.addEventListener(name, up);
    stage.addEventListener("wheel", wheel, { passive: false });
    handle.addEventListener("pointerdown", (event) => handle.setPointerCapture(event.pointerId));
    handle.addEventListener("pointermove", wipeTo);
    handle.addEventListener("keydown", wipeKeys);
    new ResizeObserver(() => panes.draw()).observe(stage);
})();
