"""Check cases of the capsule in pitch: trim, frequency and damping."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import pi, sqrt
from pathlib import Path

import numpy as np
from scipy.interpolate import PchipInterpolator

import edl6dof
from edl6dof.config.base import stated
from edl6dof.scenario.schema import Scenario
from edl6dof.verify.case import (
    BARE,
    ENDLESS,
    NO_RATE,
    ONE_BODY,
    UNIFORM,
    WEIGHTLESS,
    History,
    Outcome,
    Result,
    fit,
    flown,
)

_TABLE = Path(edl6dof.__file__).parent / "data" / "aerodynamics" / "phoenix_70deg_static_aero.csv"
DIAMETER = 3.4
STATION = -0.85
REFERENCE = -0.253 * DIAMETER
TRIM_DEG = 11.0


class Published:
    """CA, CN, Cm of one Mach number against alpha (deg)."""

    def __init__(self, mach: float) -> None:
        rows = np.genfromtxt(_TABLE, delimiter=",", skip_header=3)
        rows = rows[rows[:, 0] == mach]
        angle, drag, lift, moment = rows[:, 1], rows[:, 2], rows[:, 3], rows[:, 4]
        a = np.radians(angle)
        axial, normal = drag * np.cos(a) - lift * np.sin(a), drag * np.sin(a) + lift * np.cos(a)
        mirrored = np.concatenate([-angle[:0:-1], angle])
        both = [np.concatenate([s * y[:0:-1], y]) for s, y in ((1, axial), (-1, normal), (-1, moment))]
        self.axial, self.normal, self.moment = (PchipInterpolator(mirrored, y) for y in both)
        self.lift = float(-lift[angle == TRIM_DEG][0])
        self.lift_to_drag = self.lift / float(drag[angle == TRIM_DEG][0])

    def offset(self) -> float:
        """Station z (m) of the centre of mass that trims the capsule at alpha = -``TRIM_DEG``: lift up."""
        ca, cn, cm = self.axial(TRIM_DEG), self.normal(TRIM_DEG), self.moment(TRIM_DEG)
        return float((DIAMETER * cm + (REFERENCE - STATION) * cn) / ca)

    def pitching(self, alpha_deg: float, z: float) -> float:
        """Moment about the centre of mass at station ``z`` over dynamic pressure and area, m."""
        ca, cn, cm = self.axial(alpha_deg), self.normal(alpha_deg), self.moment(alpha_deg)
        return float(DIAMETER * cm + z * ca + (REFERENCE - STATION) * cn)


#: The published table as it stands, and a gas whose ratio of specific heats is one number.
HEAT_CAPACITY_RATIO = 1.29
PLAIN = (
    "vehicle.aero.capsule.axial_factor=1",
    f"planet.gas.heat_capacity_ratio={HEAT_CAPACITY_RATIO}",
    "planet.gas.vibrations=[]",
)


def scene(mach: float, density: float = 1e-3, extra: tuple[str, ...] = ()) -> tuple[str, ...]:
    """Overrides for a capsule at one Mach number that trims at alpha = -11 deg."""
    sound = sqrt(HEAT_CAPACITY_RATIO * 191.0 * 214.0)
    return (
        *(*BARE, *WEIGHTLESS, *UNIFORM, *ONE_BODY, *ENDLESS, *PLAIN, NO_RATE),
        "vehicle.mass.entry_kg=1e9",
        f"vehicle.mass.entry_centre_m=[{STATION}, 0, {Published(mach).offset()!r}]",
        "vehicle.aero.capsule.damping_factor=0",
        f"atmosphere.exponential.density_kg_m3={density}",
        f"initial.speed_m_s={mach * sound!r}",
        "initial.altitude_m=1000000",
        "initial.flight_path_angle_deg=0",
        f"initial.alpha_deg={-TRIM_DEG + 0.05}",
        "initial.beta_deg=0",
        "initial.bank_deg=0",
        "simulation.time_limit_s=20",
        *extra,
    )


def stiffness(scenario: Scenario, mach: float) -> tuple[float, float]:
    """Natural frequency (rad/s) of the linearised pitch equation about trim, and qbar A D^2 / (2 V Iyy)
    (1/s), without the simulator.
    """
    table = Published(mach)
    speed, inertia = scenario.initial.speed, stated(scenario.vehicle.mass.entry_inertia_kg_m2)[1]
    density = stated(scenario.atmosphere.exponential).density_kg_m3
    push = 0.5 * density * speed**2 * pi / 4.0 * DIAMETER**2
    z, h = table.offset(), 0.01
    slope = (table.pitching(-TRIM_DEG + h, z) - table.pitching(-TRIM_DEG - h, z)) / np.radians(2.0 * h)
    return sqrt(-push * slope / inertia), push * DIAMETER**2 / (2.0 * speed * inertia)


_TRIM_RESULT = partial(Result, source="published table by PCHIP, linearised")


def capsule_trim(planted: Sequence[str] = ()) -> Outcome:
    """Verifies: trim angle and pitch frequency of the capsule with an offset centre of mass, at Mach 2 and
    Mach 15.

    gravity none | atmosphere uniform | winds none | vehicle capsule, too heavy to be slowed down | source:
    moment balance and slope of the published coefficients (Phoenix, AIAA 2008-7219) read and interpolated by
    scipy's PCHIP, linearised pitch equation | tolerance: 1e-3 deg of trim (a swing of 0.05 deg shifts its
    middle by its square) and 1e-3 of the frequency (the slope of the moment changes by that within the
    swing).

    The vehicle weighs a million tonnes with the inertia of the real one: it turns like the capsule and
    neither slows down nor turns its path, so the linearised pitch equation alone governs it.

    Swing 0.05 deg about trim and measure the middle and the frequency.
    """
    results = []
    for mach, density in ((2.0, 1e-2), (15.0, 1e-3)):
        nominal, flight = flown(scene(mach, density), planted)
        t, alpha = flight.telemetry["t_s"], flight.telemetry["truth.alpha_deg"]
        expected, _ = stiffness(nominal, mach)
        found, middle = fit(t, alpha, complex(0.0, expected))
        trim, off = abs(middle + TRIM_DEG), abs(found.imag / expected - 1.0)
        about = {"verifies": "static moment, CG offset", "why": "square of the swing"}
        results.append(_TRIM_RESULT(f"trim angle, Mach {mach:g}", trim, 1e-3, "deg", **about))
        about = {"verifies": "static stability", "why": "slope changes within the swing"}
        results.append(_TRIM_RESULT(f"pitch frequency, Mach {mach:g}", off, 1e-3, **about))
    curve = -TRIM_DEG + (alpha[0] + TRIM_DEG) * np.cos(expected * t)
    return Outcome(results, History("Pitch at Mach 15", "time (s)", "alpha (deg)", t, alpha, curve))


_DAMPING_MACH = 15.0
_DAMPING_ABOUT = {
    "verifies": "pitch damping",
    "source": "linearised pitch equation",
    "why": "curvature of the moment",
}


def damping(planted: Sequence[str] = ()) -> Outcome:
    """Verifies: growth and decay of the pitch oscillation by the damping derivative.

    gravity none | atmosphere uniform | winds none | vehicle capsule, too heavy to be slowed down | source:
    linearised pitch equation, the envelope grows with sigma = qbar A D^2 Cmq / (4 V Iyy) | tolerance 1e-3 of
    sigma: curvature of the static moment within the swing of 0.05 deg leaks into the envelope.

    Swing with Cmq = -1 and +1 and measure the growth of the envelope.
    """
    results = []
    for cmq in (-1.0, 1.0):
        table = (
            "vehicle.aero.capsule.damping_factor=1",
            "vehicle.aero.capsule.damping_mach=[6]",
            "vehicle.aero.capsule.damping_angle_deg=[0]",
            f"vehicle.aero.capsule.damping_table=[[{cmq}]]",
        )
        nominal, flight = flown(scene(_DAMPING_MACH, 1e-3, table), planted)
        t, alpha = flight.telemetry["t_s"], flight.telemetry["truth.alpha_deg"]
        frequency, unit = stiffness(nominal, _DAMPING_MACH)
        sigma = 0.5 * unit * cmq
        found, _ = fit(t, alpha, complex(sigma, frequency))
        error = abs(found.real / sigma - 1.0)
        results.append(Result(f"growth rate, Cmq {cmq:+g}", error, 1e-3, **_DAMPING_ABOUT))
    envelope, swing = abs(alpha[0] + TRIM_DEG) * np.exp(sigma * t), alpha + TRIM_DEG
    curves = History("Growth by Cmq = +1: envelope", "time (s)", "alpha from trim (deg)", t, swing, envelope)
    return Outcome(results, curves)
