"""The tasks: bank of the entry, powered descent, choice of the landing spot, flight with a dead thruster."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf, pi
from typing import Any

import numpy as np
from gymnasium import spaces

import edl6dof
from edl6dof.api.simulation import Fleet
from edl6dof.gym.task import Feature, StepResult, Task
from edl6dof.interface.roles import HAZARD_AVOIDANCE, LIFT, POWERED_DECELERATION

#: Miss of the aim point at the mortar within which the task of the entry is done, m.
NEAR_M = 10_000.0
#: Acceleration beyond weight of an action of 1 in powered descent, m/s2.
ACCELERATION = 5.0
#: Cells of the observed map along each side; clearance of one that is safe beyond doubt, m.
_CELLS, _CLEAR_M = 32, 5.0
#: Thrusters of the vehicle, those that may fail, and the time of the fault after the start of the phase, s.
_THRUSTERS, FAILING = 22, ("D1", "D2", "D3", "D4", "D5", "D6", "D7", "D8")
_FAILS_S: dict[str, float] = {LIFT: 45.0, POWERED_DECELERATION: 0.0}


class EntryBank(Task):
    """Entry guidance. The action is the bank angle divided by 105 deg. The reward is given at the end: 1
    minus the miss divided by 20 km, or -1 if the state at mortar fire violates a limit or the flight has
    ended before.
    """

    title = "bank angle of the entry"
    size = 1
    role = LIFT
    interval_s, longest_s = 1.0, 300.0
    features = (
        Feature("altitude", 50e3, "m", "nav.altitude"),
        Feature("speed", 5000.0, "m/s", "nav.speed"),
        Feature("flight_path_angle", 0.3, "rad", "nav.flight_path_angle"),
        Feature("drag", 60.0, "m/s2", "nav.drag"),
        Feature("bank", pi, "rad", "nav.bank"),
        Feature("range_to_go", 300e3, "m", "guide.range_to_go"),
        Feature("crossrange", 20e3, "m", "guide.crossrange"),
        Feature("downrange_to_go", 300e3, "m", "guide.downrange_to_go"),
        Feature("drag_ratio", 2.0, "", "guide.drag_ratio"),
        Feature("lift_ratio", 2.0, "", "guide.lift_ratio"),
    )

    @property
    def _largest(self) -> float:
        return np.radians(self.loaded.scenario.flight_software.guidance.entry.bank_max_deg)

    def command(self, actions: np.ndarray) -> None:
        """Command the bank angle."""
        self.give("bank", bank=actions[:, 0] * self._largest)

    def baseline(self) -> np.ndarray:
        """Bank angle of entry guidance."""
        bank = self.fleet.memories["own"]["bank"] / self._largest
        return np.clip(bank, -1.0, 1.0)[:, None].astype(np.float32)

    def result(self) -> StepResult:
        """Evaluate the step; the task is over when the mortar fires, or the flight ends before."""
        lost = self.ended()
        over = lost | ~self.in_role(LIFT)
        limits, navigated = self.loaded.scenario.limits, self.fleet.memories["nav"]
        may_open = (
            ~lost
            & (navigated["mach"] <= (limits.parachute_mach_max or inf))
            & (navigated["dynamic_pressure"] <= (limits.parachute_dynamic_pressure_pa or inf))
        )
        miss = np.abs(self.fleet.memories["guide"]["range_to_go"])
        last = np.where(may_open, np.maximum(1.0 - miss / (2.0 * NEAR_M), -1.0), -1.0)
        return StepResult(np.where(over, last, 0.0), over, over & may_open & (miss <= NEAR_M))


#: Transitions of powered descent: every phase ends on the ground, and the hover after 3 s.
_CONTACT = {"when": [{"quantity": "footpad_contact", "crosses": "above", "value": 0.5}], "next": "landed"}
_DOWN = {"when": [{"quantity": "phase_time_s", "crosses": "above", "value": 3.0}], "next": "slow_descent"}


def thrust_axis(memories: np.ndarray) -> np.ndarray:
    """Return the direction of the thrust axis (-x of B), north, east and up, shape (flights, 3)."""
    navigated = memories["nav"]
    w, x, y, z = np.moveaxis(navigated["q_I2B"], -1, 0)
    axis = -np.stack([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)], axis=-1)
    frame = (navigated[name] for name in ("north_I", "east_I", "up_I"))
    return np.stack([np.einsum("ij,ij->i", axis, one) for one in frame], axis=-1)


class PoweredDescent(Task):
    """Powered guidance. The action is the thrust acceleration minus the part that balances gravity, north,
    east and up, divided by 5 m/s2. The reward of a step is the decrease of speed / (100 m/s) + height /
    (2,000 m). At the end, 1 is added for a landing within limits, and -1 for any other end.
    """

    title = "powered descent by the thrust vector"
    size = 3
    overrides = {
        "mission.phases.powered_deceleration.transitions": [_CONTACT],
        "mission.phases.hover_imaging.until": None,
        "mission.phases.hover_imaging.transitions": [_CONTACT, _DOWN],
        "flight_software.guidance.powered.terminal.descent_sideways": "tilt",
    }
    role, later_s = POWERED_DECELERATION, 0.6
    interval_s, longest_s = 0.2, 180.0
    features = (
        Feature("height", 1000.0, "m", "nav.height"),
        Feature("height near the ground", 20.0, "m", "nav.height"),
        Feature("v_N", 50.0, "m/s", "nav.v_N", 3),
        Feature("v_N near rest", 2.0, "m/s", "nav.v_N", 3),
        Feature("thrust_axis", 1.0, "", thrust_axis, 3),
        Feature("rates", 0.3, "rad/s", "nav.w_B", 3),
        Feature("mass", 1000.0, "kg", "vehicle.mass"),
        Feature("thrust", 7500.0, "N", "guide.thrust"),
    )

    def __init__(self, loaded: edl6dof.LoadedScenario, fleet: Fleet):
        super().__init__(loaded, fleet)
        self._left = np.zeros(len(fleet))

    def command(self, actions: np.ndarray) -> None:
        """Command the thrust vector."""
        mass, weight = self._mass_and_weight()
        thrust = ACCELERATION * mass[:, None] * actions.astype(float) * (1.0, 1.0, -1.0)
        thrust[:, 2] -= weight
        self.give("thrust", thrust_N=thrust)

    def baseline(self) -> np.ndarray:
        """Thrust vector of powered guidance."""
        mass, weight = self._mass_and_weight()
        wanted = self.fleet.memories["own"]["thrust_N"].copy()
        wanted[:, 2] += weight
        actions = wanted / (ACCELERATION * mass[:, None]) * (1.0, 1.0, -1.0)
        return np.clip(actions, -1.0, 1.0).astype(np.float32)

    def begin(self, index: int) -> None:
        """Store the distance from rest on the ground."""
        self._left[index] = self._distance()[index]

    def result(self) -> StepResult:
        """Evaluate the step; the task is over when the flight ends."""
        before, self._left = self._left, self._distance()
        over, success, last = self.landing()
        return StepResult(before - self._left + last, over, success)

    def _mass_and_weight(self) -> tuple[np.ndarray, np.ndarray]:
        mass = self.fleet.memories["vehicle"]["mass"]
        return mass, mass * self.fleet.memories["nav"]["gravity"]

    def _distance(self) -> np.ndarray:
        """Distance from rest on the ground: speed over 100 m/s plus height over 2,000 m, shape (flights,)."""
        navigated = self.fleet.memories["nav"]
        speed = np.linalg.norm(navigated["v_N"], axis=1)
        return speed / 100.0 + np.maximum(navigated["height"], 0.0) / 2000.0


def clearances(memories: np.ndarray) -> np.ndarray:
    """Largest distance (m) from a hazard in each part of the map, shape (flights, 32 x 32), north by east."""
    fine = memories["hazard"]["safety_map"]["clearance"]
    part = fine.shape[1] // _CELLS
    parts = fine.reshape(len(memories), _CELLS, part, _CELLS, part)
    return parts.max(axis=(2, 4)).reshape(len(memories), -1)


def on_map(memories: np.ndarray, place_L: np.ndarray) -> np.ndarray:
    """Places (east, north) relative to the middle of the map, 1 at its edges, shape (flights, 2)."""
    corner, half = _map(memories)
    return (place_L - corner) / half - 1.0


def _map(memories: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Corner and half of the width of the maps, m."""
    elevation_map = memories["hazard"]["elevation_map"]
    cells = memories["hazard"]["safety_map"]["clearance"].shape[1]
    return elevation_map["corner_L"], 0.5 * cells * elevation_map["cell"][:, None]


