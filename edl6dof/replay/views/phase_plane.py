"""Phase planes: attitude error against its rate, axis by axis, with the switching lines and zones of the
controller at work.

Error is goal minus actual, as the controllers have it; the rate is the body's (bank control subtracts the
slow turn of the velocity frame).  Both axes are compressed beyond about one unit (arsinh), so that a bank
reversal and the last tenth of a degree fit into one picture.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from edl6dof.replay.history import thin, vector
from edl6dof.replay.recorder import SLOW_HZ, Recorder
from edl6dof.replay.views.panels import SERIES

AXES = ("roll", "pitch", "yaw")
#: Telemetry columns that the planes show.
COLUMNS = (
    *(f"control.error_{axis}_deg" for axis in AXES),
    *(f"truth.rate_{axis}_deg_s" for axis in "pqr"),
)
TICKS = (-100, -30, -10, -3, -1, 0, 1, 3, 10, 30, 100)
#: Ends of the picture, deg and deg/s.
REACH_DEG, REACH_DEG_S = 180.0, 40.0
GRID, ZERO, DEADBAND, TARGET, FAR, LIMIT = (
    (40, 40, 46),
    (86, 86, 94),
    (120, 220, 140),
    (240, 228, 90),
    (160, 140, 240),
    (235, 80, 80),
)
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
            self.static(f"phase_plane/{axis}/way", rr.LineStrips2D.from_fields(colors=SERIES[0], radii=-1.2))
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
            lines = boundaries(getattr(self.flight.scenario.flight_software.control, name, None), axis)
            if lines:
                strips, colours = zip(*lines, strict=True)
                self.at(self.t[row], entity, self.rr.LineStrips2D(strips, colors=colours, radii=-1.0))
            else:
                self.gone(self.t[row], entity)


def boundaries(control: Any, axis: int) -> list[Line]:
    """Lines of a controller's parameters on the picture for axis 0 roll, 1 pitch, 2 yaw; none where the
    controller has none.
    """
    if hasattr(control, "deadband_deg"):
        return _switching(control)
    zone = getattr(control, "roll" if axis == 0 else "pitch_yaw", None) or (
        getattr(control, "bank", None) if axis == 0 else None
    )
    if zone is not None:
        return _zone(zone)
    if hasattr(control, "rate_deadband_deg_s"):
        band, span = control.rate_deadband_deg_s, np.linspace(-REACH_DEG, REACH_DEG, 2)
        return [(on_picture(span, np.full(2, sign * band)), DEADBAND) for sign in (-1.0, 1.0)]
    return []


def _switching(control: Any) -> list[Line]:
    """Deadband parabolas (error = rate |rate| / 2a + lead rate +- deadband) and rate limits of phase-plane
    control.
    """
    rate = np.sinh(np.linspace(-1.0, 1.0, 61) * np.arcsinh(REACH_DEG_S))
    bend = rate * np.abs(rate) / (2.0 * control.acceleration_deg_s2) + control.lead_s * rate
    lines = []
    for sign in (-1.0, 1.0):
        error = bend + sign * control.deadband_deg
        inside = np.abs(error) < REACH_DEG
        lines.append((on_picture(error[inside], rate[inside]), DEADBAND))
    return lines + _level(control.rate_limit_deg_s, LIMIT)


def _zone(zone: Any) -> list[Line]:
    """Near and far bounds, the rate aimed at between them, and the rate beyond which only the rate is brought
    down.
    """
    size = np.sinh(np.linspace(0.0, 1.0, 61) * np.arcsinh(REACH_DEG))
    inner = zone.proportional / max(zone.derivative, 1e-9) * zone.near_deg
    wanted = np.sqrt(inner**2 + 2.0 * zone.deceleration_deg_s2 * np.maximum(size - zone.near_deg, 0.0))
    wanted = np.minimum(np.where(size > zone.far_deg, zone.rate_deg_s, wanted), zone.rate_deg_s)
    outside = size > zone.near_deg
    lines = [(on_picture(sign * size[outside], sign * wanted[outside]), TARGET) for sign in (-1.0, 1.0)]
    reach = np.array([-REACH_DEG_S, REACH_DEG_S])
    for bound, colour in ((zone.near_deg, DEADBAND), (zone.far_deg, FAR)):
        lines += [(on_picture(np.full(2, sign * bound), reach), colour) for sign in (-1.0, 1.0)]
    return lines + _level(1.15 * zone.rate_deg_s, LIMIT)


def _level(rate: float, colour: tuple[int, int, int]) -> list[Line]:
    span = np.array([-REACH_DEG, REACH_DEG])
    return [(on_picture(span, np.full(2, sign * rate)), colour) for sign in (-1.0, 1.0)]
