// SPDX-License-Identifier: Apache-2.0
//
// Scene by method, coloured by a metric. The colour's lightness tells what is good, and the number stands in each field.
"use strict";

const matrix = (() => {
    const table = document.getElementById("matrix-table");
    const metricChoice = document.getElementById("matrix-metric");
    const parameterChoices = document.getElementById("matrix-parameters");
    const db = (name, of) => ({ name, unit: "dB", digits: 2, isHigher: true, of });
    const metrics = [
        db("psnr_float_db", (g) => g.psnr_float_db),
        ...["interior", "edge", "emitter"].map((region) => db(`psnr_float_db, ${region}`, (g) => g.regions[region])),
        db("noise", (g) => g.noise_db), db("bias", (g) => g.bias_db),
        ...report.metrics.filter((m) => m.name !== "psnr_float_db").map((m) => (
            { name: m.name, unit: m.unit, digits: m.decimals, isHigher: m.higher_is_better, isLog: !m.higher_is_better, of: (g) => g.metrics[m.name] })),
        { name: "time", unit: "s", digits: report.time_decimals, isLog: true, of: (g) => positive(g.time_s) },
        { name: "time share", unit: "% of path", digits: 1, isLog: true, of: (g) => positive(100 * g.time_share) },
    ];
    const methods = report.methods.map((m) => m.method).filter((name) => report.groups.some((g) => g.method === name));
    const isTall = methods.length >= report.scenes.length; // methods below each other

    function positive(value) {
        return value > 0 ? { mean: value } : null;
    }

    const metric = () => metrics[metricChoice.selectedIndex];
    const text = (value) => (value === null || value === undefined ? "–" : Array.isArray(value) ? value.join(" × ") : String(value));

    /// Of two groups, the one that the metric prefers; one without value loses.
    function better(a, b) {
        const [x, y] = [a, b].map((g) => metric().of(g)?.mean);
        if (x === undefined || y === undefined) return y === undefined ? a : b;
        return (metric().isHigher ? y > x : y < x) ? b : a;
    }

    /// A group without a parameter (path tracing has no window) fits every choice of it.
    function fits(group) {
        return all("select", parameterChoices).every((choice) => {
            const value = group.params[choice.dataset.name];
            return choice.value === "" || value === undefined || value === null || text(value) === choice.value;
        });
    }

    function fieldGroup(scene, method) {
        const found = report.groups.filter((g) => g.scene === scene && g.method === method && fits(g));
        return found.length ? found.reduce(better) : null;
    }

    function fieldText(group) {
        const value = metric().of(group)?.mean;
        if (value !== undefined) return value.toFixed(metric().digits);
        if (group.seeds === 0) return "failed";
        return /^psnr(_float)?_db$/.test(metric().name) ? "identical" : "–";
    }

    const isBound = (group) => group.method === "blocky_ceiling"; // nothing that one could use

    /// 0 for the worst value in sight, 1 for the best; bounds do not count.
    function rankOf(groups) {
        const level = (g) => {
            const value = metric().of(g)?.mean;
            return value === undefined ? NaN : metric().isLog ? Math.log(value) : value;
        };
        const levels = groups.filter((g) => !isBound(g)).map(level).filter((v) => !Number.isNaN(v));
        const [low, high] = [Math.min(...levels), Math.max(...levels)];
        return (group) => {
            if (fieldText(group) === "identical") return 1;
            const t = high > low ? Math.min(1, Math.max(0, (level(group) - low) / (high - low))) : 1;
            return metric().isHigher ? t : 1 - t;
        };
    }

    function paint(element, rank) {
        const t = 0.12 + 0.84 * rank;
        element.style.background = panes.cssColour("magnitude", t, 1);
        element.style.color = t > 0.58 ? "#000" : "#fff";
    }

    /// "f2 w7 inverse"
    function shortParameters(group) {
        const letters = { reduction: "f", window: "w" };
        return report.varying.filter((name) => group.params[name] !== undefined).map((name) => {
            const value = text(group.params[name]);
            if (letters[name]) return letters[name] + value;
            return typeof group.params[name] === "string" ? value : `${name} ${value}`;
        }).join(" ");
    }

    function field(group, rank, isBest) {
        const cell = document.createElement("td");
        if (!group) {
            cell.textContent = "·";
            return cell;
        }
        const button = document.createElement("button");
        const remark = document.createElement("small");
        button.type = "button";
        button.append(fieldText(group), isBest ? " ★" : "");
        remark.textContent = shortParameters(group);
        button.append(remark);
        button.title = `${group.group}: ${metric().name} ${fieldText(group)} ${metric().unit}`;
        if (!Number.isNaN(rank)) paint(button, rank);
        button.addEventListener("click", () => viewer.open(group.id) || (location.hash = group.id));
        cell.append(button);
        return cell;
    }

    function heading(name, scope) {
        const cell = document.createElement("th");
        cell.scope = scope;
        cell.textContent = name.replaceAll("_", "_\u200b"); // where it may break
        return cell;
    }

    function fields() {
        const found = new Map();
        for (const scene of report.scenes) {
            const row = methods.map((method) => fieldGroup(scene, method));
            const usable = row.filter((g) => g && !isBound(g) && metric().of(g));
            found.set(scene, { row, best: usable.length > 1 ? usable.reduce(better) : null });
        }
        return found;
    }

    function draw() {
        const found = fields();
        const rank = rankOf([...found.values()].flatMap(({ row }) => row).filter(Boolean));
        const at = (scene, m) => {
            const { row, best } = found.get(scene);
            return field(row[m], row[m] ? rank(row[m]) : NaN, row[m] !== null && row[m] === best);
        };
        const [rows, columns] = isTall ? [methods, report.scenes] : [report.scenes, methods];
        const head = document.createElement("tr");
        head.append(document.createElement("td"), ...columns.map((name) => heading(name, "col")));
        const body = rows.map((name, i) => {
            const line = document.createElement("tr");
            line.append(heading(name, "row"), ...columns.map((other, j) => (isTall ? at(other, i) : at(name, j))));
            return line;
        });
        drawRamp();
        table.createTHead().replaceChildren(head);
        (table.tBodies[0] ?? table.createTBody()).replaceChildren(...body);
    }

    function option(label, value = label) {
        return new Option(label, value);
    }

    /// A choice per parameter that has several values; the smallest factor, and the best of all else, to begin with.
    function addChoice(name) {
        const values = [...new Set(report.groups.map((g) => g.params[name]).filter((v) => v !== undefined && v !== null).map(text))];
        if (values.length < 2) return;
        const label = document.createElement("label");
        const select = document.createElement("select");
        select.dataset.name = name;
        select.append(option("best", ""), ...values.sort((a, b) => Number(a) - Number(b)).map((value) => option(value)));
        if (name === "reduction") select.value = values.find((v) => Number(v) > 1) ?? "";
        select.addEventListener("change", draw);
        label.append(`${name} `, select);
        parameterChoices.append(label);
    }

    function drawRamp() {
        const colours = Array.from({ length: 12 }, (_, i) => panes.cssColour("magnitude", 0.12 + (0.84 * i) / 11, 1));
        document.getElementById("matrix-ramp").style.background = `linear-gradient(to right, ${colours.join(", ")})`;
    }

    metricChoice.append(...metrics.map((m) => option(`${m.name}${m.unit ? `, ${m.unit}` : ""} ${m.isHigher ? "↑" : "↓"}`)));
    metricChoice.addEventListener("change", draw);
    report.varying.forEach(addChoice);
    return { draw };
})();