class HazardDivert(Task):
    """Choice of a landing spot. The action is the spot, east and north of the middle of the map, 1 at its
    edges. The reward is given at the end: 1 for a landing within limits, including those of the ground, and
    -1 for any other end.
    """

    title = "spot to land on, among rocks and craters"
    size = 2
    scenario = "tianwen1_hazards"
    role = HAZARD_AVOIDANCE
    interval_s, longest_s = 1.0, 180.0
    features = (
        Feature("clearance", _CLEAR_M, "m", clearances, _CELLS * _CELLS),
        Feature(
            "place",
            1.0,
            "half width of the map",
            lambda memories: on_map(memories, memories["nav"]["site_L"][:, :2]),
            2,
        ),
        Feature("height", 100.0, "m", "nav.height"),
        Feature("v_N", 3.0, "m/s", "nav.v_N", 3),
    )

    def command(self, actions: np.ndarray) -> None:
        """Command the spot."""
        corner, half = _map(self.fleet.memories)
        self.give("safe_spot", fine_L=corner + half * (actions.astype(float) + 1.0))

    def baseline(self) -> np.ndarray:
        """The spot that hazard detection has chosen."""
        memories = self.fleet.memories
        return np.clip(on_map(memories, memories["hazard"]["choice"]["spot_L"]), -1.0, 1.0).astype(np.float32)

    def result(self) -> StepResult:
        """Evaluate the step; the task is over when the flight ends."""
        over, success, last = self.landing()
        return StepResult(last, over, success)


