// SPDX-License-Identifier: Apache-2.0
//
// What the report can do beyond being read: charts, a sortable and filtered table, and a viewer for the pictures. The page
// is whole without it, but for the charts.
"use strict";

const report = JSON.parse(document.getElementById("report-data").textContent);
const all = (selector, within = document) => [...within.querySelectorAll(selector)];
document.documentElement.classList.add("js");

// ---- Charts ------------------------------------------------------------------------------------------------------------------

const charts = (() => {
    const hidden = new Set();
    const points = report.groups.filter((g) => g.psnr_float_db && g.time_s > 0);
    let drawn = [];

    const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

    /// The same for all scenes, so that charts compare; at least a factor of 4 of time and 1 dB.
    function limits() {
        const times = points.map((g) => g.time_s);
        const levels = points.flatMap((g) => [g.psnr_float_db.mean, g.psnr_float_db.low ?? g.psnr_float_db.mean,
            g.psnr_float_db.high ?? g.psnr_float_db.mean]);
        const centre = Math.sqrt(Math.min(...times) * Math.max(...times));
        const least = Math.min(Math.min(...times) / 1.25, centre / 2);
        const most = Math.max(Math.max(...times) * 1.25, centre * 2);
        const span = Math.max(1, Math.max(...levels) - Math.min(...levels));
        const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50].find((s) => span / s <= 8) ?? 100;
        return {
            x: [least, most],
            y: [Math.floor((Math.min(...levels) - 0.02 * span) / step) * step,
                Math.ceil((Math.max(...levels) + 0.02 * span) / step) * step],
            step,
        };
    }

    /// 1, 2, 5 per decade; more where few of them are in sight, fewer where they would not fit.
    function logTicks(low, high, width) {
        const room = Math.max(2, Math.floor(width / 52));
        const inside = (digits) => {
            const ticks = [];
            for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); ++e) {
                ticks.push(...digits.map((digit) => Number(`${digit}e${e}`)));
            }
            return ticks.filter((t) => t >= low && t <= high);
        };
        const choices = high / low < 20 ? [[1, 2, 3, 4, 5, 6, 8], [1, 2, 3, 5, 7]] : [];
        const fitting = [...choices, [1, 2, 5]].map(inside).find((ticks) => ticks.length <= room);
        const ticks = fitting ?? inside([1]);
        const stride = Math.ceil(ticks.length / room);
        return ticks.filter((_, i) => i % stride === 0).map((value) => ({ value }));
    }

    function dataset(style, scene) {
        const isPath = style.method === "path";
        const isLine = ["crossRot", "cross", "star"].includes(style.shape);
        const tone = colour(`--c${style.colour}`);
        return {
            label: style.method,
            hidden: hidden.has(style.method),
            data: points.filter((g) => g.scene === scene && g.method === style.method)
                .map((g) => ({ x: g.time_s, y: g.psnr_float_db.mean, group: g })),
            pointStyle: style.shape === "triangleDown" ? "triangle" : style.shape,
            rotation: style.shape === "triangleDown" ? 180 : 0,
            radius: isPath ? 7 : 5,
            hoverRadius: isPath ? 9 : 7,
            hitRadius: 4,
            borderWidth: isLine ? 2.5 : 1,
            hoverBorderWidth: isLine ? 3 : 1,
            borderColor: isLine ? tone : colour("--page"),
            backgroundColor: tone,
            tone,
            order: isPath ? 0 : 1,
        };
    }

    function line(chart, tone, path) {
        const { ctx, chartArea: area } = chart;
        ctx.save();
        ctx.beginPath();
        ctx.rect(area.left, area.top, area.width, area.height);
        ctx.clip();
        ctx.strokeStyle = tone;
        ctx.beginPath();
        path(ctx, area);
        ctx.stroke();
        ctx.restore();
    }

    const shown = (chart) => chart.data.datasets.filter((_, i) => chart.isDatasetVisible(i));

    /// Plain path tracing: its level, or its curve where a matrix has more than one point of it.
    function drawPathLevel(chart) {
        const path = shown(chart).find((d) => d.label === "path");
        if (!path || path.data.length === 0) return;
        const at = [...path.data].sort((a, b) => a.x - b.x)
            .map((p) => [chart.scales.x.getPixelForValue(p.x), chart.scales.y.getPixelForValue(p.y)]);
        line(chart, path.tone, (ctx, area) => {
            ctx.setLineDash([6, 4]);
            ctx.lineWidth = 1.25;
            if (at.length === 1) at.unshift([area.left, at[0][1]], [area.right, at[0][1]]);
            at.forEach(([x, y], i) => (i === 0 ? ctx.moveTo(x, y) : ctx.lineTo(x, y)));
        });
        chart.ctx.save();
        chart.ctx.fillStyle = path.tone;
        chart.ctx.font = `600 11px ${Chart.defaults.font.family}`;
        chart.ctx.textBaseline = "middle";
        chart.ctx.fillText("path", chart.chartArea.right + 5, at[at.length - 1][1]);
        chart.ctx.restore();
    }

    /// Steps along the points that nothing faster beats.
    function drawFront(chart) {
        const ordered = shown(chart).flatMap((d) => d.data).sort((a, b) => a.x - b.x || b.y - a.y);
        let best = -Infinity;
        const winners = ordered.filter((p) => p.y > best && ((best = p.y), true));
        const last = winners[winners.length - 1];
        const front = winners.map((p) => [chart.scales.x.getPixelForValue(p.x), chart.scales.y.getPixelForValue(p.y)]);
        if (front.length === 0) return;
        line(chart, colour("--soft"), (ctx, area) => {
            ctx.lineWidth = 1;
            ctx.moveTo(...front[0]);
            front.slice(1).forEach(([x, y], i) => { ctx.lineTo(x, front[i][1]); ctx.lineTo(x, y); });
            // Where path tracing ends it, the dashed line goes on at that level.
            if (last.group.method !== "path") ctx.lineTo(area.right, front[front.length - 1][1]);
        });
    }

    /// 95 % intervals; one that is open above ends without a cap.
    function drawIntervals(chart) {
        for (const data of shown(chart)) {
            line(chart, data.tone, (ctx, area) => {
                ctx.lineWidth = 1.25;
                for (const p of data.data) {
                    const { low, high } = p.group.psnr_float_db;
                    if (low === null) continue;
                    const x = chart.scales.x.getPixelForValue(p.x);
                    const bottom = chart.scales.y.getPixelForValue(low);
                    const top = high === null ? area.top : chart.scales.y.getPixelForValue(high);
                    ctx.moveTo(x, bottom);
                    ctx.lineTo(x, top);
                    for (const end of high === null ? [bottom] : [bottom, top]) {
                        ctx.moveTo(x - 4, end);
                        ctx.lineTo(x + 4, end);
                    }
                }
            });
        }
    }

    function pointText(p) {
        const { psnr_float_db: e, time_share: share } = p.group;
        const interval = e.low === null ? "" : `, 95 % from ${e.low.toFixed(2)}${e.high === null ? "" : ` to ${e.high.toFixed(2)}`}`;
        const part = share > 0 ? `, ${(100 * share).toFixed(1)} % of path` : "";
        return [
            `${p.group.method}: ${p.group.parameters}`,
            `${e.mean.toFixed(2)} dB${interval}`,
            `${p.group.time_s.toFixed(report.time_decimals)} s${part}; ${p.group.seeds} seed${p.group.seeds === 1 ? "" : "s"}`,
        ];
    }

    function axes(range) {
        const grid = { color: colour("--rule"), borderColor: colour("--soft") };
        const border = { color: colour("--soft") }; // where Chart.js 4 looks
        const title = (text) => ({ display: true, text, color: colour("--soft") });
        const ticks = { color: colour("--ink"), autoSkip: false, maxRotation: 0 };
        return {
            x: {
                type: "logarithmic", min: range.x[0], max: range.x[1], grid, border, title: title("time per image, s (log; left is faster)"),
                ticks: { ...ticks, callback: (value) => String(Number(value.toPrecision(1))) },
                afterBuildTicks: (axis) => { axis.ticks = logTicks(axis.min, axis.max, axis.width || axis.maxWidth); },
            },
            y: {
                min: range.y[0], max: range.y[1], grid, border, title: title("psnr_float_db, dB (higher is better)"),
                ticks: { ...ticks, stepSize: range.step, callback: (value) => value.toFixed(range.step < 1 ? 1 : 0) },
            },
        };
    }

    function options(range) {
        return {
            animation: false,
            responsive: true,
            maintainAspectRatio: false,
            layout: { padding: { right: 34, top: 6 } },
            interaction: { mode: "nearest", intersect: true },
            scales: axes(range),
            plugins: {
                legend: { display: false },
                tooltip: {
                    displayColors: false,
                    padding: 9,
                    callbacks: { title: () => "", label: (item) => pointText(item.raw) },
                    filter: (_, index) => index < 4,
                },
            },
            onHover: (event, found) => { event.native.target.style.cursor = found.length ? "pointer" : ""; },
            onClick: (_, found, chart) => {
                if (found.length) location.hash = chart.data.datasets[found[0].datasetIndex].data[found[0].index].group.id;
            },
        };
    }

    function draw() {
        drawn.forEach((chart) => chart.destroy());
        if (points.length === 0) {
            document.querySelector(".charts").replaceChildren("No cell has both a time and a psnr_float_db to draw.");
            return;
        }
        const range = limits();
        const plugins = [{ id: "lines", beforeDatasetsDraw: (c) => { drawFront(c); drawPathLevel(c); drawIntervals(c); } }];
        Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
        drawn = all("canvas[data-scene]").map((canvas) => new Chart(canvas, {
            type: "scatter",
            data: { datasets: report.methods.map((style) => dataset(style, canvas.dataset.scene)) },
            options: options(range),
            plugins,
        }));
    }

    function toggle(button) {
        const method = button.dataset.method;
        hidden.has(method) ? hidden.delete(method) : hidden.add(method);
        button.setAttribute("aria-pressed", String(!hidden.has(method)));
        draw();
    }

    all(".legend button").forEach((button) => button.addEventListener("click", () => toggle(button)));
    for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", draw);
    return { draw };
})();

