"""The flight that the symmetry properties turn and mirror: capsule entry or deployments in dense air, flight
software off.
"""

from __future__ import annotations

import numpy as np

from edl6dof.scenario.loading import load_scenario
from edl6dof.sim.flight import fly
from edl6dof.sim.outcome import TIME_LIMIT
from edl6dof.vehicle.plant import HEAT
from edl6dof.verify.case import doing

#: An axisymmetric planet: oblate, turning, with a wind that depends on altitude alone, and no ground to meet.
SCENE = (
    "planet.gravity.model=j2",
    "planet.areoid=''",
    "atmosphere.model=table",
    "terrain.model=none",
    "wind.model=constant",
    "simulation.time_limit_s=12",
)


def end_state(overrides, parachute=True):
    """State after 12 s, with the trim wing at 1 s, the mortar at 2 s (if ``parachute``) and the heat shield
    off at 9 s.
    """
    deployment = [("deploy", "main", 2.0)] if parachute else []
    events = doing(("extend", "trim_wing", 1.0), *deployment, ("jettison", "heat_shield", 9.0))
    flight = fly(load_scenario("tianwen1", [*SCENE, *events, *overrides]))
    assert flight.code == TIME_LIMIT and flight.plant["canopy"][0] == (2 if parachute else 0), flight.outcome
    return flight.plant["y"][0].copy()


def scene(latitude, longitude, azimuth, bank, beta, p, r, east, side=1.0, spin=7.088218066304e-05):
    """Overrides; ``side`` -1 is the mirror image in the plane of the pole and longitude 0: east and west,
    left and right.
    """
    parts = {
        "parts.heat_shield": (-0.30, 0.01, -0.035),
        "parts.backshell": (-1.70, -0.0687, -0.284),
        "tanks.main": (-0.80, 0.047, 0.0),
    }
    return [
        f"initial.latitude_deg={latitude}",
        f"initial.longitude_deg={side * longitude}",
        f"initial.azimuth_deg={side * azimuth}",
        f"initial.bank_deg={side * bank}",
        f"initial.beta_deg={side * beta}",
        f"initial.rate_deg_s=[{side * p}, 2, {side * r}]",
        "sensors.set=perfect",
        "initial.altitude_m=9000",
        "initial.speed_m_s=420",
        "initial.flight_path_angle_deg=-20",
        "initial.alpha_deg=-6",
        f"wind.constant.east_m_s={side * east}",
        "wind.constant.north_m_s=7",
        f"planet.rotation_rate_rad_s={side * spin}",
        f"vehicle.mass.entry_centre_m=[-0.85, {side * 0.004}, -0.034]",
        *(f"vehicle.{name}.centre_m=[{x}, {side * y}, {z}]" for name, (x, y, z) in parts.items()),
        f"vehicle.parachutes.main.confluence_m=[-3.9, {side * 0.02}, -0.034]",
    ]


def apart(a, b):
    """Largest relative difference of two states; positions count by the difference over a metre, the
    quaternion with either sign.
    """
    q = min(np.abs(a[6:10] - b[6:10]).max(), np.abs(a[6:10] + b[6:10]).max())
    others = np.abs(np.delete(a - b, [6, 7, 8, 9, HEAT])).max()
    return max(float(q), float(others))
