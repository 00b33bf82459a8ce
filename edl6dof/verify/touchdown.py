"""Check case of the landing gear: a lander drops onto level ground and swings on its legs."""

from __future__ import annotations

import numpy as np

from edl6dof.verify import case
from edl6dof.verify.case import Bench, given, largest, scenes, state_of, to_the_end

_GRAVITY, _CENTRE, _RADIUS, _DROP = 3.72, -0.85, 1e7, 0.005
_SCENE = (
    *(*case.BARE, *case.VACUUM, *case.ONE_BODY, case.NO_RATE, *case.ALIGNED),
    *given("planet", equatorial_radius_m=_RADIUS, mean_radius_m=_RADIUS),
    *given("planet.gravity", model="central", mu_m3_s2=_GRAVITY * _RADIUS**2),
    *given("terrain", model="plane", site_elevation_m=0),
    f"vehicle.mass.entry_centre_m=[{_CENTRE}, 0, 0]",
    "vehicle.landing_gear.damping_n_s_m=800",
    *given("initial", flight_path_angle_deg=-90, speed_m_s=0.2),
    *given("simulation", contact_step_s=0.0005, time_limit_s=1),
)


def contact(bench: Bench) -> None:
    """Verifies: first contact, and spring and damper of the legs.

    gravity uniform | atmosphere none | winds none | vehicle upright on four legs, which stay on the ground |
    source: free fall, then the damped oscillator z = d + exp(-s t) ((v - s d) / w sin w t - d cos w t), with
    the depth z below first contact, the speed v there, s = c / 2m, w^2 = k / m - s^2, d = m g / k, and k and
    c of all legs | tolerance 1e-7 m: a position of 1e7 m resolves 2e-9 m, and rounds in each of 2,000 steps;
    first contact is located to 1e-9 s.

    Drop the lander from 5 mm at 0.2 m/s and compare the height for a second.
    """
    nominal = scenes(_SCENE)[0]
    gear, mass, v0 = nominal.vehicle.landing_gear, nominal.vehicle.mass.entry_kg, nominal.initial.speed
    reach = max(pad[0] for pad in gear.footpads_m) - _CENTRE
    _, loaded = bench.scenes([*_SCENE, f"initial.altitude_m={reach + _DROP!r}"])

    def unfold(plant: np.void, fsw: np.void) -> None:
        plant["legs"] = 1

    flight = to_the_end(loaded, state_of(loaded, unfold))
    t, depth = flight.telemetry["t_s"], reach - flight.telemetry["truth.altitude_m"]
    speed = np.sqrt(v0**2 + 2.0 * _GRAVITY * _DROP)
    since = t - (speed - v0) / _GRAVITY
    legs = len(gear.footpads_m)
    s = legs * gear.damping_n_s_m / (2.0 * mass)
    w = np.sqrt(legs * gear.stiffness_n_m / mass - s**2)
    d = mass * _GRAVITY / (legs * gear.stiffness_n_m)
    swing = d + np.exp(-s * since) * ((speed - s * d) / w * np.sin(w * since) - d * np.cos(w * since))
    fall = v0 * t + 0.5 * _GRAVITY * t**2 - _DROP
    expected = np.where(since < 0.0, fall, swing)
    about = ("m", "landing gear, first contact", "damped oscillator", "resolution of positions")
    bench.compare("height", largest(depth - expected), 1e-7, *about)
    bench.plot("Lander on its legs", "time (s)", "depth below first contact (m)", t, depth, expected)