def _one_dead(phase: str, names: Sequence[str]) -> tuple[dict[str, Any], ...]:
    """Dead-thruster faults in a phase, one for each name; each flight has one of them."""
    at = {"phase": phase, "plus_s": _FAILS_S[phase]}
    return tuple({"thruster": name, "kind": "stuck_off", "at": at} for name in names)


_ATTITUDE = (
    Feature("attitude_error", 0.5, "rad", "demand.attitude_error", 3),
    Feature("rates", 0.2, "rad/s", "nav.w_B", 3),
    Feature("duties", 1.0, "", lambda memories: memories["allocation"]["duty"][:, :_THRUSTERS], _THRUSTERS),
)


class _ThrusterFault(Task):
    """One unknown thruster is dead."""

    def __init__(self, loaded: edl6dof.LoadedScenario, fleet: Fleet):
        super().__init__(loaded, fleet)
        if len(names := loaded.scenario.thruster_names) != _THRUSTERS:
            raise ValueError(f"is made for {_THRUSTERS} thrusters (the vehicle has {len(names)})")


class DeadThruster(_ThrusterFault):
    """Allocation with a dead thruster, from backshell release on. The action is the duty of each thruster, -1
    for never open and 1 for always open. The reward of a step is 0.01 (1 - attitude error (rad) - body rate
    (rad/s)), or -1 if the attitude is lost. The task succeeds if the thrust axis points in the direction of
    guidance after 30 s.
    """

    title = "attitude of powered descent by single thrusters, one of which is dead"
    size = _THRUSTERS
    faults = _one_dead(POWERED_DECELERATION, FAILING)
    role = POWERED_DECELERATION
    interval_s, longest_s = 0.04, 60.0
    #: s after which it is over; rad and rad/s within which it is done; rad beyond which attitude is lost.
    ends_s, error, rate, lost = 30.0, 0.1, 0.05, 1.0
    features = (*_ATTITUDE, Feature("disturbance_torque", 200.0, "N m", "disturbance.torque", 3))

    def __init__(self, loaded: edl6dof.LoadedScenario, fleet: Fleet):
        super().__init__(loaded, fleet)
        self._began = np.zeros(len(fleet))

    def command(self, actions: np.ndarray) -> None:
        """Command the duties."""
        self.give("duties")
        self.fleet.memories["external"]["duty"][:, :_THRUSTERS] = 0.5 * (actions + 1.0)

    def baseline(self) -> np.ndarray:
        """Duties of allocation."""
        return (2.0 * self.fleet.memories["own"]["duty"][:, :_THRUSTERS] - 1.0).astype(np.float32)

    def begin(self, index: int) -> None:
        """Store the time."""
        self._began[index] = self.fleet.plants["t"][index]

    def result(self) -> StepResult:
        """Evaluate the step; the task is over after 30 s, or when attitude is lost."""
        memories = self.fleet.memories
        error = np.linalg.norm(memories["demand"]["attitude_error"], axis=1)
        rate = np.linalg.norm(memories["nav"]["w_B"], axis=1)
        lost = self.ended() | (error > self.lost)
        done = self.fleet.plants["t"] - self._began >= self.ends_s - 1e-6
        success = done & ~lost & (error < self.error) & (rate < self.rate)
        reward = 0.01 * (1.0 - error - rate) - lost
        return StepResult(reward, lost | done, success)


