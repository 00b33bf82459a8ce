"""The flights of the study of Hu et al. 2022: the nominal continued from saved states under changed
conditions.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from edl6dof.fsw.control.frames import goal_attitude
from edl6dof.interface.roles import HOVER_IMAGING, begun
from edl6dof.scenario.loading import LoadedScenario, load_scenario
from edl6dof.sim.checkpoint import State
from edl6dof.sim.flight import Flight, continue_from, fly
from edl6dof.spatial.quaternion import about_axis, multiply
from edl6dof.telemetry.timeline import first_times
from edl6dof.vehicle.plant import ATTITUDE, RATE

SCENARIO = "tianwen1"
_PERFECT = "sensors.set=perfect"
LANDER = "flight_software.control.thrust_vector"
#: Time after backshell release at which dispersed entries of the powered descent begin, s.
AFTER_RELEASE_S = 0.06
FORMULATIONS = ("decoupled", "shortest_path")

#: A torque step in the hover, N m, and what works against it: settings by name.
STEP_NM = 100.0
_PITCH_YAW = f"{LANDER}.pitch_yaw"
INTEGRAL = f"{LANDER}.against_disturbance=integral"
AGAINST_STEP: dict[str, tuple[str, ...]] = {
    "estimator": (),
    # the integral that settles soonest with the same P and D, in a PID zone wide enough for it
    "integral": (INTEGRAL, f"{_PITCH_YAW}.integral=0.4", f"{_PITCH_YAW}.near_deg=12"),
    # what the estimator is worth in its linear range: P + lambda D, lambda P, D + lambda for P 1.4, D 1.9,
    # lambda 8
    "equal PID": (
        INTEGRAL,
        f"{_PITCH_YAW}.proportional=16.6",
        f"{_PITCH_YAW}.integral=11.2",
        f"{_PITCH_YAW}.derivative=9.9",
    ),
}
#: Time into the hover at which the step comes, and time watched after it, s.
STEP_AFTER_S, STEP_WATCHED_S = 11.0, 25.0

#: A trim wing that stays shut: whether thrusters hold the angle of attack, or it is left to trim.
HELD = "alpha held"
WING = {HELD: True, "left to trim": False}


@dataclass(frozen=True)
class Entry:
    """How the lander hangs when the powered descent begins: roll error, tilt towards an azimuth of the body,
    body rate.
    """

    roll_deg: float
    tilt_deg: float
    towards_deg: float
    rate_deg_s: tuple[float, float, float]


def nominal(changes: Sequence[str] = ()) -> LoadedScenario:
    """The Tianwen-1 scenario with ``PATH=VALUE`` changes, on perfect sensors: what is examined is control,
    and the flight computer has to know of a state that is set up.
    """
    return load_scenario(SCENARIO, (_PERFECT, *changes))


def state_at(time_s: float, changes: Sequence[str] = (_PERFECT,)) -> State:
    """The Tianwen-1 scenario with ``PATH=VALUE`` changes at a time."""
    loaded = load_scenario(SCENARIO, (*changes, f"simulation.time_limit_s={time_s + 1.0}"))
    saved = fly(loaded, save_at_s=time_s).saved
    if saved is None:
        raise ValueError(f"the flight is over before {time_s:g} s")
    return saved


def carry_on(
    state: State, changes: Sequence[str] = (), truth: Mapping[str, Any] | None = None, until_s: float = 900.0
) -> Flight:
    """Fly on from a state under changed settings, and under a truth of which the flight computer is not
    told.
    """
    overrides = [*changes, f"simulation.time_limit_s={until_s}"]
    if truth:
        overrides.append(f"truth={json.dumps(dict(truth))}")
    return fly(continue_from(state, tuple(overrides)), start=state)


def draw_entries(count: int, seed: int) -> list[Entry]:
    """Dispersed starts of the powered descent: any roll up to 120 deg, tilts of 10 to 40 deg, rates of 5
    deg/s (1 sigma).
    """
    rng = np.random.default_rng(seed)
    return [_drawn_entry(rng) for _ in range(count)]


def _drawn_entry(rng: np.random.Generator) -> Entry:
    roll, tilt, direction = rng.uniform(-120.0, 120.0), rng.uniform(10.0, 40.0), rng.uniform(0.0, 360.0)
    p, q, r = 5.0 * rng.standard_normal(3)
    return Entry(float(roll), float(tilt), float(direction), (float(p), float(q), float(r)))


def hung_like(state: State, entry: Entry) -> State:
    """A state with another attitude and rate, as if it had always been so for sensors and estimators."""
    plant, sensors, fsw = state.plant.copy(), state.sensors.copy(), state.fsw.copy()
    nav = fsw["nav"][0]
    axes = (tuple(nav[f"{name}_I"]) for name in ("north", "east", "up", "up"))
    towards = np.radians(entry.towards_deg)
    tilted = multiply(
        goal_attitude(*axes), about_axis((0.0, np.cos(towards), np.sin(towards)), np.radians(entry.tilt_deg))
    )
    plant["y"][0, ATTITUDE : ATTITUDE + 4] = multiply(
        tilted, about_axis((1.0, 0.0, 0.0), np.radians(entry.roll_deg))
    )
    rate = np.radians(entry.rate_deg_s)
    plant["y"][0, RATE : RATE + 3] = rate
    sensors["imu"]["rate"][:] = rate
    fsw["estimation"]["rate"] = rate
    return replace(state, plant=plant, sensors=sensors, fsw=fsw)


def from_entry(release: State, entry: Entry, formulation: str) -> Flight:
    """The powered descent from a dispersed entry, with one formulation of the attitude error."""
    return carry_on(hung_like(release, entry), [f"{LANDER}.error={formulation}"])


def torque_steps(flight: Flight) -> dict[str, Flight]:
    """The hover with the engine suddenly off the centre of mass, so that it turns the vehicle about z of
    B.
    """
    start = first_times(flight.events)[begun(HOVER_IMAGING)] + STEP_AFTER_S
    state = state_at(start)
    thrust = float(np.interp(start, flight.telemetry["t_s"], flight.telemetry["truth.engine_thrust_n"]))
    x, y, z = flight.scenario.vehicle.engines[0].nozzle_m
    truth = {"vehicle.engines.main.nozzle_m": [x, y + STEP_NM / thrust, z]}
    hover = flight.scenario.phase_roles.index(HOVER_IMAGING)
    longer = f"mission.phases.{hover}.until.value={STEP_AFTER_S + STEP_WATCHED_S + 5.0}"
    return {
        name: carry_on(state, [longer, *changes], truth, start + STEP_WATCHED_S)
        for name, changes in AGAINST_STEP.items()
    }


def failed_wings() -> dict[str, Flight]:
    """Entries whose trim wing stays shut."""
    stuck = "faults=[{kind: wing_stuck, at: {time_s: 0}}]"
    branch = [phase.hold_alpha for phase in nominal().scenario.mission.phases].index(True)
    return {
        name: fly(nominal([stuck, f"mission.phases.{branch}.hold_alpha={str(held).lower()}"]))
        for name, held in WING.items()
    }


def thrust_error_deg(flight: Flight) -> np.ndarray:
    """Angle between thrust axis and commanded thrust direction, by row of telemetry."""
    rows = flight.telemetry
    spin = flight.scenario.planet.rotation_rate_rad_s * rows["t_s"]
    latitude, longitude = (
        np.radians(rows["truth.latitude_deg"]),
        np.radians(rows["truth.longitude_deg"]) + spin,
    )
    sl, cl, so, co = np.sin(latitude), np.cos(latitude), np.sin(longitude), np.cos(longitude)
    north, east = np.stack([-sl * co, -sl * so, cl]), np.stack([-so, co, np.zeros_like(so)])
    down = -np.stack([cl * co, cl * so, sl])
    wanted = sum(
        rows[f"guide.thrust_direction_{name}"] * axis
        for name, axis in (("north", north), ("east", east), ("down", down))
    )
    w, x, y, z = (rows[f"truth.q_I2B_{c}"] for c in "wxyz")
    thrust = -np.stack([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)])
    return np.degrees(
        np.arctan2(np.linalg.norm(np.cross(thrust, wanted, axis=0), axis=0), np.sum(thrust * wanted, axis=0))
    )
