"""A thruster that fails: fly on with it, or find out which it is."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium import spaces

import edl6dof
from edl6dof.api.fleet import Fleet
from edl6dof.gym.task import Feature, StepResult, Task
from edl6dof.interface.roles import LIFT, POWERED_DECELERATION

#: When the thruster fails, s after the beginning of the phase.
_FAILS_S: dict[str, float] = {LIFT: 45.0, POWERED_DECELERATION: 0.0}
#: Thrusters that turn the vehicle.
FAILING = ("D1", "D2", "D3", "D4", "D5", "D6", "D7", "D8")
_THRUSTERS = 22


def _one_dead(phase: str, names: Sequence[str]) -> tuple[dict[str, Any], ...]:
    """Faults of which one happens."""
    at = {"phase": phase, "plus_s": _FAILS_S[phase]}
    return tuple({"thruster": name, "kind": "stuck_off", "at": at} for name in names)


_ATTITUDE = (
    Feature("attitude_error", 0.5, lambda memories: memories["demand"]["attitude_error"], 3),
    Feature("rates", 0.2, lambda memories: memories["nav"]["w_B"], 3),
    Feature("duties", 1.0, lambda memories: memories["allocation"]["duty"][:, :_THRUSTERS], _THRUSTERS),
)


class _ThrusterFault(Task):
    """One of the thrusters is dead, and nobody has said which."""

    def __init__(self, loaded: edl6dof.LoadedScenario, fleet: Fleet):
        super().__init__(loaded, fleet)
        if len(self.thrusters) != _THRUSTERS:
            raise ValueError(f"is made for {_THRUSTERS} thrusters (the vehicle has {len(self.thrusters)})")


class DeadThruster(_ThrusterFault):
    """Action: duty of each thruster, -1 for none and 1 for all the time, from the release of the backshell
    on.  Reward: a hundredth less a hundredth of error (rad) and rate (rad/s) in each step, -1 where attitude
    is lost; done where the thrust axis is where guidance wants it after 30 s.
    """

    title = "attitude of powered descent by single thrusters, one of which is dead"
    size = _THRUSTERS
    faults = _one_dead(POWERED_DECELERATION, FAILING)
    role = POWERED_DECELERATION
    interval_s, longest_s = 0.04, 60.0
    #: s after which it is over; rad and rad/s within which it is done; rad beyond which attitude is lost.
    ends_s, error, rate, lost = 30.0, 0.1, 0.05, 1.0
    features = (
        *_ATTITUDE,
        Feature("disturbance_torque", 200.0, lambda memories: memories["disturbance"]["torque"], 3),
    )

    def __init__(self, loaded: edl6dof.LoadedScenario, fleet: Fleet):
        super().__init__(loaded, fleet)
        self._began = np.zeros(len(fleet))

    def command(self, actions: np.ndarray) -> None:
        """Command the duties."""
        external = self.fleet.memories["external"]
        external["given"]["duties"] = 1
        external["duty"][:, :_THRUSTERS] = 0.5 * (actions + 1.0)

    def baseline(self) -> np.ndarray:
        """Duties of allocation."""
        return (2.0 * self.fleet.memories["own"]["duty"][:, :_THRUSTERS] - 1.0).astype(np.float32)

    def begin(self, index: int) -> None:
        """Note the time."""
        self._began[index] = self.fleet.plants["t"][index]

    def result(self) -> StepResult:
        """Over after 30 s, or when attitude is lost."""
        memories = self.fleet.memories
        error = np.linalg.norm(memories["demand"]["attitude_error"], axis=1)
        rate = np.linalg.norm(memories["nav"]["w_B"], axis=1)
        lost = self.ended() | (error > self.lost)
        done = self.fleet.plants["t"] - self._began >= self.ends_s - 1e-6
        success = done & ~lost & (error < self.error) & (rate < self.rate)
        reward = 0.01 * (1.0 - error - rate) - lost
        return StepResult(reward, lost | done, success)


class FaultDiagnosis(_ThrusterFault):
    """Action: 0 to wait, or the number of a thruster to take out of use, which ends the episode.  Reward: 1
    less a twentieth for each second if it is the one that failed, but a tenth at least; -1 if not.

    A bank reversal, which uses the thrusters, comes some seconds after the beginning.  Fault isolation of the
    flight software is at work, too; the duties show what it has taken out of use.
    """

    title = "which thruster is dead"
    faults = _one_dead(LIFT, FAILING)
    role, later_s = LIFT, 50.0
    interval_s, longest_s = 0.2, 60.0
    features = (
        *_ATTITUDE,
        Feature("unexplained", 200.0, lambda memories: memories["disturbance"]["unexplained"][:, 1:], 5),
        Feature("imu_rates", 0.2, lambda memories: memories["nav"]["imu_rate_B"], 3),
    )

    def __init__(self, loaded: edl6dof.LoadedScenario, fleet: Fleet):
        super().__init__(loaded, fleet)
        self._named = np.zeros(len(fleet), np.int64)
        self._failed = np.zeros(len(fleet), np.int64)
        self._waited = np.zeros(len(fleet))

    @property
    def action_space(self) -> spaces.Discrete:
        """0, or the number of a thruster, from 1 on in the order of the vehicle file."""
        return spaces.Discrete(_THRUSTERS + 1)

    def command(self, actions: np.ndarray) -> None:
        """Take the thruster that is named out of use."""
        self._named = np.asarray(actions, np.int64)
        external = self.fleet.memories["external"]
        external["given"]["isolate"] = self._named > 0
        external["isolated"][:, :_THRUSTERS] = self._named[:, None] == np.arange(1, _THRUSTERS + 1)

    def baseline(self) -> np.ndarray:
        """Thruster that fault isolation has named, 0 for none."""
        diagnosis = self.fleet.memories["diagnosis"]
        first = diagnosis["isolated"]["thruster"][:, 0]
        return np.where(diagnosis["n_isolated"] > 0, first + 1, 0)

    def begin(self, index: int) -> None:
        """See which thruster fails."""
        self._failed[index] = 1 + self.fleet.cases["faults"]["slots"]["component"][index, 0]
        self._waited[index] = 0.0

    def result(self) -> StepResult:
        """Over when a thruster is named, or the flight ends."""
        self._waited += self.interval_s
        right = self._named == self._failed
        over = (self._named > 0) | self.ended()
        success = over & right
        reward = np.where(success, np.maximum(1.0 - 0.05 * self._waited, 0.1), np.where(over, -1.0, 0.0))
        return StepResult(reward, over, success)