class FaultDiagnosis(_ThrusterFault):
    """Isolation of a failed thruster. The action is 0 to wait, or the number of a thruster that is not to be
    used again, which ends the episode. The reward is 1 minus 0.05 for each second, but at least 0.1, if this
    thruster has failed, and -1 if not.

    A bank reversal, which uses the thrusters, follows some seconds after the start. The fault isolation of
    the flight software is active too; the duties show which thrusters it does not use any more.
    """

    title = "which thruster is dead"
    faults = _one_dead(LIFT, FAILING)
    role, later_s = LIFT, 50.0
    interval_s, longest_s = 0.2, 60.0
    features = (
        *_ATTITUDE,
        Feature(
            "unexplained",
            200.0,
            "N or N m",
            lambda memories: memories["disturbance"]["unexplained"][:, 1:],
            5,
        ),
        Feature("imu_rates", 0.2, "rad/s", "nav.imu_rate_B", 3),
    )

    def __init__(self, loaded: edl6dof.LoadedScenario, fleet: Fleet):
        super().__init__(loaded, fleet)
        self._named, self._failed = np.zeros(len(fleet), np.int64), np.zeros(len(fleet), np.int64)
        self._waited = np.zeros(len(fleet))

    @property
    def action_space(self) -> spaces.Discrete:
        """0, or the number of a thruster, from 1 on in the order of the vehicle file."""
        return spaces.Discrete(_THRUSTERS + 1)

    def command(self, actions: np.ndarray) -> None:
        """Take the named thruster out of use."""
        self._named = np.asarray(actions, np.int64)
        self.give("isolate", self._named > 0)
        isolated = self._named[:, None] == np.arange(1, _THRUSTERS + 1)
        self.fleet.memories["external"]["isolated"][:, :_THRUSTERS] = isolated

    def baseline(self) -> np.ndarray:
        """Thruster that fault isolation has named, 0 for none."""
        diagnosis = self.fleet.memories["diagnosis"]
        first = diagnosis["isolated"]["thruster"][:, 0]
        return np.where(diagnosis["n_isolated"] > 0, first + 1, 0)

    def begin(self, index: int) -> None:
        """Store which thruster fails."""
        self._failed[index] = 1 + self.fleet.cases["faults"]["slots"]["component"][index, 0]
        self._waited[index] = 0.0

    def result(self) -> StepResult:
        """Evaluate the step; the task is over when a thruster is named, or the flight ends."""
        self._waited += self.interval_s
        right = self._named == self._failed
        over = (self._named > 0) | self.ended()
        success = over & right
        reward = np.where(success, np.maximum(1.0 - 0.05 * self._waited, 0.1), np.where(over, -1.0, 0.0))
        return StepResult(reward, over, success)
