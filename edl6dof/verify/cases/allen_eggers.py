"""Verifies: drag through an exponential atmosphere, speed and peak deceleration.

gravity none | atmosphere exponential | winds none | vehicle one rigid body with constant drag, straight down
a planet at rest |
source: Allen & Eggers, NACA report 1381 (1958), exact for this path: V = V0 exp(-H (rho - rho0) / 2B), B = m
/ CD A; the greatest deceleration is V0^2 / (2 e H) | tolerance 1e-8 of the speed: RK4 at 10 ms over scale
heights of 2 s; 1e-6 of the peak, which falls between rows 20 ms apart.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import e

import numpy as np

from edl6dof.config.base import stated
from edl6dof.config.units import G0
from edl6dof.verify.case import FREE, NO_RATE, History, Outcome, Result, flown, largest

_SCENE = (
    *(*FREE, NO_RATE),
    "atmosphere.model=exponential",
    "vehicle.aero.model=constant",
    "vehicle.aero.constant={drag_coefficient: 1.5, reference_area_m2: 9, moment_reference_x_m: -0.85}",
    "vehicle.mass.entry_centre_m=[-0.85, 0, 0]",
    "vehicle.mass.entry_kg=400",
    "initial.flight_path_angle_deg=-90",
    "simulation.time_limit_s=60",
)


def run(planted: Sequence[str] = ()) -> Outcome:
    """Fall straight down and compare the speed at every altitude, and the greatest deceleration."""
    nominal, flight = flown(_SCENE, planted, ends="crashed")
    air, aero = stated(nominal.atmosphere.exponential), nominal.vehicle.aero.constant
    table = flight.telemetry
    flying = table["truth.height_m"] > 0.0
    h, v, t = table["truth.altitude_m"][flying], table["truth.speed_m_s"][flying], table["t_s"][flying]
    ballistic = nominal.vehicle.mass.entry_kg / (aero.drag_coefficient * aero.reference_area_m2)
    scale = air.scale_height_m
    rho, rho_start = (air.density_kg_m3 * np.exp(-x / scale) for x in (h, nominal.initial_altitude_m))
    start = nominal.initial.speed
    expected = start * np.exp(-scale * (rho - rho_start) / (2.0 * ballistic))
    peak = start**2 * np.exp(scale * rho_start / ballistic) / (2.0 * e * scale)
    load = table["truth.load_g0"][flying] * G0
    top = int(np.argmax(load))
    near = slice(max(top - 2, 0), top + 3)
    a, b, c = np.polyfit(t[near] - t[top], load[near], 2)
    found = c - b * b / (4.0 * a)
    result = partial(Result, verifies="drag and atmosphere", source="Allen & Eggers, NACA 1381")
    results = (
        result("speed", largest(v / expected - 1.0), 1e-8, why="truncation of RK4 at 10 ms"),
        result("greatest deceleration", abs(found / peak - 1.0), 1e-6, why="parabola through five rows"),
    )
    curves = History("Allen-Eggers entry", "altitude (km)", "speed (m/s)", h / 1e3, v, expected)
    return Outcome(results, curves)
