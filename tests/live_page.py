"""A page that draws itself for as long as it is looked at: Chromium without a window, steered by its
debugging protocol.

The picture that ``--screenshot`` takes comes before the viewer has unpacked itself; this waits until it has
drawn what is asked for.
"""

from __future__ import annotations

import base64
import io
import itertools
import json
import os
import shutil
import socket
import struct
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
OPTIONS = ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--hide-scrollbars")
#: For pages that draw with WebGL, and for others.
GL, NO_GL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader"), ("--disable-gpu",)


class Page:
    """One page of a running browser."""

    def __init__(self, address: str) -> None:
        host, _, path = address.removeprefix("ws://").partition("/")
        name, port = host.split(":")
        self._socket = socket.create_connection((name, int(port)), timeout=60.0)
        key = base64.b64encode(os.urandom(16)).decode()
        wanted = f"GET /{path} HTTP/1.1\r\nHost: {host}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
        self._socket.sendall(
            f"{wanted}Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
        )
        self._stream = self._socket.makefile("rb")
        while self._stream.readline().strip():
            pass
        self._numbers = itertools.count(1)
        self.problems: list[str] = []  #: errors that the console and the log showed
        self.said: list[str] = []  #: these, and whatever else the page wrote to its console
        for domain in ("Page", "Runtime", "Log"):
            self.ask(f"{domain}.enable")

    def ask(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command and wait for its answer; errors met meanwhile are kept."""
        number = next(self._numbers)
        self._send(json.dumps({"id": number, "method": method, "params": parameters}).encode())
        while True:
            said = json.loads(self._receive())
            if said.get("id") == number:
                assert "error" not in said, said["error"]
                return said.get("result", {})
            self._note(said)

    def picture(self) -> np.ndarray:
        """What the page shows, shape (height, width, 3)."""
        content = base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"])
        with Image.open(io.BytesIO(content)) as image:
            return np.asarray(image.convert("RGB"))

    def value(self, expression: str) -> Any:
        """Value of a script expression."""
        return self.ask("Runtime.evaluate", expression=expression, returnByValue=True)["result"].get("value")

    def printed(self) -> bytes:
        """The page on paper, PDF."""
        asked = {"preferCSSPageSize": True, "printBackground": True}
        return base64.b64decode(self.ask("Page.printToPDF", **asked)["data"])

    def _note(self, said: dict[str, Any]) -> None:
        method, what = said.get("method"), said.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = what["exceptionDetails"]
            words = f"{details.get('text')} {details.get('exception', {}).get('description', '')}"
            self._heard(words, is_error=True)
        if method == "Runtime.consoleAPICalled":
            words = " ".join(str(part.get("value", part.get("description"))) for part in what["args"])
            self._heard(words, is_error=what["type"] in ("error", "assert"))
        if method == "Log.entryAdded":
            self._heard(what["entry"]["text"], is_error=what["entry"]["level"] == "error")

    def _heard(self, words: str, *, is_error: bool) -> None:
        self.said.append(words)
        if is_error:
            self.problems.append(words)

    def _send(self, content: bytes) -> None:
        mask = os.urandom(4)
        size = len(content)
        head = (
            struct.pack("!BB", 0x81, 0x80 | size)
            if size < 126
            else struct.pack("!BBH", 0x81, 0x80 | 126, size)
        )
        self._socket.sendall(head + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(content)))

    def _receive(self) -> bytes:
        content, last = b"", False
        while not last:
            first, size = self._stream.read(2)
            last = bool(first & 0x80)
            if size > 125:
                (size,) = struct.unpack(
                    "!H" if size == 126 else "!Q", self._stream.read(2 if size == 126 else 8)
                )
            content += self._stream.read(size)
        return content


def browser() -> str:
    """The program; skips the test where there is none."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        pytest.skip(
            "no Chromium on this machine (Debian: apt-get install chromium): the page is not rendered"
        )
    return found


@contextmanager
def opened(
    address: str, profile: Path, size: tuple[int, int] = (1400, 850), options: tuple[str, ...] = GL
) -> Iterator[Page]:
    """The page at an address in a browser; skips the test where there is none."""
    words = [
        browser(),
        *OPTIONS,
        *options,
        f"--window-size={size[0]},{size[1]}",
        f"--user-data-dir={profile}",
        "--remote-debugging-port=0",
        "about:blank",
    ]
    running = subprocess.Popen(
        words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True
    )
    try:
        line = next(line for line in running.stderr if "DevTools listening on" in line)
        port = line.split("ws://")[1].split("/")[0]
        page = Page(_page_of(port))
        page.ask("Page.navigate", url=address)
        yield page
    finally:
        running.terminate()
        running.wait(timeout=20.0)


def wait_until_it_plays(page: Page, most_s: float = 150.0) -> None:
    """Return once the viewer has been started and was handed the recording; skips the test where the
    browser, which may have lost its graphics process, draws WebGL 2 for nobody.
    """
    end = time.monotonic() + most_s
    state = None
    while time.monotonic() < end and state not in ("playing", "failed"):
        time.sleep(0.5)
        state = page.value("document.documentElement.dataset.state")
    if state == "failed" and not page.value("!!new OffscreenCanvas(1, 1).getContext('webgl2')"):
        pytest.skip("the browser on this machine draws no WebGL 2: the replay page is not rendered")
    assert state == "playing", page.value("document.body.innerText")


def settled(page: Page, drawn: Callable[[np.ndarray], bool], most_s: float = 150.0) -> np.ndarray:
    """The picture once the replay plays and what is waited for is drawn; the last picture when it never
    is.
    """
    end = time.monotonic() + most_s
    wait_until_it_plays(page, most_s)
    shown = page.picture()
    while time.monotonic() < end and not drawn(shown):
        time.sleep(1.0)
        shown = page.picture()
    return shown


def _page_of(port: str) -> str:
    import urllib.request

    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with opener.open(f"http://{port}/json/list", timeout=20.0) as answer:
        return next(
            target["webSocketDebuggerUrl"] for target in json.load(answer) if target["type"] == "page"
        )
