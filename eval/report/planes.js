// SPDX-License-Identifier: Apache-2.0
//
// The float values behind the pictures. They lie beside the page as scripts that call vecinoPlane() (a page on disk may load
// scripts, but not read files), or inside of it; where neither is there, the page's own 8-bit pictures stand in.
"use strict";

const planes = (() => {
    const { folder, embedded, precision } = report.viewer;
    const mostBytes = 96e6; // of planes that are kept; the longest unused goes first
    const kept = new Map();
    const waiting = new Map();

    function bytesOf(base64) {
        if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
        const text = atob(base64);
        const bytes = new Uint8Array(text.length);
        for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
        return bytes;
    }

    function floats(base64, width, height) {
        const bytes = bytesOf(base64);
        if (bytes.length !== 12 * width * height) throw new Error("the file with float values is damaged");
        const values = new Float32Array(3 * width * height);
        const data = new DataView(bytes.buffer, bytes.byteOffset);
        for (let i = 0; i < values.length; ++i) values[i] = data.getFloat32(4 * i, true);
        return values;
    }

    function half(bits) {
        const sign = bits & 0x8000 ? -1 : 1;
        const [exponent, fraction] = [(bits >> 10) & 31, bits & 1023];
        if (exponent === 31) return fraction ? NaN : sign * Infinity;
        return sign * (exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -14 * (fraction / 1024));
    }

    /// From differences to a reference; where that is no number, they are the values.
    function restored(base64, reference) {
        const bytes = bytesOf(base64);
        const data = new DataView(bytes.buffer, bytes.byteOffset);
        return reference.values.map((r, i) => half(data.getUint16(2 * i, true)) + (Number.isFinite(r) ? r : 0));
    }

    const complete = (plane) => ({ ...plane, nonFinite: errors.nonFinite(plane) });

    function keep(id, plane) {
        kept.delete(id);
        kept.set(id, plane);
        let bytes = 0;
        for (const each of kept.values()) bytes += each.values.byteLength;
        for (const [oldest, each] of kept) {
            if (bytes <= mostBytes || oldest === id) break;
            kept.delete(oldest);
            bytes -= each.values.byteLength;
        }
        return plane;
    }

    /// What a script beside the page calls.
    function receive(head, base64) {
        const { id, width, height } = head;
        waiting.get(id)?.({ width, height, precision: "float32", values: floats(base64, width, height) });
    }

    function fromScript(id) {
        return new Promise((resolve, reject) => {
            const script = document.createElement("script");
            const path = (text) => text.split("/").map(encodeURIComponent).join("/");
            const done = () => { script.remove(); waiting.delete(id); };
            waiting.set(id, resolve);
            script.src = `${path(folder)}/${path(id)}.js`;
            script.onload = () => { done(); reject(new Error(`${folder}/${id}.js holds no plane`)); };
            script.onerror = () => { done(); reject(new Error(`${folder}/${id}.js is not there`)); };
            document.head.append(script);
        });
    }

    async function fromPage(id, referenceId) {
        const element = document.querySelector(`script.plane[data-id="${CSS.escape(id)}"]`);
        if (!element) throw new Error(`the page holds no values of ${id}`);
        const [width, height] = [Number(element.dataset.width), Number(element.dataset.height)];
        const isHalf = precision === "float16" && referenceId;
        const values = isHalf ? restored(element.textContent, await load(referenceId))
            : floats(element.textContent, width, height);
        return { width, height, precision: isHalf ? "float16" : "float32", values };
    }

    /// An 8-bit picture, decoded to linear values.
    async function fromPicture(image) {
        if (!image) throw new Error("there is no picture either");
        image.loading = "eager";
        await image.decode();
        const canvas = document.createElement("canvas");
        [canvas.width, canvas.height] = [image.naturalWidth, image.naturalHeight];
        const context = canvas.getContext("2d");
        context.drawImage(image, 0, 0);
        const { data, width, height } = context.getImageData(0, 0, canvas.width, canvas.height);
        const linear = Float32Array.from({ length: 256 }, (_, i) => errors.decode(i / 255));
        const values = new Float32Array(3 * width * height);
        for (let i = 0; i < values.length; ++i) values[i] = linear[data[4 * Math.floor(i / 3) + (i % 3)]];
        return { width, height, precision: "8 bit", values };
    }

    /// A plane by its id: {width, height, values, precision, nonFinite}. referenceId: of what it is a difference from, if
    /// it is one. picture: an image of the page to fall back on.
    async function load(id, referenceId, picture) {
        if (kept.has(id)) return keep(id, kept.get(id));
        const from = embedded ? fromPage(id, referenceId) : fromScript(id);
        const plane = await from.catch((error) => fromPicture(picture).catch(() => { throw error; }));
        return keep(id, complete(plane));
    }

    /// One load at a time of each.
    const loading = new Map();
    function loadOnce(id, ...more) {
        if (!loading.has(id)) loading.set(id, load(id, ...more).finally(() => loading.delete(id)));
        return loading.get(id);
    }

    const has = (id) => kept.has(id);
    return { load: loadOnce, receive, has };
})();

function vecinoPlane(head, base64) { // eslint-disable-line no-unused-vars
    planes.receive(head, base64);
}
