// SPDX-License-Identifier: Apache-2.0
//
// The charts of the section on convergence: error against samples and against time, both logarithmic. Comes after charts.js.
"use strict";

const convergence = (() => {
    const hidden = new Set();
    const shapes = ["crossRot", "rect", "triangle", "rectRot", "circle", "triangleDown", "star", "cross"];
    const colours = 9;
    const variants = [...new Set(report.convergence.map((c) => c.variant))];
    let measure = "error";
    let drawn = [];

    /// Baselines come first, with the colour of path tracing; those beyond the colours are dashed.
    function style(variant) {
        const i = variants.indexOf(variant);
        return { colour: i % colours, shape: shapes[i % shapes.length], dash: i < colours ? [] : [5, 3] };
    }

    const level = (p) => (measure === "error" ? p.relmse.mean : p.variance);
    const where = (p, against) => (against === "spp" ? p.spp : p.trace_s);
    const usable = (p) => level(p) > 0;
    const curvesOf = (canvas) => report.convergence.filter((c) => c.scene === canvas.dataset.convergence);

    function law(curve, against) {
        if (measure === "variance") return against === "spp" ? curve.variance_by_spp : null;
        return against === "spp" ? curve.error_by_spp : curve.error_by_time;
    }

    function slopeText(fitted) {
        if (!fitted) return "";
        const number = (value) => value.toFixed(2).replace("-", "−");
        return number(fitted.slope) + (fitted.slope_error === null ? "" : ` ± ${number(fitted.slope_error)}`);
    }

    /// The same for all scenes, so that charts compare.
    function limits(against) {
        const points = report.convergence.filter((c) => !hidden.has(c.variant)).flatMap((c) => c.points.filter(usable));
        const around = (values) => [Math.min(...values) / 1.4, Math.max(...values) * 1.4];
        return points.length === 0 ? { x: [1, 10], y: [0.1, 1] } :
            { x: around(points.map((p) => where(p, against))), y: around(points.map(level)) };
    }

    function dataset(curve, against) {
        const { colour, shape, dash } = style(curve.variant);
        const tone = charts.colour(`--c${colour}`);
        const isLine = ["crossRot", "cross", "star"].includes(shape);
        return {
            label: curve.variant,
            hidden: hidden.has(curve.variant),
            data: curve.points.filter(usable).map((p) => ({ x: where(p, against), y: level(p), point: p, curve })),
            showLine: true,
            borderWidth: curve.baseline ? 2 : 1.5,
            borderDash: dash,
            borderColor: tone,
            backgroundColor: tone,
            pointStyle: shape === "triangleDown" ? "triangle" : shape,
            rotation: shape === "triangleDown" ? 180 : 0,
            pointBorderWidth: isLine ? 2 : 1,
            radius: 4,
            hoverRadius: 6,
            hitRadius: 4,
            tension: 0,
        };
    }

    function text({ point, curve }) {
        const e = point.relmse;
        const interval = e.low === null ? "" : `, 95 % from ${Math.max(0, e.low).toPrecision(3)} to ${e.high.toPrecision(3)}`;
        const variance = point.variance === null ? "" : `; variance ${point.variance.toPrecision(3)}`;
        return [curve.variant, `relMSE ${e.mean.toPrecision(3)}${interval}${variance}`,
            `${point.spp} spp, ${point.trace_s.toPrecision(3)} s`];
    }

    function axis(range, title, room) {
        const exponent = (value) => (value >= 0.01 && value < 1e4 ? String(Number(value.toPrecision(1))) : value.toExponential(0));
        return {
            type: "logarithmic",
            min: range[0],
            max: range[1],
            grid: { color: charts.colour("--rule"), borderColor: charts.colour("--soft") },
            border: { color: charts.colour("--soft") }, // where Chart.js 4 looks
            title: { display: true, text: title, color: charts.colour("--soft") },
            ticks: { color: charts.colour("--ink"), autoSkip: false, maxRotation: 0, callback: exponent },
            afterBuildTicks: (self) => { self.ticks = charts.logTicks(self.min, self.max, room(self)); },
        };
    }

    function chart(canvas) {
        const { against } = canvas.dataset;
        const range = limits(against);
        return new Chart(canvas, {
            type: "scatter",
            data: { datasets: curvesOf(canvas).map((curve) => dataset(curve, against)) },
            options: {
                animation: false,
                responsive: true,
                maintainAspectRatio: false,
                interaction: { mode: "nearest", intersect: true },
                scales: {
                    x: axis(range.x, against === "spp" ? "samples per pixel" : "time for tracing, s", (self) => self.width || self.maxWidth),
                    y: axis(range.y, measure === "error" ? "relMSE (lower is better)" : "relative variance over seeds", (self) => 2 * (self.height || self.maxHeight)),
                },
                plugins: {
                    legend: { display: false },
                    tooltip: { displayColors: false, padding: 9, callbacks: { title: () => "", label: (item) => text(item.raw) }, filter: (_, i) => i < 3 },
                },
                onHover: (event, found) => { event.native.target.style.cursor = found.length ? "pointer" : ""; },
                onClick: (_, found, self) => {
                    if (!found.length) return;
                    const { group } = self.data.datasets[found[0].datasetIndex].data[found[0].index].point;
                    location.hash = report.groups.find((g) => g.group === group).id;
                },
            },
        });
    }

    function marker({ colour, shape }) {
        const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
        const use = document.createElementNS("http://www.w3.org/2000/svg", "use");
        svg.setAttribute("class", `marker c${colour}`);
        svg.setAttribute("aria-hidden", "true");
        use.setAttribute("href", `#marker-${shape}`);
        svg.append(use);
        return svg;
    }

    function legend(canvas) {
        const buttons = curvesOf(canvas).map((curve) => {
            const button = document.createElement("button");
            const slope = document.createElement("span");
            slope.className = "slope";
            slope.textContent = slopeText(law(curve, canvas.dataset.against));
            button.type = "button";
            button.setAttribute("aria-pressed", String(!hidden.has(curve.variant)));
            button.append(marker(style(curve.variant)), curve.variant, " ", slope);
            button.addEventListener("click", () => {
                hidden.has(curve.variant) ? hidden.delete(curve.variant) : hidden.add(curve.variant);
                draw();
            });
            return button;
        });
        canvas.closest("figure").querySelector(".legend").replaceChildren(...buttons);
    }

    function draw() {
        drawn.forEach((each) => each.destroy());
        const canvases = all("canvas[data-convergence]");
        canvases.forEach(legend);
        drawn = canvases.map(chart);
    }

    all("button[data-measure]").forEach((button) => button.addEventListener("click", () => {
        measure = button.dataset.measure;
        all("button[data-measure]").forEach((b) => b.setAttribute("aria-pressed", String(b === button)));
        draw();
    }));
    for (const query of ["(prefers-color-scheme: dark)", "print"]) matchMedia(query).addEventListener("change", draw);
    return { draw };
})();
