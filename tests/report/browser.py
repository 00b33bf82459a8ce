"""Pages as a browser shows them: a picture, a print, and what a page wrote to its console."""

from __future__ import annotations

import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
from live_page import Page

#: Whether the page that was asked for is there, with all its plots.
DRAWN = """location.href === %r && document.readyState === "complete" &&
    (!document.querySelector("div.plot") || !!document.documentElement.dataset.drawn)"""


class Shown(NamedTuple):
    """A picture, shape (height, width, 3), and the lines of the console."""

    pixels: np.ndarray
    console: list[str]


def show(browser: Page, page: Path, width: int = 1300, height: int = 6000, *, dark: bool = False) -> Shown:
    """Open a file as a user would, wait until it is drawn, and look; ``dark``: to one who prefers it so."""
    browser.said.clear()
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    browser.ask("Emulation.setEmulatedMedia", features=[scheme])
    metrics = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    browser.ask("Emulation.setDeviceMetricsOverride", **metrics)
    address = page.resolve().as_uri()
    browser.ask("Page.navigate", url=address)
    end = time.monotonic() + 180.0
    while not browser.value(DRAWN % address):
        assert time.monotonic() < end, browser.said
        time.sleep(0.05)
    return Shown(browser.picture(), list(browser.said))


def share(pixels: np.ndarray, colour: str, tolerance: int = 12) -> float:
    """Share of the pixels that have a colour such as ``#0072B2``."""
    wanted = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    return float(
        np.mean(np.all(np.abs(pixels.astype(np.int16) - wanted.astype(np.int16)) <= tolerance, axis=-1))
    )
