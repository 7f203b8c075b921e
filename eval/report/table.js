// SPDX-License-Identifier: Apache-2.0
//
// Sorting and filtering of the results table.
"use strict";

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

    /// Words that all must occur, or a regular expression between slashes. None: it is not a valid one (yet).
    function matcher(text) {
        const expression = /^\/(.+?)\/?$/.exec(text);
        if (!expression) {
            const words = text.toLowerCase().split(/\s+/).filter(Boolean);
            return (row) => words.every((word) => row.includes(word));
        }
        try {
            const regex = new RegExp(expression[1], "i");
            return (row) => regex.test(row);
        } catch {
            return null;
        }
    }

    const count = document.getElementById("table-count");
    const words = new Map(original.map((row) => [row, row.dataset.words.toLowerCase()]));
    document.getElementById("table-filter").addEventListener("input", (event) => {
        const text = event.target.value.trim();
        const matches = matcher(text);
        event.target.setAttribute("aria-invalid", String(!matches));
        if (!matches) {
            count.textContent = "not a regular expression yet";
            return;
        }
        const visible = original.filter((row) => !(row.hidden = !matches(words.get(row)))).length;
        count.textContent = text ? `${visible} of ${original.length} rows` : "";
    });
})();

