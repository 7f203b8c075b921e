// SPDX-License-Identifier: Apache-2.0
//
// What the report can do beyond being read: a sortable and filtered table, and a viewer for the pictures. The page is
// whole without it, but for the charts (charts.js, which stands before this one).
"use strict";

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
    let zoom = { scale: 1, x: 0, y: 0 }; // over what fits; kept while flipping, so that pictures compare

    function applyZoom() {
        [zoom.x, zoom.y] = zoom.scale > 1 ? [Math.max(-0.5, Math.min(0.5, zoom.x)), Math.max(-0.5, Math.min(0.5, zoom.y))] : [0, 0];
        const image = part("image");
        image.style.transform = `scale(${zoom.scale}) translate(${100 * zoom.x}%, ${100 * zoom.y}%)`;
        image.classList.toggle("enlarged", zoom.scale > 1 || image.dataset.grown === "1");
        part("stage").classList.toggle("zoomed", zoom.scale > 1);
    }

    function zoomBy(factor) {
        zoom.scale = Math.max(1, Math.min(64, zoom.scale * factor));
        applyZoom();
    }

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
        image.dataset.grown = scale > 1 ? "1" : "0";
        image.style.width = `${image.naturalWidth * scale}px`;
        image.style.height = `${image.naturalHeight * scale}px`;
        applyZoom();
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
        const card = shot.dataset.of ? document.getElementById(shot.dataset.of) : shot.closest(".card");
        const own = cards.indexOf(card);
        index = own >= 0 ? own : Math.max(0, cards.findIndex((c) => c.dataset.reference === card.id));
        view = Number(shot.dataset.view);
        viewer.showModal();
        show();
        viewer.querySelector(`[data-view="${view}"]`).focus();
    }

    const acts = {
        close: () => viewer.close(), previous: () => step(-1), next: () => step(1),
        larger: () => zoomBy(1.5), smaller: () => zoomBy(1 / 1.5), fit: () => zoomBy(0),
    };
    const keys = { ArrowLeft: acts.previous, ArrowRight: acts.next, "+": acts.larger, "=": acts.larger, "-": acts.smaller, 0: acts.fit };

    function dragging() {
        const image = part("image");
        let from = null;
        let moved = false;
        image.addEventListener("pointerdown", (event) => {
            from = [event.clientX, event.clientY];
            moved = false;
            image.setPointerCapture(event.pointerId);
            event.preventDefault();
        });
        image.addEventListener("pointermove", (event) => {
            if (!from) return;
            const [dx, dy] = [event.clientX - from[0], event.clientY - from[1]];
            if (!moved && Math.hypot(dx, dy) < 4) return;
            moved = true;
            const box = image.getBoundingClientRect(); // as zoomed
            zoom.x += dx / box.width;
            zoom.y += dy / box.height;
            from = [event.clientX, event.clientY];
            applyZoom();
        });
        image.addEventListener("pointerup", () => { from = null; });
        image.addEventListener("click", () => moved || flip((view % 4) + 1));
        part("stage").addEventListener("wheel", (event) => {
            event.preventDefault();
            zoomBy(event.deltaY < 0 ? 1.2 : 1 / 1.2);
        }, { passive: false });
    }

    /// Mosaics show the pictures of cards again.
    function borrow(shot) {
        const from = document.querySelector(`#${shot.dataset.of} .shot[data-view="${shot.dataset.view}"] img`);
        const image = shot.querySelector("img");
        if (!from) return shot.replaceChildren("no picture");
        image.width = from.width;
        image.height = from.height;
        image.className = from.className;
        image.src = from.src;
    }

    /// A picture beside the file is gone once the file was moved.
    function missing(event) {
        const note = document.createElement("span");
        note.textContent = `not in this file: ${event.target.getAttribute("src")}`;
        event.target.replaceWith(note);
    }

    all("button[data-of]").forEach(borrow);
    all(".shot img").forEach((image) => image.addEventListener("error", missing));
    if (cards.length === 0) return;
    all("button.shot").forEach((shot) => shot.addEventListener("click", () => open(shot)));
    all("[data-view]", viewer).forEach((b) => b.addEventListener("click", () => flip(Number(b.dataset.view))));
    all("[data-act]", viewer).forEach((b) => b.addEventListener("click", acts[b.dataset.act]));
    dragging();
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
    convergence.draw();
})();
