"""The environment of one flight."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np

from edl6dof.gym.episodes import Episodes
from edl6dof.gym.tasks import task_called


class FlightEnv(gymnasium.Env[np.ndarray, Any]):
    """A task in one flight.

    The information of the last step of an episode holds ``is_success``.

    Args:
        task: name of the task, of :data:`edl6dof.gym.TASKS`.
        pool: dispersed flights that episodes begin from; each is flown once, when it is first drawn.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, task: str, pool: int = 64, render_mode: str | None = None):
        self.render_mode = render_mode
        self._episodes = Episodes(task_called(task), 1, 1, pool)
        self.task = self._episodes.task
        self.observation_space = self.task.observation_space
        self.action_space = self.task.action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an episode."""
        super().reset(seed=seed)
        self._episodes.begin([0], [self.np_random])
        return self._episodes.observe()[0], {}

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Take an action."""
        seen, reward, over, cut_off, success = self._episodes.step(np.asarray(action)[None])
        ended = bool(over[0] or cut_off[0])
        information = {"is_success": bool(success[0])} if ended else {}
        return seen[0], float(reward[0]), bool(over[0]), bool(cut_off[0]), information

    def baseline(self) -> Any:
        """What the flight software itself would do now."""
        return self.task.baseline()[0]
