"""Figures of a powered landing, whoever flew it: what it took, and how near it came to its limits."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, inf, pi, tan

import numpy as np

from edl6dof.design.landing.rigid_body import POSITION, RATE, VELOCITY, RigidLanding, tilt_of


@dataclass(frozen=True)
class LandingFigures:
    """Figures of a landing, from its first state to its last.

    Attributes:
        fuel_kg: propellant.
        time_s: of flight.
        tilt_deg: largest angle of the thrust axis from the vertical.
        rate_deg_s: largest body rate.
        slope_m: least height over the glide slope.
        miss_m, speed_m_s, end_tilt_deg: distance from the landing point, speed and tilt at the end.
    """

    fuel_kg: float
    time_s: float
    tilt_deg: float
    rate_deg_s: float
    slope_m: float
    miss_m: float
    speed_m_s: float
    end_tilt_deg: float


def figures_of(landing: RigidLanding, t: np.ndarray, x: np.ndarray) -> LandingFigures:
    """Figures of the states ``x``, shape (n, 14), at the times ``t``, shape (n,), s."""
    away = np.hypot(x[:, 1], x[:, 2])
    slope = (
        x[:, 3] - tan(landing.glide_slope) * away if landing.glide_slope > -pi / 2.0 else np.full(len(t), inf)
    )
    return LandingFigures(
        fuel_kg=float(x[0, 0] - x[-1, 0]),
        time_s=float(t[-1] - t[0]),
        tilt_deg=degrees(np.max(tilt_of(x))),
        rate_deg_s=degrees(np.max(np.linalg.norm(x[:, RATE], axis=1))),
        slope_m=float(np.min(slope)),
        miss_m=float(np.linalg.norm(x[-1, POSITION])),
        speed_m_s=float(np.linalg.norm(x[-1, VELOCITY])),
        end_tilt_deg=degrees(tilt_of(x[-1])),
    )


#: A design asks for its limits at some points of each interval (``transcription.CHECKED``); between them they
#: may be exceeded by this share [S].  Seen: 3.3 % of the body rate.
TOLERANCE = 0.05
#: What an excess must be to be shown, in deg and deg/s: half of the last place of a figure.
SHOWN = 0.005


@dataclass(frozen=True)
class Excess:
    """A limit that a landing exceeds.

    Attributes:
        what: the figure, in words.
        by: how far it is exceeded, in ``unit``.
        tolerated: whether that is no more than between the points where a design asks for it.
    """

    what: str
    by: float
    unit: str
    tolerated: bool


def excesses(landing: RigidLanding, figures: LandingFigures) -> list[Excess]:
    """The limits of tilt and body rate that a landing exceeds."""
    limits = (
        ("tilt", figures.tilt_deg, degrees(landing.tilt), "deg"),
        ("body rate", figures.rate_deg_s, degrees(landing.rate), "deg/s"),
    )
    return [
        Excess(what, value - limit, unit, value <= (1.0 + TOLERANCE) * limit)
        for what, value, limit, unit in limits
        if value > limit + SHOWN
    ]
