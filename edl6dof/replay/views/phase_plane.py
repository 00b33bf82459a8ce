"""Phase planes: attitude error against its rate, axis by axis, with the switching lines and zones of the
controller at work.

Error is goal minus actual, as the controllers have it; the rate is the body's (bank control subtracts the
slow turn of the velocity frame).  Both axes are compressed beyond about one unit (arsinh), so that a bank
reversal and the last tenth of a degree fit into one picture.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from edl6dof.replay.history import thin, vector
from edl6dof.replay.recorder import SLOW_HZ, Recorder
from edl6dof.report.figure import BLUE, GREEN, ORANGE, VERMILION, rgb
from edl6dof.report.flight.phase_planes import zones_of

AXES = ("roll", "pitch", "yaw")
#: Telemetry columns that the planes show.
COLUMNS = (*(f"control.error_{axis}_deg" for axis in AXES), *(f"truth.rate_{axis}_deg_s" for axis in "pqr"))
TICKS = (-100, -30, -10, -3, -1, 0, 1, 3, 10, 30, 100)
#: Ends of the picture, deg and deg/s.
REACH_DEG, REACH_DEG_S = 180.0, 40.0
GRID, ZERO = (40, 40, 46), (86, 86, 94)
Line = tuple[np.ndarray, tuple[int, int, int]]


def squeeze(x: np.ndarray | float) -> np.ndarray:
    """The compressed scale: linear below one unit, logarithmic beyond; 180 maps to 1."""
    return np.arcsinh(x) / np.arcsinh(180.0)


def on_picture(error_deg: np.ndarray, rate_deg_s: np.ndarray) -> np.ndarray:
    """Picture coordinates (x right, y down), shape (..., 2)."""
    return np.stack(np.broadcast_arrays(squeeze(error_deg), -squeeze(rate_deg_s)), axis=-1)


class PhasePlanes(Recorder):
    """Writes ``/phase_plane``; of the first flight only."""

    def statics(self) -> None:
        """Grid and scales."""
        if self.number or not self.flight.jets:
            return
        x, y = squeeze(REACH_DEG), squeeze(REACH_DEG_S)
        upright = [[[squeeze(k), -y], [squeeze(k), y]] for k in TICKS]
        level = [[[-x, -squeeze(k)], [x, -squeeze(k)]] for k in TICKS if abs(k) < REACH_DEG_S]
        colours = [ZERO if k == 0 else GRID for k in TICKS] + [
            ZERO if k == 0 else GRID for k in TICKS if abs(k) < REACH_DEG_S
        ]
        places = [[squeeze(k), y + 0.045] for k in TICKS if k % 10 == 0 or abs(k) < 2]
        names = [f"{k}°" for k in TICKS if k % 10 == 0 or abs(k) < 2]
        places += [[-x - 0.07, -squeeze(k)] for k in TICKS if abs(k) < REACH_DEG_S]
        names += [f"{k}°/s" for k in TICKS if abs(k) < REACH_DEG_S]
        for axis in AXES:
            self.static(
                f"phase_plane/{axis}/grid",
                self.rr.LineStrips2D([*upright, *level], colors=colours, radii=-0.6),
            )
            scale = self.rr.Points2D(
                places, labels=names, colors=(150, 150, 160), radii=-0.01, show_labels=True
            )
            self.static(f"phase_plane/{axis}/scale", scale)

    def motions(self) -> None:
        """Zones by phase, the way of the last seconds, and the present state."""
        if self.number or len(self.t) < 5 or not self.flight.jets:
            return
        rr = self.rr
        error = vector(self.flight.columns, "control.error", "roll pitch yaw", "_deg")
        rate = vector(self.flight.columns, "truth.rate", "p q r", "_deg_s")
        rows = thin(self.t, SLOW_HZ)
        for k, axis in enumerate(AXES):
            self._zones(k, f"phase_plane/{axis}/zones")
            place = on_picture(error[rows, k], rate[rows, k])
            self.static(f"phase_plane/{axis}/way", rr.LineStrips2D.from_fields(colors=rgb(BLUE), radii=-1.2))
            segments = np.stack([place[:-1], place[1:]], axis=1)
            self.columns(
                f"phase_plane/{axis}/way", self.t[rows[1:]], rr.LineStrips2D.columns(strips=segments)
            )
            self.static(
                f"phase_plane/{axis}/now", rr.Points2D.from_fields(colors=(255, 255, 255), radii=-4.0)
            )
            self.columns(f"phase_plane/{axis}/now", self.t[rows], rr.Points2D.columns(positions=place))

    def _zones(self, axis: int, entity: str) -> None:
        """Lines of the controller that each phase names."""
        phases = self.flight.scenario.mission.phases
        for row in np.append(0, np.flatnonzero(np.diff(self.phase)) + 1):
            name = phases[self.phase[row]].control if phases else "off"
            gains = getattr(self.flight.scenario.flight_software.control, name, None)
            lines = boundaries({} if gains is None else gains.model_dump(), axis)
            if lines:
                strips, colours = zip(*lines, strict=True)
                self.at(self.t[row], entity, self.rr.LineStrips2D(strips, colors=colours, radii=-1.0))
            else:
                self.gone(self.t[row], entity)


def boundaries(gains: Mapping[str, Any], axis: int) -> list[Line]:
    """Lines of a controller's zones on the picture for axis 0 roll, 1 pitch, 2 yaw."""
    zones = zones_of(gains, axis)
    inside = (np.abs(zones.error) <= REACH_DEG) & (np.abs(zones.rate) <= REACH_DEG_S)
    across, up, both = (np.array([-reach, reach]) for reach in (REACH_DEG, REACH_DEG_S, 1.0))
    lines = [
        (on_picture(sign * zones.error[inside], sign * zones.rate[inside]), rgb(GREEN))
        for sign in both
        if zones.name
    ]
    lines += [(on_picture(sign * np.full(2, at), up), rgb(ORANGE)) for at in zones.errors for sign in both]
    return lines + [
        (on_picture(across, sign * np.full(2, at)), rgb(VERMILION)) for at in zones.rates for sign in both
    ]
