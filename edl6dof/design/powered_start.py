"""The landing problem of a flight at ignition, and the part of its telemetry that is compared with the
design.
"""

from __future__ import annotations

from itertools import product
from math import radians

import numpy as np
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from edl6dof.config.units import G0
from edl6dof.design.rigid_landing import RigidLanding, tilt_of
from edl6dof.fsw.allocation.effectiveness import effectiveness_matrix
from edl6dof.interface.capacities import MAX_THRUSTERS
from edl6dof.interface.effectors import THRUSTER_GROUPS
from edl6dof.interface.roles import HOVER_IMAGING, POWERED_DECELERATION
from edl6dof.scenario.records import build_onboard
from edl6dof.scenario.schema import Scenario
from edl6dof.sim.flight import Flight

#: Axes S of the lander in B, as columns: its third axis is the thrust axis, which is -x of B.
B_OF_S = np.array([[0.0, 0.0, -1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])


def powered_rows(flight: Flight) -> np.ndarray:
    """Rows of telemetry from ignition to the beginning of hover, or to the end; none without ignition."""
    after = [event["t_s"] for event in flight.events if event.get("milestone") == "ignition"]
    rows = np.flatnonzero(flight.during(POWERED_DECELERATION))
    hover = np.flatnonzero(flight.during(HOVER_IMAGING))
    if not after:
        return rows[:0]
    return np.append(rows[flight.telemetry["t_s"][rows] >= after[0] - 1e-6], hover[:1])


def states_of(flight: Flight, rows: np.ndarray) -> np.ndarray:
    """True states of some rows relative to the target, shape (n, 14), as :class:`RigidLanding` has them."""
    of, target = flight.telemetry, flight.fsw[0]["guidance"]["target"]
    # guidance chose the target in navigated axes, displaced by the navigation error of that time
    east, north = (
        of[f"truth.site_{axis}_m"][rows] - target["point_L"][i] + of[f"nav.error_{axis}_m"][rows[0]]
        for i, axis in enumerate(("east", "north"))
    )
    velocity = [of["truth.v_east_m_s"][rows], of["truth.v_north_m_s"][rows], -of["truth.v_down_m_s"][rows]]
    rates = np.stack([of[f"truth.rate_{axis}_deg_s"][rows] for axis in "pqr"], axis=1) @ B_OF_S
    return np.column_stack(
        [
            of["truth.mass_kg"][rows],
            *(east, north, of["truth.height_m"][rows] - target["height"]),
            *velocity,
            _attitude(flight, rows),
            np.radians(rates),
        ]
    )


def _attitude(flight: Flight, rows: np.ndarray) -> np.ndarray:
    """Quaternions that turn S into east, north and up at the lander, shape (n, 4)."""
    of, planet = flight.telemetry, build_onboard(flight.scenario)[0]["planet"]
    q = np.stack([of[f"truth.q_I2B_{c}"][rows] for c in "xyzw"], axis=1)
    east_of_I = of["truth.longitude_deg"][rows] + np.degrees(planet["rotation_rate"] * of["t_s"][rows])
    # from east, north, up to I: the vertical goes down to the equator, then round the axis
    turns = np.column_stack([90.0 + east_of_I, 90.0 - of["truth.latitude_deg"][rows]])
    local = Rotation.from_euler("ZX", turns, degrees=True)
    return (local.inv() * Rotation.from_quat(q) * Rotation.from_matrix(B_OF_S)).as_quat()[:, [3, 0, 1, 2]]


def landing_of(flight: Flight, rows: np.ndarray) -> RigidLanding:
    """The landing problem from the true state of the first of ``rows``, with the believed vehicle and the
    limits of the scenario's powered guidance; a limit that this state exceeds is widened to it.
    """
    scenario, of, start = flight.scenario, flight.telemetry, states_of(flight, rows[:1])[0]
    powered, engines = scenario.flight_software.guidance.powered, scenario.vehicle.engines
    vehicle = build_onboard(scenario)[0]["vehicle"]
    lander = vehicle["configuration"][flight.fsw[0]["vehicle"]["configuration"]]
    share = np.array([engine.full_thrust_n for engine in engines])
    flow = sum(engine.full_thrust_n / (G0 * engine.full_specific_impulse_s) for engine in engines)
    nozzle = share @ np.array([engine.nozzle_m for engine in engines]) / np.sum(share)
    radius = np.sqrt(sum(of[f"truth.r_I_{axis}_m"][rows[0]] ** 2 for axis in "xyz"))
    tilt = radians(getattr(powered, powered.law).tilt_limit_deg)
    rate = radians(scenario.flight_software.control.thrust_vector.pitch_yaw.rate_deg_s)
    return RigidLanding(
        start=start,
        dry_mass=float(start[0] - of["truth.propellant_kg"][rows[0]]),
        thrust=(
            sum(engine.throttle_min_n for engine in engines),
            sum(engine.throttle_max_n for engine in engines),
        ),
        full_thrust=float(np.sum(share)),
        full_time=powered.full_time_s,
        throttled_time=powered.convex.throttled_s,
        torque=pure_torque(vehicle, lander["centre"], _groups(scenario))[[2, 1, 0]],
        exhaust_speed=float(np.sum(share) / flow),
        gravity=float(build_onboard(scenario)[0]["planet"]["mu"] / radius**2),
        inertia=lander["inertia"][[2, 1, 0]],
        arm=np.cross(nozzle - lander["centre"], [-1.0, 0.0, 0.0]) @ B_OF_S,
        tilt=max(tilt, float(tilt_of(start))),
        rate=max(rate, float(np.linalg.norm(start[11:]))),
        glide_slope=radians(powered.convex.glide_slope_deg),
    )


def _groups(scenario: Scenario) -> list[int]:
    """Thruster groups that the braking phase may fire for attitude."""
    braking = next(phase for phase in scenario.mission.phases if phase.role == POWERED_DECELERATION)
    return [THRUSTER_GROUPS.index(group) for group in braking.thrusters]


def pure_torque(vehicle: np.void, centre: np.ndarray, groups: list[int]) -> np.ndarray:
    """Torque about each axis of B (N m, shape (3,)) that thrusters of some groups can give in either sense,
    about all axes at once, without lateral force: that of each axis alone, all reduced by one factor.
    """
    count = int(vehicle["n_thrusters"])
    matrix = np.zeros((MAX_THRUSTERS, 6))
    effectiveness_matrix(vehicle["thrusters"], count, centre, matrix)
    jets = matrix[:count][np.isin(vehicle["thrusters"]["group"][:count], groups)]
    alone = np.array([min(_most(jets, s * np.eye(3)[i]) for s in (-1.0, 1.0)) for i in range(3)])
    return alone * min(_most(jets, alone * signs) for signs in product((-1.0, 1.0), repeat=3))


def _most(jets: np.ndarray, torque: np.ndarray) -> float:
    """Return the largest multiple of ``torque`` that ``jets``, shape (n, 6), give without lateral force."""
    if not len(jets):
        return 0.0
    effect = jets[:, 1:].T
    rows = np.column_stack([effect, np.append([0.0, 0.0], -torque)])
    bounds = [(0.0, 1.0)] * len(jets) + [(0.0, None)]
    found = linprog(np.append(np.zeros(len(jets)), -1.0), A_eq=rows, b_eq=np.zeros(5), bounds=bounds)
    return float(-found.fun) if found.success else 0.0
