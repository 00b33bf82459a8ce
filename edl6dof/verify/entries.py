"""Check cases of entries: straight down through an exponential atmosphere, and banked over a planet."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import cos, e, erf, exp, pi, radians, sin, sqrt

import numpy as np

from edl6dof.config.base import stated
from edl6dof.config.units import G0
from edl6dof.scenario.schema import Scenario
from edl6dof.verify.case import FREE, NO_RATE, Bench, given, largest

_STRAIGHT = (
    *(*FREE, NO_RATE, "atmosphere.model=exponential", "vehicle.aero.model=constant"),
    "vehicle.aero.constant={drag_coefficient: 1.5, reference_area_m2: 9, moment_reference_x_m: -0.85}",
    *given("vehicle.mass", entry_centre_m=[-0.85, 0, 0], entry_kg=400),
    *("initial.flight_path_angle_deg=-90", "simulation.time_limit_s=60"),
)


def allen_eggers(bench: Bench) -> None:
    """Verifies: drag through an exponential atmosphere, speed and peak deceleration.

    gravity none | atmosphere exponential | winds none | vehicle one rigid body with constant drag, straight
    down a planet at rest | source: Allen & Eggers, NACA report 1381 (1958), exact for this path: V = V0 exp(
    -H (rho - rho0) / 2B), B = m / CD A; the greatest deceleration is V0^2 / (2 e H) | tolerance 1e-8 of the
    speed: RK4 at 10 ms over scale heights of 2 s; 1e-6 of the peak, which falls between rows 20 ms apart.

    Fall straight down and compare the speed at every altitude, and the greatest deceleration.
    """
    nominal, flight = bench.flown(_STRAIGHT, ends="crashed")
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
    compare = partial(bench.compare, verifies="drag and atmosphere", source="Allen & Eggers, NACA 1381")
    compare("speed", largest(v / expected - 1.0), 1e-8, why="truncation of RK4 at 10 ms")
    compare("greatest deceleration", abs(found / peak - 1.0), 1e-6, why="parabola through five rows")
    bench.plot("Allen-Eggers entry", "altitude (km)", "speed (m/s)", h / 1e3, v, expected)


def heating(bench: Bench) -> None:
    """Verifies: heat flux and heat load at the stagnation point.

    gravity none | atmosphere exponential | winds none | vehicle one rigid body with constant drag, straight
    down a planet at rest | source: Sutton & Graves, NASA TR R-376, q = k (rho / rn)^0.5 V^3, along the exact
    path of ``allen_eggers``; its integral over time, with dt = H drho / (rho V), is k H V0^2 (pi B / (H
    rn))^0.5 exp(H rho0 / B) [erf (H rho / B)^0.5] from rho0 to rho | tolerance 3e-8 of the flux, three times
    that of the speed, and 1e-8 of the load: RK4 at 10 ms over scale heights of 2 s.

    Fall straight down and compare both at every altitude.
    """
    nominal, flight = bench.flown(_STRAIGHT, ends="crashed")
    table, planet, vehicle = flight.telemetry, nominal.planet, nominal.vehicle
    air, aero = stated(nominal.atmosphere.exponential), vehicle.aero.constant
    scale = air.scale_height_m
    thickness = scale * aero.drag_coefficient * aero.reference_area_m2 / vehicle.mass.entry_kg  # H / B
    h = table["truth.altitude_m"][1:]
    rho, rho_start = (air.density_kg_m3 * np.exp(-x / scale) for x in (h, nominal.initial_altitude_m))
    speed = nominal.initial.speed * np.exp(-0.5 * thickness * (rho - rho_start))
    factor = planet.gas.sutton_graves_constant / sqrt(vehicle.nose_radius_m)
    flux = factor * np.sqrt(rho) * speed**3 / 1e4
    passed = np.array([erf(sqrt(thickness * x)) for x in rho]) - erf(sqrt(thickness * rho_start))
    size = factor * scale * nominal.initial.speed**2 * sqrt(pi / thickness) * exp(thickness * rho_start)
    load = size * passed / 1e4
    found, gathered = table["truth.heat_flux_w_cm2"][1:], table["truth.heat_load_j_cm2"][1:]
    compare = partial(bench.compare, verifies="convective heating", why="truncation of RK4 at 10 ms")
    compare("heat flux", largest(found / flux - 1.0), 3e-8, source="Sutton & Graves")
    compare("heat load", largest(gathered - load) / load[-1], 1e-8, source="error function")
    title = "Heating of an Allen-Eggers entry"
    bench.plot(title, "altitude (km)", "heat load (J/cm2)", h / 1e3, gathered, load)


_BANKED = (
    *("dynamics=point_mass", "mission={goal: time, phases: []}"),
    *("planet.flattening=0", "planet.areoid=''", "planet.gravity.model=central"),
    *("atmosphere.model=exponential", "wind.model=none", "terrain.model=none"),
    "vehicle.aero.model=lift_drag",
    "vehicle.aero.lift_drag={reference_area_m2: 9.0, drag_coefficient: 1.6, lift_to_drag: 0.2}",
    *("initial.bank_deg=55", "simulation.time_limit_s=150"),
)


def spherical(scenario: Scenario) -> Callable[[float, np.ndarray], list[float]]:
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

    initial, place = scenario.initial, (scenario.initial.longitude_deg, scenario.initial.latitude_deg)
    radius = scenario.planet.equatorial_radius_m + scenario.initial_altitude_m
    heading = pi / 2.0 - initial.azimuth
    start = [radius, *map(radians, place), initial.speed, initial.flight_path_angle, heading]
    return solve_ivp(spherical(scenario), (0.0, times[-1]), start, "DOP853", times, rtol=1e-11, atol=1e-10).y


def point_mass(bench: Bench) -> None:
    """Verifies: the point mass in place of the rigid body: path, bank angle about the velocity, rotation of
    the planet.

    gravity central | atmosphere exponential | winds none | vehicle constant drag and lift at a bank angle of
    55 deg over a rotating sphere | source: the equations of motion in spherical coordinates, Vinh, Busemann &
    Culp, Hypersonic and Planetary Entry Flight Mechanics (1980), section 2-3, integrated by scipy's DOP853 |
    tolerance 1 mm and 0.01 mm/s over 150 s: RK4 at 10 ms.

    Fly banked over a rotating planet; compare place and speed with the spherical equations.
    """
    nominal, flight = bench.flown(_BANKED)
    rows = {name: values[::50] for name, values in flight.telemetry.items()}
    radius = nominal.planet.equatorial_radius_m
    r, lon, lat, v, _, _ = integrated(nominal, rows["t_s"])
    up = rows["truth.altitude_m"] + radius - r
    north = radius * np.radians(rows["truth.latitude_deg"] - np.degrees(lat))
    east = radius * np.radians(rows["truth.longitude_deg"] - np.degrees(lon)) * np.cos(lat)
    off, speed = np.sqrt(up**2 + north**2 + east**2), np.abs(rows["truth.speed_m_s"] - v)
    source, why = "Vinh, Busemann & Culp, section 2-3", "truncation of RK4 at 10 ms"
    compare = partial(bench.compare, verifies="point-mass dynamics", source=source, why=why)
    compare("place", off.max(), 1e-3, "m")
    compare("speed", speed.max(), 1e-5, "m/s")
    curves = np.degrees(lon), rows["truth.latitude_deg"], np.degrees(lat)
    bench.plot("Banked point mass", "longitude (deg)", "latitude (deg)", *curves)
