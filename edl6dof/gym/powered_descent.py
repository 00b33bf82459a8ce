"""Powered descent: from ignition to the ground by the thrust vector, softly."""

from __future__ import annotations

import numpy as np

import edl6dof
from edl6dof.api.fleet import Fleet
from edl6dof.gym.task import Feature, StepResult, Task, nav
from edl6dof.interface.roles import POWERED_DECELERATION

#: Acceleration beyond weight that an action of 1 asks for, m/s2.
ACCELERATION = 5.0
#: Transition of every phase: it stands on the ground.
_CONTACT = {"when": [{"quantity": "footpad_contact", "crosses": "above", "value": 0.5}], "next": "landed"}
_DOWN = {"when": [{"quantity": "phase_time_s", "crosses": "above", "value": 3.0}], "next": "slow_descent"}


def thrust_axis(memories: np.ndarray) -> np.ndarray:
    """Direction of the thrust axis (-x of B), north, east and up, shape (flights, 3)."""
    navigated = memories["nav"]
    w, x, y, z = np.moveaxis(navigated["q_I2B"], -1, 0)
    axis = -np.stack([1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)], axis=-1)
    frame = (navigated[name] for name in ("north_I", "east_I", "up_I"))
    return np.stack([np.einsum("ij,ij->i", axis, one) for one in frame], axis=-1)


class PoweredDescent(Task):
    """Action: acceleration of thrust beyond weight, north, east and up, over 5 m/s2.  Reward: what the step
    brought towards rest on the ground, and at the end 1 for a landing within limits, -1 for any other end.
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
        Feature("height", 1000.0, nav("height")),
        Feature("height near the ground", 20.0, nav("height")),
        Feature("v_N", 50.0, nav("v_N"), 3),
        Feature("v_N near rest", 2.0, nav("v_N"), 3),
        Feature("thrust_axis", 1.0, thrust_axis, 3),
        Feature("rates", 0.3, nav("w_B"), 3),
        Feature("mass", 1000.0, lambda memories: memories["vehicle"]["mass"]),
        Feature("thrust", 7500.0, lambda memories: memories["guide"]["thrust"]),
    )

    def __init__(self, loaded: edl6dof.LoadedScenario, fleet: Fleet):
        super().__init__(loaded, fleet)
        self._left = np.zeros(len(fleet))

    def command(self, actions: np.ndarray) -> None:
        """Command the thrust vector."""
        mass, weight = _mass_and_weight(self.fleet)
        thrust = ACCELERATION * mass[:, None] * actions.astype(float) * (1.0, 1.0, -1.0)
        thrust[:, 2] -= weight
        external = self.fleet.memories["external"]
        external["given"]["thrust"] = 1
        external["thrust_N"] = thrust

    def baseline(self) -> np.ndarray:
        """Thrust vector of powered guidance."""
        mass, weight = _mass_and_weight(self.fleet)
        wanted = self.fleet.memories["own"]["thrust_N"].copy()
        wanted[:, 2] += weight
        actions = wanted / (ACCELERATION * mass[:, None]) * (1.0, 1.0, -1.0)
        return np.clip(actions, -1.0, 1.0).astype(np.float32)

    def begin(self, index: int) -> None:
        """Take up what is left to do."""
        self._left[index] = _left(self.fleet)[index]

    def result(self) -> StepResult:
        """Over when the flight ends."""
        before, self._left = self._left, _left(self.fleet)
        over = self.ended()
        success = self.fleet.landed_well(self.loaded.scenario.limits)
        reward = before - self._left + np.where(over, np.where(success, 1.0, -1.0), 0.0)
        return StepResult(reward, over, success)


def _mass_and_weight(fleet: Fleet) -> tuple[np.ndarray, np.ndarray]:
    mass = fleet.memories["vehicle"]["mass"]
    return mass, mass * fleet.memories["nav"]["gravity"]


def _left(fleet: Fleet) -> np.ndarray:
    """How far from rest on the ground, in parts of the whole."""
    navigated = fleet.memories["nav"]
    return np.linalg.norm(navigated["v_N"], axis=1) / 100.0 + np.maximum(navigated["height"], 0.0) / 2000.0