// ---- Table -------------------------------------------------------------------------------------------------------------------

(() => {
    const table = document.getElementById("results-table");
    const body = table.tBodies[0];
    const original = [...body.rows];

    function sortBy(header, direction) {
        const column = header.cellIndex;
        const key = (row) => row.cells[column].dataset.value ?? row.cells[column].textContent;
        const isNumber = original.some((row) => row.cells[column].dataset.value !== undefined);
        const sign = direction === "ascending" ? 1 : -1;
        const compare = (a, b) => {
            if (!isNumber) return sign * key(a).localeCompare(key(b));
            const [x, y] = [Number(key(a)), Number(key(b))];
            // What has no number stands last either way.
            return Number.isNaN(x) || Number.isNaN(y) ? Number.isNaN(x) - Number.isNaN(y) : sign * (x - y);
        };
        all("th[aria-sort]", table).forEach((th) => th.removeAttribute("aria-sort"));
        if (direction) header.setAttribute("aria-sort", direction);
        table.classList.toggle("sorted", Boolean(direction));
        body.append(...(direction ? [...original].sort(compare) : original));
    }

    /// The better end first, then the other one, then the order of the matrix.
    function nextDirection(header) {
        const first = header.dataset.first ?? "ascending";
        const now = header.getAttribute("aria-sort");
        if (!now) return first;
        return now === first ? (first === "ascending" ? "descending" : "ascending") : null;
    }

    for (const header of table.tHead.rows[0].cells) {
        const button = document.createElement("button");
        button.append(...header.childNodes);
        header.append(button);
        button.addEventListener("click", () => sortBy(header, nextDirection(header)));
    }

    const count = document.getElementById("table-count");
    document.getElementById("table-filter").addEventListener("input", (event) => {
        const words = event.target.value.toLowerCase().split(/\s+/).filter(Boolean);
        let visible = 0;
        for (const row of original) {
            row.hidden = !words.every((word) => row.dataset.words.toLowerCase().includes(word));
            visible += row.hidden ? 0 : 1;
        }
        count.textContent = words.length ? `${visible} of ${original.length} rows` : "";
    });
})();

