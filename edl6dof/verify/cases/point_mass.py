"""Verifies: the point mass in place of the rigid body: path, bank angle about the velocity, rotation of the
planet.

gravity central | atmosphere exponential | winds none | vehicle constant drag and lift at a bank angle of 55
deg over a rotating sphere |
source: the equations of motion in spherical coordinates, Vinh, Busemann & Culp, Hypersonic and Planetary
Entry Flight Mechanics (1980), section 2-3, integrated by scipy's DOP853 | tolerance 1 mm and 0.01 mm/s over
150 s: RK4 at 10 ms.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from math import cos, exp, pi, radians, sin

import numpy as np

from edl6dof.config.base import stated
from edl6dof.scenario.schema import Scenario
from edl6dof.verify.case import History, Outcome, Result, flown

_TIME_S = 150.0
_SCENE = (
    "dynamics=point_mass",
    "mission={goal: time, phases: []}",
    "planet.flattening=0",
    "planet.areoid=''",
    "planet.gravity.model=central",
    "atmosphere.model=exponential",
    "wind.model=none",
    "terrain.model=none",
    "vehicle.aero.model=lift_drag",
    "vehicle.aero.lift_drag={reference_area_m2: 9.0, drag_coefficient: 1.6, lift_to_drag: 0.2}",
    "initial.bank_deg=55",
    f"simulation.time_limit_s={_TIME_S}",
)

Rates = Callable[[float, np.ndarray], list[float]]


def spherical(scenario: Scenario) -> Rates:
    """Rates of (radius, longitude, latitude, speed, path angle, heading from east to north), m and rad, at
    the initial bank angle.

    A sinusoidal disturbance of the path rate is added as in Yan, Sun & Guo 2016, eq. 5.
    """
    planet, air = scenario.planet, stated(scenario.atmosphere.exponential)
    aero = scenario.vehicle.aero.lift_drag
    spin, mu = planet.rotation_rate_rad_s, planet.gravity.mu_m3_s2
    disturbance = scenario.point_mass.disturbance
    area_per_mass = aero.reference_area_m2 * aero.drag_coefficient / scenario.vehicle.mass.entry_kg
    bank = scenario.initial.wind_angles[0]

    def rates(t: float, s: np.ndarray) -> list[float]:
        r, _, lat, v, gamma, psi = s
        density = air.density_kg_m3 * exp(-(r - planet.equatorial_radius_m) / air.scale_height_m)
        drag = 0.5 * density * v * v * area_per_mass
        lift, g, carried = aero.lift_to_drag * drag, mu / r**2, spin * spin * r * cos(lat)
        push = disturbance.amplitude_rad_s * sin(disturbance.frequency_rad_s * t)
        return [
            v * sin(gamma),
            v * cos(gamma) * cos(psi) / (r * cos(lat)),
            v * cos(gamma) * sin(psi) / r,
            -drag - g * sin(gamma) + carried * (sin(gamma) * cos(lat) - cos(gamma) * sin(lat) * sin(psi)),
            (lift * cos(bank) - (g - v * v / r) * cos(gamma)) / v
            + push
            + 2.0 * spin * cos(lat) * cos(psi)
            + carried / v * (cos(gamma) * cos(lat) + sin(gamma) * sin(lat) * sin(psi)),
            -(lift * sin(bank) / cos(gamma) + v * v / r * cos(gamma) * cos(psi) * sin(lat) / cos(lat)) / v
            + 2.0 * spin * (sin(gamma) / cos(gamma) * cos(lat) * sin(psi) - sin(lat))
            - carried / (v * cos(gamma)) * sin(lat) * cos(psi),
        ]

    return rates


def integrated(scenario: Scenario, times: np.ndarray) -> np.ndarray:
    """The spherical state at ``times`` (s), shape (6, n)."""
    from scipy.integrate import solve_ivp

    initial = scenario.initial
    start = [
        scenario.planet.equatorial_radius_m + scenario.initial_altitude_m,
        radians(initial.longitude_deg),
        radians(initial.latitude_deg),
        initial.speed,
        initial.flight_path_angle,
        pi / 2.0 - initial.azimuth,
    ]
    return solve_ivp(spherical(scenario), (0.0, times[-1]), start, "DOP853", times, rtol=1e-11, atol=1e-10).y


def run(planted: Sequence[str] = ()) -> Outcome:
    """Fly banked over a rotating planet; compare place and speed with the spherical equations."""
    nominal, flight = flown(_SCENE, planted)
    rows = flight.telemetry
    radius = nominal.planet.equatorial_radius_m
    times = rows["t_s"][::50]
    r, lon, lat, v, _, _ = integrated(nominal, times)
    place = [rows[f"truth.{name}"][::50] for name in ("altitude_m", "latitude_deg", "longitude_deg")]
    north = radius * np.radians(place[1] - np.degrees(lat))
    east = radius * np.radians(place[2] - np.degrees(lon)) * np.cos(lat)
    off = np.sqrt((place[0] + radius - r) ** 2 + north**2 + east**2)
    speed = np.abs(rows["truth.speed_m_s"][::50] - v)
    source, why = "Vinh, Busemann & Culp, section 2-3", "truncation of RK4 at 10 ms"
    result = partial(Result, verifies="point-mass dynamics", source=source, why=why)
    results = (result("place", off.max(), 1e-3, "m"), result("speed", speed.max(), 1e-5, "m/s"))
    labels = ("Banked point mass", "longitude (deg)", "latitude (deg)")
    return Outcome(results, History(*labels, np.degrees(lon), place[1], np.degrees(lat)))
