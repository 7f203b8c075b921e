// SPDX-License-Identifier: Apache-2.0
//
// What ties the page together: pictures that open the viewer or stand in several places, and the first drawing of charts.
"use strict";

(() => {
    const kinds = { 3: "magnitude", 4: "sign" };

    function open(shot) {
        const id = shot.dataset.of ?? shot.closest(".card").id;
        viewer.open(id, { kind: kinds[shot.dataset.view], isReference: shot.dataset.view === "2" });
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
    all("button.shot").forEach((shot) => shot.addEventListener("click", () => open(shot)));

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
    matrix.draw();
    viewer.follow();
})();