// ---- Viewer ------------------------------------------------------------------------------------------------------------------

(() => {
    const viewer = document.getElementById("viewer");
    const part = (name) => document.getElementById(`viewer-${name}`);
    const cards = all(".card[data-name]");
    let index = 0;
    let view = 1;

    function source(card) {
        if (view !== 2) return card.querySelector(`.shot[data-view="${view}"] img`);
        return document.querySelector(`#${CSS.escape(card.dataset.reference || "none")} img`);
    }

    /// As large as fits, in whole pixels of the image where it is enlarged.
    function fit() {
        const image = part("image");
        const room = part("stage").getBoundingClientRect();
        if (!image.naturalWidth) return;
        const ratio = Math.min(room.width / image.naturalWidth, room.height / image.naturalHeight);
        const scale = ratio > 1 ? Math.floor(ratio) : ratio;
        image.classList.toggle("enlarged", scale > 1);
        image.style.width = `${image.naturalWidth * scale}px`;
        image.style.height = `${image.naturalHeight * scale}px`;
    }

    function show() {
        const card = cards[index];
        const from = source(card);
        const image = part("image");
        image.hidden = !from;
        part("none").hidden = Boolean(from);
        if (from) {
            image.src = from.src;
            image.alt = from.alt;
            image.decode().then(fit, () => {});
        }
        part("name").textContent = card.dataset.name;
        part("place").textContent = `${index + 1} / ${cards.length}`;
        part("key").replaceChildren(...card.querySelector(".key").cloneNode(true).childNodes);
        const bar = document.getElementById(`bar-${view}`)?.cloneNode(true);
        bar?.removeAttribute("id");
        part("bar").replaceChildren(...(bar ? [bar] : []));
        all("[data-view]", viewer).forEach((b) => b.setAttribute("aria-pressed", String(Number(b.dataset.view) === view)));
    }

    function flip(to) {
        view = to;
        show();
    }

    function step(by) {
        index = (index + by + cards.length) % cards.length;
        show();
    }

    function open(shot) {
        const card = shot.closest(".card");
        const own = cards.indexOf(card);
        index = own >= 0 ? own : Math.max(0, cards.findIndex((c) => c.dataset.reference === card.id));
        view = Number(shot.dataset.view);
        viewer.showModal();
        show();
        viewer.querySelector(`[data-view="${view}"]`).focus();
    }

    const acts = { close: () => viewer.close(), previous: () => step(-1), next: () => step(1) };
    const keys = { ArrowLeft: acts.previous, ArrowRight: acts.next };

    if (cards.length === 0) return;
    all("button.shot").forEach((shot) => shot.addEventListener("click", () => open(shot)));
    all("[data-view]", viewer).forEach((b) => b.addEventListener("click", () => flip(Number(b.dataset.view))));
    all("[data-act]", viewer).forEach((b) => b.addEventListener("click", acts[b.dataset.act]));
    part("image").addEventListener("click", () => flip((view % 4) + 1));
    viewer.addEventListener("keydown", (event) => {
        if (event.ctrlKey || event.altKey || event.metaKey) return;
        if ("1234".includes(event.key)) flip(Number(event.key));
        else if (keys[event.key]) keys[event.key]();
        else return;
        event.preventDefault();
    });
    addEventListener("resize", () => viewer.open && fit());
})();

// ---- Page --------------------------------------------------------------------------------------------------------------------

(() => {
    const command = document.getElementById("command");
    if (navigator.clipboard) {
        const button = document.createElement("button");
        button.textContent = "copy";
        button.addEventListener("click", () => navigator.clipboard.writeText(command.textContent)
            .then(() => { button.textContent = "copied"; }, () => { button.textContent = "not allowed"; }));
        command.after(button);
    }
    // Pictures that were not yet scrolled to would be missing on paper.
    addEventListener("beforeprint", () => all("img[loading]").forEach((image) => { image.loading = "eager"; }));
    charts.draw();
})();
