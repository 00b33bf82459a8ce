"""Verifies: lift, drag and the curvature of the planet together, on a glide from 80 % to 35 % of circular
energy.

gravity central | atmosphere exponential, 200 m scale height (makes the glide's own approximation good) |
winds none | vehicle capsule trimmed at alpha = -11 deg beyond Mach 30, where its table is constant | source:
Eggers, Allen & Neice, NACA report 1382 (1957): lift carries what the centrifugal force does not, L = m (g -
V^2/r), and the range is r/2 L/D ln((1 - u1) / (1 - u0)), u = V^2 / g r | tolerance 1 %: the glide steepens,
which takes 4 H / (r (L/D)^2 u) off the lift (1 to 2.5 %, counted in the expected value); the range counts
that and the weight along the path; their squares, the slow phugoid from the start and the change of weight
with altitude remain.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import exp, pi

import numpy as np

from edl6dof.verify.case import BARE, ENDLESS, NO_RATE, ONE_BODY, History, Outcome, Result, flown, largest
from edl6dof.verify.cases.capsule_pitch import DIAMETER, PLAIN, STATION, TRIM_DEG, Published

MASS, ALTITUDE, SCALE, RADIUS, MU = 1285.0, 10e3, 200.0, 3396190.0, 4.282837285418775e13
_TOP = 30.0
_R = RADIUS + ALTITUDE
_G = MU / _R**2
_START = 0.8


def _scene(table: Published) -> tuple[str, ...]:
    speed2 = _START * _G * _R
    short = 4.0 * SCALE / (_R * table.lift_to_drag**2 * _START)
    weight = MASS * _G * (1.0 - _START) * (1.0 - short)
    density = 2.0 * weight / (table.lift * pi / 4.0 * DIAMETER**2 * speed2)
    slope = -np.degrees(2.0 * SCALE / (_R * table.lift_to_drag * _START))
    return (
        *(*BARE, *ONE_BODY, *ENDLESS, *PLAIN, NO_RATE),
        f"planet.equatorial_radius_m={RADIUS}",
        "planet.gravity.model=central",
        f"planet.gravity.mu_m3_s2={MU}",
        "atmosphere.model=exponential",
        f"atmosphere.exponential={{density_kg_m3: {density * exp(ALTITUDE / SCALE)!r}, "
        f"scale_height_m: {SCALE}, temperature_k: 5}}",
        f"vehicle.mass.entry_kg={MASS}",
        f"vehicle.mass.entry_centre_m=[{STATION}, 0, {table.offset()!r}]",
        "planet.gas.molecular_diameter_m=1e-8",
        f"initial.altitude_m={ALTITUDE}",
        f"initial.speed_m_s={float(np.sqrt(speed2))!r}",
        f"initial.flight_path_angle_deg={float(slope)!r}",
        "initial.latitude_deg=0",
        "initial.azimuth_deg=90",
        f"initial.alpha_deg={-TRIM_DEG}",
        "initial.beta_deg=0",
        "initial.bank_deg=0",
        "simulation.time_limit_s=130",
    )


def run(planted: Sequence[str] = ()) -> Outcome:
    """Glide for 130 s; compare the lift sought out at each speed, and the range."""
    table = Published(_TOP)
    _, flight = flown(_scene(table), planted)
    rows = flight.telemetry
    t, v, r = rows["t_s"], rows["truth.speed_m_s"], RADIUS + rows["truth.altitude_m"]
    u = v**2 * r / MU
    short = 4.0 * SCALE / (r * table.lift_to_drag**2 * u)
    lift = 0.5 * rows["truth.density_kg_m3"] * v**2 * table.lift * pi / 4.0 * DIAMETER**2 / MASS
    ratio = lift / ((1.0 - u) * (1.0 - short) * MU / r**2)
    east = np.radians(rows["truth.longitude_deg"])
    flown_range = float(np.mod(east[-1] - east[0], 2.0 * pi) * r.mean())
    steeper = 1.0 - short - 2.0 * SCALE / (r * u * (1.0 - u))
    expected = float(-0.5 * r.mean() * table.lift_to_drag * np.trapezoid(1.0 / ((1.0 - u) * steeper), u))
    why = "second order of the glide's approximation"
    result = partial(Result, source="Eggers, Allen & Neice, NACA 1382", why=why)
    off, lifts = abs(flown_range / expected - 1.0), "lift over a curved planet"
    results = (
        result("lift against weight", largest(ratio - 1.0), 1e-2, verifies=lifts),
        result("range", off, 1e-2, verifies="lift-to-drag ratio"),
    )
    return Outcome(results, History("Equilibrium glide", "time (s)", "lift (m/s2)", t, lift, lift / ratio))
