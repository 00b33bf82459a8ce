"""Pictures of the scene as the native viewer draws it: flames, skies, shapes, each known by its pixels."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from made_up import SHELL, synthetic_flight
from PIL import Image

import edl6dof
from edl6dof.replay.recording import history, write_replay
from edl6dof.replay.scene.poses import Site
from edl6dof.replay.viewer import NoViewer, screenshot
from edl6dof.spatial import rotations as turns

pytest.importorskip("rerun")

SIZE = (960, 600)


def chase(flight, t: float, folder: Path) -> np.ndarray:
    """The chase view at a time (s), RGB."""
    write_replay([history(flight)], folder / "replay.rrd")
    try:
        screenshot(folder / "replay.rrd", folder / "shot.png", t, SIZE)
    except NoViewer as missing:
        pytest.skip(str(missing))
    with Image.open(folder / "shot.png") as image:
        pixels = np.asarray(image.convert("RGB")).astype(int)
    return pixels[int(0.165 * SIZE[1]) : int(0.75 * SIZE[1]), : int(0.38 * SIZE[0])]


def share(pixels: np.ndarray, low: tuple[int, int, int], high: tuple[int, int, int]) -> float:
    """Share of the pixels between two colours."""
    return float(np.mean(np.all((pixels >= low) & (pixels <= high), axis=-1)))


def flames(pixels: np.ndarray) -> float:
    """Share of the pixels that are as bright and yellow as the core of a flame."""
    return share(pixels, (250, 205, 120), (255, 255, 225))


def engine_alone() -> SimpleNamespace:
    """The made-up flight upright, without canopy, which the camera would stand back for, and with silent
    thrusters.
    """
    flight = synthetic_flight()
    rows = len(flight.telemetry["t_s"])
    flight.telemetry |= {f"rcs.{jet}": np.zeros(rows) for jet in flight.scenario.thruster_names}
    down = turns.from_x_to(np.array([0.0, 0.0, -1.0]))
    to_site = turns.from_axes(Site(flight.scenario).axes)
    upright = turns.multiply(to_site * [1.0, -1.0, -1.0, -1.0], down)
    for axis, value in zip("wxyz", upright, strict=True):
        flight.telemetry[f"truth.q_I2B_{axis}"] = np.full(rows, value)
    flight.telemetry |= {f"truth.canopy_{axis}_m": np.full(rows, np.nan) for axis in ("east", "north", "up")}
    return flight


@pytest.mark.long
def test_an_engine_that_never_ignites_has_no_pixel_of_a_flame(tmp_path):
    flight = engine_alone()
    assert flames(chase(flight, SHELL + 4.5, tmp_path)) > 2e-4
    flight.telemetry["truth.engine_thrust_n"] = np.zeros(len(flight.telemetry["t_s"]))
    assert flames(chase(flight, SHELL + 4.5, tmp_path)) == 0.0


def test_a_ball_over_the_earth_is_a_ball_under_a_blue_sky(tmp_path):
    flight = edl6dof.fly("nesc/case06", ["simulation.time_limit_s=2.0"])
    pixels = chase(flight, 1.0, tmp_path)
    above = pixels[: len(pixels) // 5].reshape(-1, 3)
    assert np.mean(above[:, 2] > above[:, 0] + 15) > 0.9, "blue above"
    ball = np.all((pixels > 190) & (np.ptp(pixels, axis=-1, keepdims=True) < 25), axis=-1)
    ball |= (pixels[..., 0] > 150) & (pixels[..., 2] < 90)  # its white and its orange fields
    ball[: len(ball) // 4] = False  # the scale bar
    rows, columns = np.flatnonzero(ball.sum(axis=1) > 8), np.flatnonzero(ball.sum(axis=0) > 8)
    assert np.ptp(rows) == pytest.approx(np.ptp(columns), rel=0.12), "as high as wide"
    assert ball.mean() > 0.04
    assert share(pixels, (30, 44, 95), (46, 62, 130)) < 1e-4, "no solar panel of a rover"
    assert share(pixels, (190, 135, 50), (230, 175, 75)) < 1e-3, "no foil of a lander"
