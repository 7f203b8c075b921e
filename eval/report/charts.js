// SPDX-License-Identifier: Apache-2.0
//
// The charts of the report: speed against accuracy, and the publication's own graphs.
"use strict";

const report = JSON.parse(document.getElementById("report-data").textContent);
const all = (selector, within = document) => [...within.querySelectorAll(selector)];
document.documentElement.classList.add("js");

const charts = (() => {
    const hidden = new Set();
    const hasVariants = report.groups.some((g) => g.variants.length > 0);
    // Every scene has a chart of the whole image and one of a region that the reader picks.
    const regionOf = (canvas) => (canvas.dataset.part === "region" ? region : "");
    const level = (g, where) => (where === "" ? g.psnr_float_db : g.regions[where]);
    const inVariant = (g) => !hasVariants || variant === "" || g.variants.includes(Number(variant)) || g.method === "blocky_ceiling";
    let region = "interior";
    let variant = "0";
    let points = [];
    let drawn = [];

    const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

    /// One of full resolution bounds nothing.
    const isCeiling = (g) => g.method === "blocky_ceiling" && g.params.reduction > 1;

    /// The same for all scenes, so that charts compare; at least a factor of 4 of time and 1 dB.
    function limits() {
        const times = points.map((g) => g.time_s);
        const bounds = hidden.has("blocky_ceiling") ? [] : report.groups.filter(isCeiling);
        const levels = ["", region].flatMap((where) => [...points, ...bounds].map((g) => level(g, where)).filter(Boolean))
            .flatMap((e) => [e.mean, e.low ?? e.mean, Math.min(e.high ?? e.mean, e.mean + 10)]); // it may be open above
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

    /// Whether another point in sight is at least as fast and as accurate, and better in one of both.
    function isDominated(group, canvas) {
        const where = regionOf(canvas);
        const [time, accuracy] = [group.time_s, level(group, where).mean];
        return points.some((g) => {
            if (g === group || g.scene !== group.scene || hidden.has(g.method) || !level(g, where)) return false;
            const other = level(g, where).mean;
            return g.time_s <= time && other >= accuracy && (g.time_s < time || other > accuracy);
        });
    }

    const faint = (tone) => `${tone}59`; // 35 %

    function dataset(style, canvas) {
        const where = regionOf(canvas);
        const isPath = style.method === "path";
        const isLine = ["crossRot", "cross", "star"].includes(style.shape);
        const tone = colour(`--c${style.colour}`);
        const data = points.filter((g) => g.scene === canvas.dataset.scene && g.method === style.method && level(g, where))
            .map((g) => ({ x: g.time_s, y: level(g, where).mean, level: level(g, where), group: g, isDominated: isDominated(g, canvas) }));
        const tones = data.map((p) => (p.isDominated ? faint(tone) : tone));
        return {
            label: style.method,
            hidden: hidden.has(style.method),
            data,
            pointStyle: style.shape === "triangleDown" ? "triangle" : style.shape,
            rotation: style.shape === "triangleDown" ? 180 : 0,
            radius: isPath ? 7 : 5,
            hoverRadius: isPath ? 9 : 7,
            hitRadius: 4,
            borderWidth: isLine ? 2.5 : 1,
            hoverBorderWidth: isLine ? 3 : 1,
            borderColor: isLine ? tones : colour("--page"),
            backgroundColor: tones,
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

    function lineLabel(chart, text, tone, y) {
        const { ctx, chartArea: area } = chart;
        if (y < area.top || y > area.bottom) return;
        ctx.save();
        ctx.fillStyle = tone;
        ctx.font = `600 11px ${Chart.defaults.font.family}`;
        ctx.textBaseline = "middle";
        ctx.fillText(text, area.right + 5, y);
        ctx.restore();
    }

    /// How a group of path tracing samples: groups that differ in spp alone make one curve.
    const samplingOf = (g) => report.convergence.find((c) => c.points.some((p) => p.group === g.group))?.variant ?? g.params.light_sampling;

    /// Plain path tracing: its level, or its curve over spp where a matrix has more than one point of it; a curve per way of sampling.
    function drawPathLevel(chart) {
        const path = shown(chart).find((d) => d.label === "path");
        if (!path || path.data.length === 0) return;
        const curves = new Map();
        for (const p of [...path.data].sort((a, b) => a.x - b.x)) {
            const key = samplingOf(p.group);
            const at = [chart.scales.x.getPixelForValue(p.x), chart.scales.y.getPixelForValue(p.y)];
            curves.set(key, [...(curves.get(key) ?? []), at]);
        }
        for (const [name, at] of curves) {
            line(chart, path.tone, (ctx, area) => {
                ctx.setLineDash([6, 4]);
                ctx.lineWidth = 1.25;
                if (at.length === 1) at.unshift([area.left, at[0][1]], [area.right, at[0][1]]);
                at.forEach(([x, y], i) => (i === 0 ? ctx.moveTo(x, y) : ctx.lineTo(x, y)));
            });
            const label = curves.size === 1 ? "path" : name;
            if (label.length <= 6) lineLabel(chart, label, path.tone, at[at.length - 1][1]);
        }
    }

    /// Levels that no image of one value per low-resolution pixel passes, by reduction factor.
    function drawCeilings(chart) {
        if (hidden.has("blocky_ceiling")) return;
        let lowest = Infinity; // where the label below stands
        const ceilings = report.groups
            .filter((g) => isCeiling(g) && g.scene === chart.canvas.dataset.scene && level(g, regionOf(chart.canvas)))
            .map((g) => ({ factor: g.params.reduction, db: level(g, regionOf(chart.canvas)).mean }))
            .sort((a, b) => a.db - b.db);
        for (const g of ceilings) {
            const y = chart.scales.y.getPixelForValue(g.db);
            line(chart, colour("--soft"), (ctx, area) => {
                ctx.setLineDash([2, 3]);
                ctx.lineWidth = 1.25;
                ctx.moveTo(area.left, y);
                ctx.lineTo(area.right, y);
            });
            lowest = Math.min(y, lowest - 11);
            lineLabel(chart, `f${g.factor}`, colour("--soft"), lowest);
        }
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
    function drawInterval(chart, tone, p) {
        const { low, high } = p.level;
        if (low === null) return;
        line(chart, p.isDominated ? faint(tone) : tone, (ctx, area) => {
            ctx.lineWidth = 1.25;
            const x = chart.scales.x.getPixelForValue(p.x);
            const bottom = chart.scales.y.getPixelForValue(low);
            const top = high === null ? area.top : chart.scales.y.getPixelForValue(high);
            ctx.moveTo(x, bottom);
            ctx.lineTo(x, top);
            for (const end of high === null ? [bottom] : [bottom, top]) {
                ctx.moveTo(x - 4, end);
                ctx.lineTo(x + 4, end);
            }
        });
    }

    function drawIntervals(chart) {
        for (const data of shown(chart)) data.data.forEach((p) => drawInterval(chart, data.tone, p));
    }

    function pointText(p) {
        const { time_share: share } = p.group;
        const e = p.level;
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
                if (!found.length) return;
                const { group } = chart.data.datasets[found[0].datasetIndex].data[found[0].index];
                if (!viewer.open(group.id)) location.hash = group.id;
            },
        };
    }

    function draw() {
        drawn.forEach((chart) => chart.destroy());
        points = report.groups.filter((g) => g.time_s > 0 && g.psnr_float_db && inVariant(g));
        if (points.length === 0) {
            document.querySelector(".charts").replaceChildren("No cell has both a time and a psnr_float_db to draw.");
            return;
        }
        const range = limits();
        all(".region-name").forEach((name) => { name.textContent = region; });
        const plugins = [{ id: "lines", beforeDatasetsDraw: (c) => { drawCeilings(c); drawFront(c); drawPathLevel(c); drawIntervals(c); } }];
        Chart.defaults.font.family = getComputedStyle(document.body).fontFamily;
        drawn = all("canvas[data-scene]").map((canvas) => new Chart(canvas, {
            type: "scatter",
            data: { datasets: report.methods.map((style) => dataset(style, canvas)) },
            options: options(range),
            plugins,
        }));
        drawGraphs();
    }

    function toggle(button) {
        const method = button.dataset.method;
        hidden.has(method) ? hidden.delete(method) : hidden.add(method);
        button.setAttribute("aria-pressed", String(!hidden.has(method)));
        draw();
    }

    function choose(button) {
        if (button.dataset.region !== undefined) region = button.dataset.region;
        else variant = button.dataset.variant;
        all("button", button.parentElement).forEach((b) => b.setAttribute("aria-pressed", String(b === button)));
        draw();
    }

    /// The publication's own graphs: bars of time, path tracing first.
    function drawGraphs() {
        all("canvas[data-graph]").forEach((canvas) => {
            const { bars } = report.graphs.find((g) => g.id === canvas.dataset.graph);
            const labels = [...new Set(bars.map((b) => b.label))];
            const find = (scene, label) => bars.find((b) => b.scene === scene && b.label === label);
            const font = { size: 11 };
            const lines = (label) => label.split(/\.(?=[a-z]+_)/); // what is long, below the rest
            drawn.push(new Chart(canvas, {
                type: "bar",
                data: {
                    labels: labels.map(lines),
                    datasets: report.scenes.map((scene, i) => ({
                        label: scene,
                        data: labels.map((label) => find(scene, label)?.time_s ?? null),
                        backgroundColor: colour(`--c${i + 1}`),
                    })),
                },
                options: {
                    animation: false,
                    responsive: true,
                    maintainAspectRatio: false,
                    plugins: { legend: { labels: { color: colour("--ink"), boxWidth: 12 } } },
                    scales: {
                        x: { grid: { display: false }, ticks: { color: colour("--ink"), font, autoSkip: false, maxRotation: 60 } },
                        y: { beginAtZero: true, grid: { color: colour("--rule") }, ticks: { color: colour("--ink") },
                            title: { display: true, text: "s per image", color: colour("--soft") } },
                    },
                    onClick: (_, found) => {
                        const bar = found.length && find(report.scenes[found[0].datasetIndex], labels[found[0].index]);
                        if (bar && !viewer.open(bar.id)) location.hash = bar.id;
                    },
                },
            }));
        });
    }

    all("#chart .switch button").forEach((button) => button.addEventListener("click", () => choose(button)));
    all("#chart .legend button").forEach((button) => button.addEventListener("click", () => toggle(button)));
    for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", draw);
    return { draw, logTicks, colour };
})();
