"""The environment of one flight."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np

from edl6dof.gym.episodes import Episodes, known_options
from edl6dof.gym.task import Task
from edl6dof.gym.tasks import task_called


class FlightEnv(gymnasium.Env[np.ndarray, Any]):
    """A task in one flight.

    It can be copied and pickled, in the middle of an episode too.  The information of the last step of an
    episode holds ``is_success``.

    Args:
        task: name of the task, of :data:`edl6dof.gym.TASKS`.
        pool: dispersed flights that episodes draw from; each is flown once, when it is first drawn.
        first_case: case number of the first of them.  Environments whose ranges of ``pool`` cases from
            ``first_case`` on do not overlap have no flight in common.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(self, task: str, pool: int = 64, first_case: int = 0, render_mode: str | None = None):
        self.render_mode = render_mode
        self._episodes = Episodes(task_called(task), 1, 1, pool, first_case)
        self.observation_space = self.task.observation_space
        self.action_space = self.task.action_space

    @property
    def task(self) -> Task:
        """The task."""
        return self._episodes.task

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an episode with a case that is drawn from the pool, or with that of the option ``case``,
        in the pool or not.

        Raises:
            ValueError: there is no such case, or no such option.
        """
        super().reset(seed=seed)
        given = known_options(options, ["case"])
        if "case" in given:
            self._episodes.begin_with(0, given["case"])
        else:
            self._episodes.begin([0], [self.np_random])
        return self._episodes.observe()[0], {}

    def step(self, action: Any) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Take an action; a number beyond its bound counts as the bound.

        Raises:
            ValueError: the action has a wrong shape, is not finite, or is no choice of the task.
        """
        seen, reward, over, cut_off, success = self._episodes.step(np.asarray(action)[None])
        ended = bool(over[0] or cut_off[0])
        information = {"is_success": bool(success[0])} if ended else {}
        return seen[0], float(reward[0]), bool(over[0]), bool(cut_off[0]), information

    def baseline(self) -> Any:
        """What the flight software itself would do now."""
        return self.task.baseline()[0]
