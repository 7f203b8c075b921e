// SPDX-License-Identifier: Apache-2.0
//
// The viewer: which cell is looked at, and how. What it draws with is in panes.js and legend.js.
"use strict";

const viewer = (() => {
    const dialog = document.getElementById("viewer");
    const part = (name) => document.getElementById(`viewer-${name}`);
    const cells = report.groups.filter((g) => g.plane);
    const narrow = matchMedia("(max-width: 40rem)");
    const kinds = ["magnitude", "sign", "ssim"];

    /// That of the page's maps: a round number that was a float32.
    function sharedRange(kind) {
        return Number((report.viewer.ranges[kind] || 0.1).toPrecision(6));
    }

    // Kept from cell to cell, so that pictures compare.
    const state = {
        index: 0, kind: "magnitude", exposure: 0, isReference: false, turn: 0, like: {},
        ranges: { magnitude: sharedRange("magnitude"), sign: sharedRange("sign"), ssim: null },
    };
    let shown = null; // {test, reference, map} of the cell in sight
    let drawn = {}; // the reference's picture, which many cells share

    // ---- Cells of one place ---------------------------------------------------------------------------------------------------

    const card = (group) => document.getElementById(group.id);
    const pictureOf = (group) => card(group)?.querySelector('.shot[data-view="1"] img');
    const referencePicture = (group) => document.querySelector(`#${card(group)?.dataset.reference || "none"} img`);
    const isReduced = (g) => g.params.reduction > 1;

    /// The parameters by which others are chosen: of what was looked at last and has them. Path tracing has no factor, nearest
    /// no window.
    function remembered(group) {
        const known = isReduced(group) ? group : cells.find((g) => g.scene === group.scene && isReduced(g));
        if (isReduced(group) || state.like.reduction === undefined) Object.assign(state.like, known?.params);
        return state.like;
    }

    /// One cell per method, in the scene and factor of this one, otherwise as alike as there is.
    function siblings(group) {
        const like = remembered(group);
        const alike = (g) => report.varying.filter((name) => g.params[name] === like[name]).length;
        const candidates = cells.filter((g) => g.scene === group.scene && (!isReduced(g) || g.params.reduction === like.reduction));
        const best = ({ method }) => {
            if (method === group.method) return group;
            const ranked = candidates.filter((g) => g.method === method).sort((a, b) => alike(b) - alike(a));
            return ranked[0];
        };
        return report.methods.map(best).filter(Boolean).slice(0, 9);
    }

    // ---- Showing --------------------------------------------------------------------------------------------------------------

    function loadGroup(group) {
        return Promise.all([
            planes.load(group.plane, group.reference, pictureOf(group)),
            planes.load(group.reference, null, referencePicture(group)),
        ]);
    }

    function press(selector, isPressed) {
        all(selector, dialog).forEach((b) => b.setAttribute("aria-pressed", String(isPressed(b))));
    }

    function drawImages() {
        const { test, reference } = shown;
        if (drawn.plane !== reference || drawn.exposure !== state.exposure) {
            drawn = { plane: reference, exposure: state.exposure, picture: panes.picture(reference, state.exposure) };
        }
        shown.pictures = { test: panes.picture(test, state.exposure), reference: drawn.picture };
    }

    function drawMap() {
        const { test, reference } = shown;
        if (shown.map?.kind !== state.kind) shown.map = errors.map(test, reference, state.kind);
        const range = state.ranges[state.kind] ??= errors.roundUp(shown.map.p99);
        const marks = new Map([...reference.nonFinite, ...test.nonFinite]);
        shown.pictures.error = panes.heat(shown.map, range, marks);
        legend.show(shown.map, range);
        part("range").textContent = String(range);
    }

    /// All that depends on values; what was drawn from the same ones already is drawn again only where it changed.
    function update() {
        if (!shown) return;
        drawMap();
        const { test, reference, error } = shown.pictures;
        panes.show({ test: state.isReference ? reference : test, reference, error });
        part("test-tag").textContent = state.isReference ? "reference" : "image";
        part("exposure-text").textContent = `${state.exposure > 0 ? "+" : ""}${state.exposure} EV`.replaceAll("-", "−");
        part("exposure").value = state.exposure;
        press("[data-kind]", (b) => b.dataset.kind === state.kind);
        note();
    }

    function precisionText({ test, reference }) {
        const kinds = new Set([test.precision, reference.precision]);
        if (kinds.has("8 bit")) return "8-bit values: the float values of this cell are not beside the page";
        if (kinds.has("float16")) return "reference float32; image stored as float16 difference from it";
        return "float32";
    }

    function showMethods(group) {
        const list = siblings(group);
        part("methods").replaceChildren(...list.map((g, i) => {
            const button = document.createElement("button");
            const key = document.createElement("kbd");
            key.textContent = String(i + 1);
            button.type = "button";
            button.append(key, " ", g.method);
            button.title = g.short;
            button.setAttribute("aria-pressed", String(g === group));
            button.addEventListener("click", () => go(g));
            return button;
        }));
        part("methods").querySelector('[aria-pressed="true"]')?.scrollIntoView({ block: "nearest", inline: "nearest" });
    }

    function showName(group) {
        part("name").textContent = group.group;
        part("place").textContent = `${state.index + 1} / ${cells.length}`;
        const key = card(group)?.querySelector(".key");
        part("key").replaceChildren(...(key ? key.cloneNode(true).childNodes : []));
        showMethods(group);
    }

    function say(text) {
        part("message").textContent = text;
        part("message").hidden = text === "";
    }

    /// The others of this place, so that keys flip at once.
    async function prefetch(group, turn) {
        for (const other of siblings(group)) {
            if (turn !== state.turn) return;
            if (!planes.has(other.plane)) await loadGroup(other).catch(() => {});
        }
    }

    async function show() {
        const group = cells[state.index];
        const turn = ++state.turn;
        showName(group);
        dialog.setAttribute("aria-busy", "true");
        try {
            const [test, reference] = await loadGroup(group);
            if (turn !== state.turn) return;
            if (test.width !== reference.width || test.height !== reference.height) throw new Error("image and reference differ in size");
            shown = { test, reference };
            say("");
            drawImages();
            legend.showNonFinite(test, reference);
            part("precision").textContent = precisionText(shown);
            update();
            dialog.dataset.shown = group.group;
            setTimeout(() => prefetch(group, turn), 150);
        } catch (error) {
            if (turn !== state.turn) return;
            shown = null;
            say(`No picture of this cell: ${error.message}.`);
            dialog.dataset.shown = "";
        }
        dialog.setAttribute("aria-busy", "false");
    }

    // ---- What one can do ------------------------------------------------------------------------------------------------------

    function go(group) {
        state.index = cells.indexOf(group);
        show();
    }

    function step(by) {
        state.index = (state.index + by + cells.length) % cells.length;
        show();
    }

    function setKind(kind) {
        state.kind = kind;
        update();
    }

    function setLayout(layout) {
        panes.stage.dataset.layout = layout;
        press("button[data-layout]", (b) => b.dataset.layout === layout);
        panes.draw();
        note();
    }

    function expose(stops) {
        state.exposure = Math.min(10, Math.max(-10, stops));
        if (shown) drawImages();
        update();
    }

    /// To the next round number: 1, 2, 5, 10, ...
    function stretch(direction) {
        const now = state.ranges[state.kind];
        if (!now) return;
        const lower = [0.5, 0.4, 0.2].map((f) => Number((now * f).toPrecision(1)));
        const down = lower.find((r) => "125".includes(r.toExponential()[0])) ?? now / 2;
        state.ranges[state.kind] = direction > 0 ? errors.roundUp(now * 1.01) : Math.max(0.001, down);
        update();
    }

    function fitRange() {
        if (shown) state.ranges[state.kind] = errors.roundUp(shown.map.p99);
        update();
    }

    function flipReference() {
        state.isReference = !state.isReference;
        press('[data-act="reference"]', () => state.isReference);
        update();
    }

    const pixelOf = (index) => [index % shown.test.width, Math.floor(index / shown.test.width)];

    function goToWorst() {
        if (shown?.map.worst >= 0) panes.goTo(...pixelOf(shown.map.worst));
    }

    /// The next pixel that is no number, after the one under the cursor.
    function goToNonFinite() {
        if (!shown) return;
        const found = [...shown.test.nonFinite.keys(), ...shown.reference.nonFinite.keys()].sort((a, b) => a - b);
        const { x, y } = panes.cursor() ?? { x: -1, y: 0 };
        const next = found.find((i) => i > y * shown.test.width + x) ?? found[0];
        if (next !== undefined) panes.goTo(...pixelOf(next));
    }

    function moveCursor(dx, dy) {
        if (!shown) return;
        const { x, y } = panes.cursor() ?? { x: Math.floor(shown.test.width / 2), y: Math.floor(shown.test.height / 2) };
        const inside = (v, side) => Math.min(side - 1, Math.max(0, v));
        panes.point(inside(x + dx, shown.test.width), inside(y + dy, shown.test.height));
    }

    const acts = {
        close: () => dialog.close(), previous: () => step(-1), next: () => step(1),
        larger: () => panes.zoom(1.5), smaller: () => panes.zoom(1 / 1.5), fit: panes.fit,
        brighter: () => expose(state.exposure + 0.5), darker: () => expose(state.exposure - 0.5),
        wider: () => stretch(1), closer: () => stretch(-1), auto: fitRange,
        reference: flipReference, worst: goToWorst, bad: goToNonFinite,
        kind: () => setKind(kinds[(kinds.indexOf(state.kind) + 1) % kinds.length]),
        layout: () => setLayout(panes.stage.dataset.layout === "wipe" ? "side" : "wipe"),
    };
    const keys = {
        ArrowLeft: acts.previous, ArrowRight: acts.next, "+": acts.larger, "=": acts.larger, "-": acts.smaller, f: acts.fit,
        e: acts.brighter, E: acts.darker, "]": acts.wider, "[": acts.closer, a: acts.auto, 0: acts.reference,
        x: acts.worst, n: acts.bad, m: acts.kind, w: acts.layout,
    };
    const moves = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

    function key(event) {
        if (event.ctrlKey || event.altKey || event.metaKey || event.target.type === "range" && event.key.startsWith("Arrow")) return;
        if (event.shiftKey && moves[event.key]) moveCursor(...moves[event.key]);
        else if (/^[1-9]$/.test(event.key)) all("button", part("methods"))[Number(event.key) - 1]?.click();
        else if (keys[event.key]) keys[event.key]();
        else return;
        event.preventDefault();
    }

    /// Opens a cell by the id of its group, a promise; false if there is nothing to see of it. kind: which error map, if it matters.
    function open(id, { kind = null, isReference = false } = {}) {
        const group = cells.find((g) => g.id === id) ?? cells.find((g) => card(g)?.dataset.reference === id);
        if (!group) return false;
        state.index = cells.indexOf(group);
        if (kind) state.kind = kind;
        if (state.isReference !== isReference) flipReference();
        if (!dialog.open) {
            dialog.showModal();
            dialog.focus(); // not a button: keys are the viewer's
        }
        return show().then(() => true);
    }

    // ---- Links: the address tells what is in sight ------------------------------------------------------------------------------

    let isNoted = true;

    /// In the address, once things have come to rest.
    function note() {
        if (!isNoted) return;
        isNoted = false;
        setTimeout(() => {
            isNoted = true;
            const { scale, x, y } = panes.place();
            const at = scale ? [scale, x, y].map((v) => Number(v.toFixed(2))).join(",") : "";
            const parts = { view: cells[state.index].group, map: state.kind, layout: panes.stage.dataset.layout, at };
            const hash = dialog.open ? `#${new URLSearchParams(parts)}` : " ";
            if (dialog.open || location.hash.startsWith("#view=")) history.replaceState(null, "", hash);
        }, 300);
    }

    /// Opens what the address tells, if it tells something.
    async function follow() {
        const parts = new URLSearchParams(location.hash.slice(1));
        const group = cells.find((g) => g.group === parts.get("view"));
        if (!group || dialog.open) return;
        const kind = kinds.find((k) => k === parts.get("map"));
        if (parts.get("layout") === "side" || parts.get("layout") === "wipe") setLayout(parts.get("layout"));
        const [scale, x, y] = (parts.get("at") ?? "").split(",").map(Number);
        await open(group.id, { kind });
        if (scale > 0 && Number.isFinite(x + y)) panes.place({ scale, x, y });
    }

    all("[data-kind]", dialog).forEach((b) => b.addEventListener("click", () => setKind(b.dataset.kind)));
    all("button[data-layout]", dialog).forEach((b) => b.addEventListener("click", () => setLayout(b.dataset.layout)));
    all("[data-act]", dialog).forEach((b) => b.addEventListener("click", acts[b.dataset.act]));
    part("exposure").addEventListener("input", (event) => expose(Number(event.target.value)));
    dialog.addEventListener("keydown", key);
    panes.onCursor((pixel) => shown && legend.read(pixel, shown));
    setLayout(narrow.matches ? "wipe" : "side");
    addEventListener("resize", () => dialog.open && update());
    addEventListener("hashchange", follow);
    dialog.addEventListener("close", note);
    panes.onView(note);
    return { open, follow };
})();
