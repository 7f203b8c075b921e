# SPDX-License-Identifier: Apache-2.0
"""Drives a headless Chromium over its debugging pipe, with the standard library alone."""

import base64
import fcntl
import json
import os
import select
import shutil
import subprocess
import tempfile
import time

PATIENCE_S = 180  # for anything that is bound to happen; machines may be busy


class NoBrowser(Exception):
    """No Chromium that works; says what was tried."""


class PageError(Exception):
    """The page threw, or something that should come about did not."""


def find_browser():
    names = [os.environ.get("VECINO_CHROMIUM"), "chromium", "chromium-browser", "google-chrome"]
    for name in filter(None, names):
        if shutil.which(name):
            return shutil.which(name)
    raise NoBrowser("none of chromium, chromium-browser, google-chrome is installed (or name one in VECINO_CHROMIUM)")


class Browser:
    """One page of a browser of its own. To be used in a with statement."""

    def __init__(self):
        self.profile = tempfile.TemporaryDirectory(prefix="vecino-browser-", ignore_cleanup_errors=True)
        self.errors = []  # what the page threw or logged as an error
        self._next, self._answers, self._events, self._buffer, self._session = 0, {}, [], b"", None
        self._start(find_browser())
        try:
            self.version = self.call("Browser.getVersion")["product"]
            target = self.call("Target.createTarget", url="about:blank")["targetId"]
            self._session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        except PageError as error:
            self.close()
            raise NoBrowser(f"{find_browser()} does not work: {error}") from error
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")

    def _start(self, program):
        # Pipes away from 3 and 4, where the browser looks for them: 3 to read, 4 to write.
        def pipe():
            ends = os.pipe()
            high = [fcntl.fcntl(end, fcntl.F_DUPFD_CLOEXEC, 10) for end in ends]
            for end in ends:
                os.close(end)
            return high

        (their_in, self._out), (self._in, their_out) = pipe(), pipe()

        def place():
            os.dup2(their_in, 3)
            os.dup2(their_out, 4)

        options = ("--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
                   "--force-color-profile=srgb", "--hide-scrollbars", "--remote-debugging-pipe")
        self._log = tempfile.TemporaryFile()
        self._process = subprocess.Popen([program, *options, f"--user-data-dir={self.profile.name}"], preexec_fn=place,
                                         pass_fds=(3, 4), stdin=subprocess.DEVNULL, stdout=self._log, stderr=self._log)
        os.close(their_in)
        os.close(their_out)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        self._process.terminate()
        try:
            self._process.wait(20)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._in)
        os.close(self._out)
        self.profile.cleanup()

    # ---- Messages ------------------------------------------------------------------------------------------------------------

    def _said(self):
        self._log.seek(0)
        return self._log.read().decode(errors="replace").strip()[-500:] or "it said nothing"

    def _receive(self, deadline):
        """Reads what there is; an answer or an event at least."""
        while b"\0" not in self._buffer:
            if not select.select([self._in], [], [], max(0, deadline - time.monotonic()))[0]:
                raise PageError(f"no answer within {PATIENCE_S} s: {self._said()}")
            data = os.read(self._in, 1 << 20)
            if not data:
                raise PageError(f"it ended: {self._said()}")
            self._buffer += data
        *messages, self._buffer = self._buffer.split(b"\0")
        for message in map(json.loads, messages):
            if "id" in message:
                self._answers[message["id"]] = message
            else:
                self._note(message)

    def _note(self, event):
        self._events.append(event["method"])
        if event["method"] == "Runtime.exceptionThrown":
            details = event["params"]["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        if event["method"] == "Log.entryAdded" and event["params"]["entry"]["level"] == "error":
            self.errors.append(event["params"]["entry"]["text"] + " " + event["params"]["entry"].get("url", ""))

    def call(self, method, **params):
        self._next += 1
        own, message = self._next, {"id": self._next, "method": method, "params": params}
        if self._session:
            message["sessionId"] = self._session
        try:
            os.write(self._out, json.dumps(message).encode() + b"\0")
        except BrokenPipeError:
            raise PageError(f"it ended: {self._said()}") from None
        deadline = time.monotonic() + PATIENCE_S
        while own not in self._answers:
            self._receive(deadline)
        answer = self._answers.pop(own)
        if "error" in answer:
            raise PageError(f"{method}: {answer['error']['message']}")
        return answer["result"]

    # ---- What a reader does --------------------------------------------------------------------------------------------------

    def resize(self, width, height):
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def open(self, url):
        self._events.clear()
        self.call("Page.navigate", url=url)
        deadline = time.monotonic() + PATIENCE_S
        while "Page.loadEventFired" not in self._events:
            self._receive(deadline)

    def value(self, expression):
        """What JavaScript gives, promises awaited."""
        answer = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            details = answer["exceptionDetails"]
            raise PageError(details.get("exception", {}).get("description", details["text"]))
        return answer["result"].get("value")

    def wait_until(self, expression):
        """Until an expression is true, looked at between frames."""
        deadline = time.monotonic() + PATIENCE_S
        while not self.value(f"new Promise((done) => requestAnimationFrame(() => setTimeout(() => done(Boolean({expression})))))"):
            if time.monotonic() > deadline:
                raise PageError(f"not true within {PATIENCE_S} s: {expression}")

    def mouse(self, kind, x, y, **more):
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def click(self, x, y):
        self.mouse("mouseMoved", x, y)
        self.mouse("mousePressed", x, y, button="left", clickCount=1)
        self.mouse("mouseReleased", x, y, button="left", clickCount=1)

    def drag(self, start, end):
        self.mouse("mouseMoved", *start)
        self.mouse("mousePressed", *start, button="left", buttons=1, clickCount=1)
        for t in (0.5, 1):
            at = [a + t * (b - a) for a, b in zip(start, end)]
            self.mouse("mouseMoved", *at, button="left", buttons=1)
        self.mouse("mouseReleased", *end, button="left", clickCount=1)

    def touch(self, kind, points):
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=[{"x": x, "y": y, "id": i} for i, (x, y) in enumerate(points)])

    def middle(self, selector):
        """Of the first element that fits, brought into sight."""
        found = self.value(f"""(() => {{
            const element = document.querySelector({json.dumps(selector)});
            element?.scrollIntoView({{ block: "center", behavior: "instant" }});
            const box = element?.getBoundingClientRect();
            return box ? [box.x + box.width / 2, box.y + box.height / 2] : null; }})()""")
        if not found:
            raise PageError(f"nothing on the page fits {selector}")
        return found

    def click_on(self, selector):
        self.click(*self.middle(selector))

    def key(self, key, shift=False):
        """A key with what it types, if it is a character; modifiers 8 is shift."""
        text = {"text": key} if len(key) == 1 else {"Enter": {"text": "\r"}}.get(key, {})
        codes = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "Tab": 9, "Enter": 13, "Escape": 27, "Home": 36}
        common = {"key": key, "modifiers": 8 if shift else 0, "windowsVirtualKeyCode": codes.get(key, ord(key.upper()) if len(key) == 1 and key.isalnum() else 0)}
        self.call("Input.dispatchKeyEvent", type="keyDown", **common, **text)
        self.call("Input.dispatchKeyEvent", type="keyUp", **common)

    def screenshot(self, path, whole=False):
        data = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole)["data"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(data))
