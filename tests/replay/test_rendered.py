"""The replay drawn for real: by the native viewer without a window, and by Chromium from the HTML file."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest
from live_page import opened, settled, wait_until_it_plays
from PIL import Image

from edl6dof.replay import browser
from edl6dof.replay.viewer import NoViewer, screenshot
from edl6dof.report.palette import BLACK, BLUE, rgb

SIZE = (1280, 800)
#: Of a browser, which draws without graphics hardware: the smaller, the sooner.
WINDOW = (800, 500)
SMALLEST = (320, 240)


@pytest.fixture(scope="module")
def picture(recording, tmp_path_factory) -> np.ndarray:
    """The replay at 16 s: the lander alone under its engine."""
    path = tmp_path_factory.mktemp("shot") / "shot.png"
    try:
        screenshot(recording, path, 16.0, SIZE)
    except NoViewer as missing:
        pytest.skip(str(missing))
    with Image.open(path) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def share(pixels: np.ndarray, low: Sequence[int] | np.ndarray, high: Sequence[int] | np.ndarray) -> float:
    """Share of the pixels between two colours."""
    return float(np.mean(np.all((pixels >= low) & (pixels <= high), axis=-1)))


def share_of(pixels: np.ndarray, colour: str) -> float:
    """Share of the pixels of about a colour of the palette as it is on a dark ground."""
    near = np.array(rgb(colour))
    return share(pixels, near - 15, near + 15)


def ground_is_drawn(pixels: np.ndarray) -> bool:
    """Whether the lower half of the chase view is rust-coloured."""
    height, width, _ = pixels.shape
    return (
        share(
            pixels[int(0.48 * height) : int(0.75 * height), : int(0.44 * width)],
            (90, 40, 20),
            (235, 175, 130),
        )
        > 0.3
    )


def curves_are_drawn(pixels: np.ndarray) -> bool:
    """Whether the plots on the right hold blue curves."""
    return share_of(pixels[:, int(0.58 * pixels.shape[1]) :], BLUE) > 3e-4


def test_terrain_sky_vehicle_path_and_failure_are_in_the_chase_view(picture):
    height, width, _ = picture.shape
    assert (width, height) == SIZE
    chase = picture[int(0.12 * height) : int(0.75 * height), : int(0.39 * width)]
    below, above = chase[len(chase) // 2 :], chase[: len(chase) // 5]
    assert share(below, (90, 40, 20), (235, 175, 130)) > 0.5, "rust-coloured ground"
    assert share(above, (120, 85, 60), (235, 190, 160)) > 0.5, "dusty sky"
    assert share(chase, (185, 185, 180), (245, 245, 240)) > 5e-4, "the white backshell"
    assert share_of(chase, BLACK) > 8e-4, "the path in the colour of its phase"
    assert share(chase, (225, 90, 90), (255, 140, 140)) > 3e-4, "the thruster that was found to have failed"


def test_curves_and_phase_colours_are_painted(picture):
    height, width, _ = picture.shape
    plots = picture[int(0.35 * height) : int(0.78 * height), int(0.58 * width) :]
    assert share_of(plots, BLUE) > 5e-4, "the blue curves"
    lanes = picture[int(0.8 * height) : int(0.97 * height), : int(0.57 * width)]
    assert len(np.unique(lanes[:, ::4].reshape(-1, 3), axis=0)) > 20, "lanes in the colours of the phases"


@pytest.fixture
def page(recording, tmp_path):
    """The HTML file of the replay."""
    path = tmp_path / "replay.html"
    path.write_bytes(browser.page(recording, "made up & <tested>"))
    return path


def test_html_file_plays_from_disk_without_network_or_error(page, tmp_path):
    assert "https://" not in page.read_text(encoding="utf-8").split("<script>")[0]
    with opened(page.resolve().as_uri(), tmp_path / "profile", SMALLEST) as browser:
        wait_until_it_plays(browser)
        assert browser.problems == []
        assert browser.value("document.title") == "made up & <tested>"


@pytest.mark.long
def test_html_file_shows_the_ground_and_the_curves(page, tmp_path):
    with opened(page.resolve().as_uri(), tmp_path / "profile", WINDOW) as browser:
        shown = settled(browser, lambda pixels: ground_is_drawn(pixels) and curves_are_drawn(pixels))
        assert browser.problems == []
    assert ground_is_drawn(shown.astype(int))
    assert curves_are_drawn(shown.astype(int))
