"""Headless Chromium for tests: a picture of a page, its print, and what it wrote to its console."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from PIL import Image

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
OPTIONS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--hide-scrollbars",
    "--enable-logging=stderr",
    "--virtual-time-budget=60000",
    "--no-pdf-header-footer",
)


class Shown(NamedTuple):
    """A picture, shape (height, width, 3), and the lines of the console."""

    pixels: np.ndarray
    console: list[str]


def browser() -> str:
    """The program; skips the test where there is none."""
    found = next(filter(None, map(shutil.which, NAMES)), None)
    if found is None:
        pytest.skip(
            "no Chromium on this machine (Debian: apt-get install chromium): the report is not rendered"
        )
    return found


def show(page: Path, place: Path, width: int = 1300, height: int = 6000, *options: str) -> Shown:
    """Open a file as a user would, wait until it is drawn, and look."""
    picture = place / "page.png"
    said = run(page, place, f"--screenshot={picture}", f"--window-size={width},{height}", *options)
    with Image.open(picture) as image:
        return Shown(np.asarray(image.convert("RGB")), said)


def print_out(page: Path, place: Path) -> Path:
    """The page as PDF."""
    run(page, place, f"--print-to-pdf={place / 'page.pdf'}")
    return place / "page.pdf"


def run(page: Path, place: Path, *options: str) -> list[str]:
    """Run the browser; returns what the page wrote to its console, policy violations and network failures
    included.
    """
    words = [browser(), *OPTIONS, f"--user-data-dir={place / 'profile'}", *options, page.resolve().as_uri()]
    done = subprocess.run(words, capture_output=True, text=True, timeout=180, check=False)
    assert done.returncode == 0, done.stderr[-2000:]
    return [line for line in done.stderr.splitlines() if re.search(r"CONSOLE", line)]


def share(pixels: np.ndarray, colour: str, tolerance: int = 12) -> float:
    """Share of the pixels that have a colour such as ``#0072B2``."""
    wanted = np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])
    return float(
        np.mean(np.all(np.abs(pixels.astype(np.int16) - wanted.astype(np.int16)) <= tolerance, axis=-1))
    )
